/* Runs no case at all. */
#include "mcs_test.h"

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("selftest");
    if (argc > 1000 && mcst_case("never")) mcst_fail(__FILE__, __LINE__, "never", "argc = %d", argc);
    return mcst_finish();
}
