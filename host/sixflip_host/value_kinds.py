"""Kinds of values that come from a board or a file: what is expected, and the value once checked.

A kind has `expected`, words for a person, and take(value), which returns the value or raises
Misfit. Nothing that comes out is of another type, out of range, or deeper than its table says.
"""

from sixflip.poses.faces import FACES, pose_code

LONGEST_TEXT = 1000     # characters of a text that are kept: reasons are sentences
MOST_ITEMS = 1000       # of a list; a plan has hundreds of placements
LARGEST = 1e9           # of a measured number, in any unit the firmware uses


class Misfit(ValueError):
    """A value that is not what its table says, in words."""

    def __init__(self, value, expected, where=""):
        super().__init__(value, expected, where)
        self.value, self.expected, self.where = value, expected, where

    def inside(self, name):
        """The same, seen from the object or list that it is in."""
        inner = self.where and (self.where if self.where[0] == "[" else "." + self.where)
        return Misfit(self.value, self.expected, name + inner)

    def __str__(self):
        return "%sis %s, expected %s" % (self.where and self.where + " ", named(self.value),
                                         self.expected)


def named(value):
    """A few words for any value at all, however deep or long it is."""
    if isinstance(value, str):
        return '"%s"' % value[:40]
    if value is None or isinstance(value, bool):
        return {None: "nothing", True: "true", False: "false"}[value]
    if isinstance(value, float):
        return "%g" % value
    if isinstance(value, int):
        return "%d" % value if value.bit_length() < 128 else "a number of %d bits" \
            % value.bit_length()
    if isinstance(value, (list, tuple)):
        return "a list of %d" % len(value)
    return "an object" if isinstance(value, dict) else "of the type %s" % type(value).__name__


class Text:
    """Text without lone surrogates, cut at LONGEST_TEXT; it may hold what a terminal obeys."""

    expected = "a text"

    def take(self, value):
        if not isinstance(value, str):
            raise Misfit(value, self.expected)
        return value[:LONGEST_TEXT].encode("utf-8", "backslashreplace").decode()


class OneOf:
    """One of some words."""

    def __init__(self, *words):
        self.words = words
        self.expected = "one of " + ", ".join(words)

    def take(self, value):
        if not isinstance(value, str) or value not in self.words:
            raise Misfit(value, self.expected)
        return value


class Pose:
    """The name of a pose, or of a face, or "" for none."""

    expected = "a pose such as Z+a or L1"

    def take(self, value):
        try:
            if isinstance(value, str) and (value in FACES or pose_code(value) is not None):
                return value
        except (ValueError, IndexError):
            pass
        raise Misfit(value, self.expected)


class Number:
    """A finite number in a range; a whole one is an int."""

    def __init__(self, low=-LARGEST, high=LARGEST, whole=False):
        self.low, self.high, self.whole = low, high, whole
        self.expected = "a %snumber from %.10g to %.10g" % ("whole " if whole else "", low, high)

    def take(self, value):
        of_type = isinstance(value, int) or isinstance(value, float) and not self.whole
        if isinstance(value, bool) or not of_type or not self.low <= value <= self.high:
            raise Misfit(value, self.expected)
        return value


class Flag:
    """True or false."""

    expected = "true or false"

    def take(self, value):
        if not isinstance(value, bool):
            raise Misfit(value, self.expected)
        return value


class Octets:
    """Bytes, one or more (of a literal or a database; JSON has none)."""

    expected = "one byte or more"

    def take(self, value):
        if not isinstance(value, bytes) or not value:
            raise Misfit(value, self.expected)
        return value


class Either:
    """What fits the first kind that takes it."""

    def __init__(self, *kinds):
        self.kinds = kinds
        self.expected = " or ".join(kind.expected for kind in kinds)

    def take(self, value):
        for kind in self.kinds:
            try:
                return kind.take(value)
            except Misfit:
                continue
        raise Misfit(value, self.expected)


class Nothing:
    """None: where a value may be unknown, as NaN is on the wire."""

    expected = "nothing"

    def take(self, value):
        if value is not None:
            raise Misfit(value, self.expected)


class ListOf:
    """A list of values of one kind."""

    def __init__(self, kind):
        self.kind = kind
        self.expected = "a list"

    def take(self, value):
        if not isinstance(value, (list, tuple)) or len(value) > MOST_ITEMS:
            raise Misfit(value, "a list of at most %d" % MOST_ITEMS)
        return Row(*[self.kind] * len(value)).take(value)


class Row:
    """A list of as many values as kinds, one of each; a tuple stays one."""

    def __init__(self, *kinds):
        self.kinds = kinds
        self.expected = "a list of %d" % len(kinds)

    def take(self, value):
        if not isinstance(value, (list, tuple)) or len(value) != len(self.kinds):
            raise Misfit(value, self.expected)
        taken = []
        for k, (kind, item) in enumerate(zip(self.kinds, value)):
            try:
                taken.append(kind.take(item))
            except Misfit as misfit:
                raise misfit.inside("[%d]" % k) from None
        return tuple(taken) if isinstance(value, tuple) else taken


class MapOf:
    """An object whose names, and whose values, are of one kind each."""

    expected = "an object"

    def __init__(self, name, kind):
        self.name, self.kind = name, kind

    def take(self, value):
        if not isinstance(value, dict) or len(value) > MOST_ITEMS:
            raise Misfit(value, self.expected)
        taken = {}
        for name, item in value.items():
            try:
                taken[self.name.take(name)] = self.kind.take(item)
            except Misfit as misfit:
                raise misfit.inside(named(name)) from None
        return taken


class Json:
    """Text, finite number, flag or null, or a list or an object of those, so and so deep."""

    def __init__(self, deep):
        self.expected = "values at most %d deep" % deep
        self.simple = Either(Nothing(), Flag(), Number(-1e300, 1e300), Text())
        inner = Json(deep - 1) if deep else self.simple
        self.list, self.object = ListOf(inner), MapOf(Text(), inner)

    def take(self, value):
        kind = self.list if isinstance(value, (list, tuple)) else \
            self.object if isinstance(value, dict) else self.simple
        return kind.take(value)


class Fields:
    """An object with the fields of a table; those in `needed` have to be there.

    Others may be missing or null; what no table knows is left out.
    """

    expected = "an object"

    def __init__(self, needed="", **kinds):
        self.needed, self.kinds = needed.split(), kinds

    def take(self, value):
        if not isinstance(value, dict):
            raise Misfit(value, self.expected)
        taken = {}
        for name, kind in self.kinds.items():
            item = value.get(name)
            if item is None and name not in self.needed:
                if name in value:
                    taken[name] = None
                continue
            try:
                taken[name] = kind.take(item)
            except Misfit as misfit:
                raise misfit.inside(name) from None
        return taken
