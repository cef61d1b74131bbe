"""The gap between a nominal simulated sensor and a real one: where it lies, what makes it."""

from . import blas_threads  # noqa: F401 (first of all: before anything here loads numpy)
