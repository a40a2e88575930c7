/* The scalar and array forms of every public function without a row: compiled once for test_bits and test_fenv. */
#include "functions.h"
int bits_valid;
#define MCST_W 1
#include "bits.h"
