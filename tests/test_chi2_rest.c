/* Design checks 1 and 2 for everything that is not a BRDF: 1D, planar, directions, half-vectors; with u-space through
 * the inverses.
 */
#include "chi2_rows.h"

static int mine(const mcst_row *row) { return row->shape != MCST_IS_BRDF; }

int main(int argc, char **argv) { return mcst_chi2_main(argc, argv, mine); }
