/* MCS_ASSERT that counts, for programs that look whether the header tells a mistake. To be included before anything
 * else. */
#ifndef MCST_ASSERTING_H
#define MCST_ASSERTING_H
#ifdef MCST_LINKED
extern int asserted; /* how often a condition of the header did not hold */
#else
static int asserted;
#endif
#define MCS_ASSERT(condition) ((void)((condition) ? 0 : asserted++))
#endif
