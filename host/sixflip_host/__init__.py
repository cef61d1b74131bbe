"""Sixflip on the host. For programs: solve, plan, simulate and diagnose, see python_api."""

__all__ = ["diagnose", "plan", "simulate", "solve"]


def __getattr__(name):
    """The functions of python_api, looked up when first asked for: the command starts without."""
    if name in __all__:
        from . import python_api
        return getattr(python_api, name)
    raise AttributeError("module %r has no attribute %r" % (__name__, name))
