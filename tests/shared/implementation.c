/* What MCS_DECLARE declares: array functions, tables, maps and products, compiled once for all programs. */
#define MCS_IMPLEMENTATION
#include "mcsample.h"
