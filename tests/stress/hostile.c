/* Hostile input: any bit pattern as any argument of every function, mixed with valid arguments so that each check
 * behind another one is reached. Asserted: every result is finite; densities, weights, values and inverses are in
 * range; directions are unit; bad input by the header's rules has density and weight 0. Then tables of random sizes
 * from random numbers, in memory of exactly the size that was asked for, between guards.
 *
 * At full scale (MCS_TEST_SCALE=1) more than 1e9 evaluations; a part is picked with --filter. */
#define MCST_WIDE
#include "hostile_rows.h"
#include "hostile_tables.h"
#include "hostile_maps.h"

int main(int argc, char **argv) {
    const double scale = mcst_scale();
    mcst_start(argc, argv);
    print_head();
    test_rows(scale);
    test_tables(scale);
    test_maps(scale);
    mcst_note("%.3g evaluations\n", all_evaluations);
    return mcst_finish();
}
