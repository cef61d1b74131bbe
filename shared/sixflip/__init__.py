"""On-site calibration of MEMS IMUs; the same files run on MicroPython and CPython."""

__version__ = "0.1.0"
