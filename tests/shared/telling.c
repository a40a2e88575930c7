/* What implementation.c is, where MCS_ASSERT counts: for test_env_modes and test_mistakes. */
#include "asserting.h"
int asserted;
jmp_buf *asserted_way_out;
#include "implementation.c"
