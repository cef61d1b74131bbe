"""Programs whose printed table is the result, run from the project's folder with
`python -m tests.studies.…`; the Makefile has a target for each kind. Their small forms are tests
in tests/host/studies.

Each runs its cases in processes side by side, so the linear algebra of one takes one thread.
"""
import os

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(threads, "1")     # before numpy is loaded
