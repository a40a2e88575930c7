/* MCS_ASSERT that counts, for programs that look whether the header tells a mistake. To be included before anything
 * else. */
#ifndef MCST_ASSERTING_H
#define MCST_ASSERTING_H
#include <setjmp.h>
#include <stddef.h>
#ifdef MCST_LINKED
extern int asserted;              /* how often a condition of the header did not hold */
extern jmp_buf *asserted_way_out; /* where to go then, if not on */
#else
static int asserted;
static jmp_buf *asserted_way_out;
#endif
static inline int mcst_assert(void) {
    asserted++;
    if (asserted_way_out) longjmp(*asserted_way_out, 1);
    return 0;
}
#define MCS_ASSERT(condition) ((void)((condition) ? 0 : mcst_assert()))
#endif
