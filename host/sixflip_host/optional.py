"""Libraries that only some people need: imported when asked for, and how to install them."""

import importlib
import re
import sys
from importlib import metadata

from .board.board_files import tree
from .errors import UsageError


def how(extra):
    """The command that installs what an extra of sixflip asks for: the libraries by their own
    names, so that it does not matter where sixflip itself came from."""
    try:
        wanted = [line for line in metadata.requires("sixflip") or [] if _in_extra(line, extra)]
    except metadata.PackageNotFoundError:
        wanted = []
    if not wanted:      # run from a checkout that is not installed
        return "%s -m pip install '%s[%s]'" % (sys.executable, tree(), extra)
    return "%s -m pip install %s" % (sys.executable, " ".join(
        "'%s'" % line.split(";")[0].strip() for line in wanted))


def _in_extra(requirement, extra):
    return re.search(r"extra *== *['\"]%s['\"]" % re.escape(extra), requirement)


def need(what, extra, *modules):
    """The modules by name; UsageError naming what to install where one is missing."""
    try:
        imported = [importlib.import_module(name) for name in modules]
    except ImportError as error:
        raise UsageError("%s needs %s, which is not installed: %s" % (
            what, error.name or modules[0], how(extra))) from None
    return imported if len(imported) > 1 else imported[0]
