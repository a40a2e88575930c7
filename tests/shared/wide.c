/* Every row and function of LANES lanes, 4, 8 or 16: compiled once for test_bits, test_fenv, test_lines and test_width.
 * Nothing where MCST_EIGHT leaves these lanes out. */
#include "functions.h"
#if defined(MCST_WIDE) && (LANES == 8 || !defined(MCST_EIGHT))
#define MCST_W LANES
#include "adapters.h"
#define MCST_W LANES
#include "bits.h"
#endif
