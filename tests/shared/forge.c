/* Forged checksums, which look inside the header: compiled once for programs that have only its declarations. */
#undef MCS_DECLARE
#include "forge.h"
