/* A program without fault: run beside the others, its passing cases must not hide their failure. */
#include "mcs_test.h"

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("selftest");
    if (mcst_case("one")) CHECK(argc > 0, "argc = %d", argc);
    mcst_note("a detail\n");
    if (!mcst.list) puts("SKIPPED: something that is not here");
    if (mcst_case("two")) CHECK(argv[0] != NULL, "no name");
    return mcst_finish();
}
