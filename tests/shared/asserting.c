/* What rows.c is, where MCS_ASSERT counts: for test_mistakes and test_oracle. */
#include "asserting.h"
#include "rows.c"
