/* Every case passes and the summary says so, but the program does not end well. */
#include "mcs_test.h"

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("selftest");
    if (mcst_case("holds")) CHECK(argc > 0, "argc = %d", argc);
    mcst_finish();
    fflush(stdout);
    abort();
}
