/* One case holds, one must fail although its comparison is with NaN: `make selftest` wants to see exactly one failure.
 */
#include "mcs_test.h"

int main(int argc, char **argv) {
    const double zero = 0;
    mcst_start(argc, argv);
    mcst_group("selftest");
    if (mcst_case("holds")) CHECK(zero <= 1, "zero = %g", zero);
    if (mcst_case("nan")) CHECK(zero / zero <= 1, "error = %g", zero / zero);
    return mcst_finish();
}
