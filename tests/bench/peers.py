"""Samplers of Mitsuba 3 beside ours: error, and run time in arrays on one thread.

    pip install mitsuba numpy; make bench-peers

Mitsuba compiles its functions for the widest unit of the processor (variant llvm_ad_rgb). Ours are the array forms of
the shared library. Both get the same random numbers, and give direction and density. Errors are against formulas in
long double: of the direction in units of 2^-24, and |density/exact - 1|, each as what 99 % of the samples keep to and
as the largest."""
import ctypes
import sys
import time

try:
    import drjit as dr
    import mitsuba as mi
    import numpy as np
    mi.set_variant("llvm_ad_rgb")
except ImportError as missing:
    print("SKIPPED: the comparison with Mitsuba: %s" % missing)
    sys.exit(0)

COUNT = 1 << 18
ROUNDS = 60
LONG = np.longdouble
PI = LONG("3.14159265358979323846264338327950288")
NEAREST = LONG(2) ** -24


# ---- the truth, as x, y, z and density


def polar(one_minus_z, turns, pdf):
    sine = np.sqrt(one_minus_z * (2 - one_minus_z))
    return sine * np.cos(2 * PI * turns), sine * np.sin(2 * PI * turns), 1 - one_minus_z, pdf


def exact_henyey_greenstein(g, u1, u2):
    divisor = 1 + g - 2 * g * u1
    pdf = divisor ** 3 / (4 * PI * ((1 - g) * (1 + g)) ** 2)
    return polar(2 * u1 * (1 - g) ** 2 * (1 + g * (1 - u1)) / divisor ** 2, u2, pdf)


def exact_von_mises_fisher(kappa, u1, u2):
    tail = u1 * np.expm1(-2 * kappa)
    return polar(-np.log1p(tail) / kappa, u2, kappa / (2 * PI) * (1 + tail) / -np.expm1(-2 * kappa))


# ---- Mitsuba, as direction and density. Its von Mises-Fisher takes the azimuth first. Its Henyey-Greenstein starts
# from the other pole, about the direction back to where the light came from.


def mitsuba_henyey_greenstein(g, sample):
    at = dr.zeros(mi.MediumInteraction3f, COUNT)
    at.wi = mi.Vector3f(0, 0, 1)
    at.sh_frame = mi.Frame3f(at.wi)
    phase = mi.load_dict({"type": "hg", "g": float(g)})
    w, _, pdf = phase.sample(mi.PhaseFunctionContext(None), at, mi.Float(0), mi.Point2f(1 - sample.x, sample.y))
    return mi.Vector3f(w.x, w.y, -w.z), pdf


def mitsuba_von_mises_fisher(kappa, sample):
    sharpness = dr.opaque(mi.Float, float(kappa))
    w = mi.warp.square_to_von_mises_fisher(mi.Point2f(sample.y, sample.x), sharpness)
    return w, mi.warp.square_to_von_mises_fisher_pdf(w, sharpness)


# ---- one call of either


def ours(function, parameter, arrays):
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]
    function(ctypes.c_float(parameter), ctypes.c_size_t(COUNT), *pointers)


def theirs(function, parameter, sample):
    w, pdf = function(parameter, sample)
    dr.eval(w, pdf)
    dr.sync_thread()
    return w, pdf


# ---- the comparison


def seconds(run):
    began = time.perf_counter()
    run()
    return time.perf_counter() - began


def show(name, whose, nanoseconds, got, exact):
    place = np.sqrt(sum((LONG(g) - e) ** 2 for g, e in zip(got[:3], exact[:3]))) / NEAREST
    density = abs(LONG(got[3]) / exact[3] - 1)
    of_place, of_density = [(np.quantile(error, 0.99), error.max()) for error in (place, density)]
    print("%-24s %-12s %6.2f %14.2g %9.2g %14.1e %9.1e" % (name, whose, nanoseconds, *of_place, *of_density))


def compare(function, name, parameter, mitsuba, exact):
    rng = np.random.default_rng(1)
    u1, u2 = [(rng.integers(0, 1 << 24, COUNT) / (1 << 24)).astype(np.float32) for _ in range(2)]
    sample = mi.Point2f(u1, u2)
    out = [np.empty(COUNT, np.float32) for _ in range(4)]
    runs = [lambda: ours(function, parameter, [u1, u2, *out]), lambda: theirs(mitsuba, parameter, sample)]
    times = [[seconds(run) for run in runs] for _ in range(ROUNDS)]
    least = [min(column) * 1e9 / COUNT for column in zip(*times)]
    w, pdf = theirs(mitsuba, parameter, sample)
    truth = exact(LONG(np.float32(parameter)), LONG(u1), LONG(u2))
    show("%s %g" % (name, parameter), "here, arrays", least[0], out, truth)
    show("", "Mitsuba", least[1], [np.array(part) for part in (w.x, w.y, w.z, pdf)], truth)


def main():
    dr.set_thread_count(1)
    library = ctypes.CDLL(sys.argv[1])
    print("Mitsuba %s, %d samples, ns a sample (least of %d)" % (mi.__version__, COUNT, ROUNDS))
    print("%-24s %-12s %6s %14s %9s %14s %9s" % ("", "", "ns", "direction 99 %", "largest", "density 99 %", "largest"))
    for g in (0.1, 0.8, 0.99, 0.999):
        compare(library.mcs_henyey_greenstein_sample_n, "Henyey-Greenstein", g, mitsuba_henyey_greenstein,
                exact_henyey_greenstein)
    for kappa in (1, 50, 1e4, 1e6):
        compare(library.mcs_von_mises_fisher_sample_n, "von Mises-Fisher", kappa, mitsuba_von_mises_fisher,
                exact_von_mises_fisher)


main()
