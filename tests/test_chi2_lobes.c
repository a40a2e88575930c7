/* Design checks 1 and 2 for reflected directions: samples of every BRDF against the integral of its shipped density. */
#include "chi2_rows.h"

static int mine(const mcst_row *row) { return row->shape == MCST_IS_BRDF; }

int main(int argc, char **argv) { return mcst_chi2_main(argc, argv, mine); }
