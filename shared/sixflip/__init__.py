"""On-site calibration of MEMS IMUs; the same files run on MicroPython and CPython."""

__version__ = "0.1.0"
STANDARD_G = 9.80665  # m/s2, standard gravity (3rd CGPM, 1901)
RAIL = 32767  # |count| of a 16-bit reading at full scale, whatever the range: saturated
