"""The gap between a nominal simulated sensor and a real one: where it lies, what makes it.

One thread for the linear algebra, which is settled here, before anything loads numpy. Matrices of
a few hundred rows gain nothing from more, and threads that spin while they wait for each other
take ten times as long on a machine that has something else to do. What runs side by side are whole
sensors, and spectra, in copies of the process, see side_by_side.py. A setting of the user's own is
kept.
"""
import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")
