"""Libraries that only some people need: imported when asked for, one line when missing."""

import importlib

from ..errors import UsageError


def need(what, *modules):
    """The modules by name; UsageError naming what to install where one is missing."""
    try:
        found = [importlib.import_module(name) for name in modules]
    except ImportError as error:
        raise UsageError("%s needs %s, which is not installed: pip install 'sixflip[data]'" % (
            what, error.name or modules[0])) from None
    return found if len(found) > 1 else found[0]
