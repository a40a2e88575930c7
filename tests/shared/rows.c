/* The scalar and array forms of every row of the registry, and their truths: compiled once for all programs. */
#include "registry.h"
#define MCST_W 1
#include "adapters.h"
#include "truth.h"
