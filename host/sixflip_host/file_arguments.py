"""The arguments of a verb that are files: those it reads, those it writes, and the one rule
for the latter. What is read is never overwritten; what is there already is replaced only by
something of its own kind, or with --force."""

import os

from . import file_kinds
from .errors import UsageError


def add_input(parser, *names, **options):
    """An argument that names a file, or files, to read."""
    action = parser.add_argument(*names, **options)
    action.reads = True
    return action


def add_output(parser, *names, kinds=(), writes=None, **options):
    """An argument that names what is written; the verb gets --force with it.

    kinds   of file_kinds, that an older file of this name may be of; or function(args) of them
    writes  function(name, args) -> [(path, kinds)], where more or other files than the one
            named are written
    """
    action = parser.add_argument(*names, **options)
    action.writes = writes or (
        lambda name, args: [(name, kinds(args) if callable(kinds) else kinds)])
    if "--force" not in parser._option_string_actions:  # argparse has no other way to ask
        parser.add_argument("--force", action="store_true",
                            help="replace a file of another kind, too")
    return action


def check(parser, args):
    """UsageError where a command line would overwrite what it reads, or what is not its own."""
    read, written = [], []
    for action in parser._actions:
        if hasattr(action, "reads"):
            read += _names(getattr(args, action.dest))
        elif hasattr(action, "writes"):
            for name in _names(getattr(args, action.dest)):
                written += action.writes(name, args)
    for number, (path, _) in enumerate(written):
        for other in read:
            if _same(path, other):
                raise UsageError("%s: is read and would be overwritten, expected another file to "
                                 "write" % path)
        if any(_same(path, other) for other, _ in written[:number]):
            raise UsageError("%s: would be written twice, expected a file for each" % path)
    may_replace(written, getattr(args, "force", False))


def may_replace(written, force=False):
    """UsageError for the first of [(path, kinds)] that is there and is of none of its kinds."""
    for path, kinds in written:
        if force or not os.path.isfile(path):
            continue
        kind = file_kinds.kind_of(path)
        if kind not in ("", *kinds):
            raise UsageError("%s: is there already and is %s, expected another name, or %s there "
                             "(or --force)" % (path, kind or "of another kind",
                                               " or ".join(kinds) or "nothing"))


def _names(value):
    """The names in an argument's value; none where it was not given."""
    return [os.fspath(name) for name in (value if isinstance(value, list) else [value])
            if name is not None]


def _same(name, other):
    """Whether two names are one regular file, through links of either kind."""
    try:
        if os.path.exists(name) and os.path.exists(other):
            return os.path.isfile(name) and os.path.samefile(name, other)
        return os.path.realpath(name) == os.path.realpath(other)
    except (OSError, ValueError):
        return False
