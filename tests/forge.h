/* Tables of environment maps with forged checksums. They look inside the header: with -DMCST_LINKED they are only declared,
 * and make compiles them once, in tests/shared. */
#ifndef MCST_FORGE_H
#define MCST_FORGE_H
#include "mcsample.h"
#if defined(MCST_LINKED) && !defined(MCST_SHARED)
void seal(mcs_env *e);
int is_laid_out(const mcs_env *e);
#else
#ifdef MCST_LINKED
#define MCST_FORGE
void seal(mcs_env *e);
int is_laid_out(const mcs_env *e);
#else
#define MCST_FORGE static inline
#endif
/* Checksums that fit a damaged table, as a forger would compute them: what mcs_env_check knows without them is then all
 * that is left. Size and layout must be those of the memory. */
MCST_FORGE void seal(mcs_env *e) {
    mcsi_row_light *light = MCSI_WRITE(mcsi_row_light, e, e->offset.row_light);
    for (uint32_t y = 0; y < e->h; y++) {
        const mcsi_cdf columns = mcsi_env_columns(e, y);
        light[y].checksum = mcsi_row_checksum(&columns);
    }
    e->checksum = mcsi_env_checksum(e);
}
/* Is the layout that of the size? */
MCST_FORGE int is_laid_out(const mcs_env *e) {
    const mcsi_env_offsets offset = mcsi_env_layout(e->w, e->h);
    return !memcmp(&offset, &e->offset, sizeof offset);
}
#endif
#endif
