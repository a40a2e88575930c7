# Points of a disk from Python. After `make lib`: python3 examples/call.py build/lib/libmcsample.so
import ctypes, sys

floats = ctypes.c_float * 3
u, x, y, pdf = floats(0.1, 0.5, 0.9), floats(), floats(), floats()
ctypes.CDLL(sys.argv[1]).mcs_disk_sample_n(ctypes.c_float(2), ctypes.c_size_t(3), u, u, x, y, pdf)

for k in range(3):
    print("%.6f %.6f %.6f" % (x[k], y[k], pdf[k]))
