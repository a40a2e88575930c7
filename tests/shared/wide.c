/* Every row and function of LANES lanes, 4, 8 or 16: compiled once for test_bits, test_fenv, test_lines and test_width.
 */
#include "functions.h"
#ifdef MCST_WIDE
#define MCST_W LANES
#include "adapters.h"
#define MCST_W LANES
#include "bits.h"
#endif
