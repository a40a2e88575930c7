/* Dies in the middle of a case, after another one passed. */
#include "mcs_test.h"

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("selftest");
    if (mcst_case("holds")) CHECK(argc > 0, "argc = %d", argc);
    if (mcst_case("crash")) abort();
    return mcst_finish();
}
