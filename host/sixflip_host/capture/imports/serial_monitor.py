"""What a serial monitor and a plotter put around a board's numbers, taken off again.

Arduino's monitor writes the time of day a line came at before it (`12:00:00.000 -> 1,2,3`), others
in brackets (`[12:00:00.000] 1,2,3`). Its plotter wants a name before each value (`ax:4,ay:-4`);
others print `ax=4 ay=-4`, or a line of JSON with such pairs.
"""

import collections
import re
from dataclasses import dataclass

TIME = r"(\d\d:\d\d:\d\d(?:[.,]\d+)?)"
STAMPED = re.compile(r"\s*(?:%s\s*->|\[%s\])\s?" % (TIME, TIME))
NAME = r"[A-Za-z_°][\w °/²^.()\[\]]*?"
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
LABELLED = re.compile(r"\s*\"?(%s)\"?\s*[:=]\s*(%s)\s*(?:[,;\t ]\s*|\Z)" % (NAME, NUMBER))
JSON = re.compile(r"\s*\{(.*)\}\s*\Z")
NUMBER_FIRST = re.compile(r"\s*\"?%s\s*\"?(?:[,;\t ]|\Z)" % NUMBER)
ARRIVED = "arrival_date"  # the column of the monitor's times: a board's own are better


@dataclass(frozen=True)
class Dress:
    """stamped: each line begins with a time of day; names: of the values that carry theirs, or
    (); separator: of the values; first: lines before the first one with labels."""

    stamped: bool
    names: tuple
    separator: str
    first: int

    @property
    def said(self):
        """Sentences on what was taken off."""
        return ["each line begins with the time of day it came at, as a serial monitor writes it"
                ] * self.stamped + [
                    "each value has its name before it, as a serial plotter wants it"
                ] * bool(self.names)

    def plain(self, text):
        """A text of lines as lines of a table, as many as there were."""
        return "\n".join(map(self._line, text.split("\n")))

    def _line(self, text):
        """One line as a row of a table; as it is where it is not like the others."""
        stamp, rest = _stamp_of(text)
        if self.stamped and (stamp is None or not rest.strip()):
            return text if stamp is None else ""
        if self.names:
            labelled = _labelled(rest)
            if tuple(name for name, _ in labelled) != self.names:
                return text
            rest = self.separator.join(value for _, value in labelled)
        if not self.stamped:
            return rest
        # Names of columns have the time that they came at before them, too.
        first = stamp.replace(",", ".") if NUMBER_FIRST.match(rest) else ARRIVED
        return first + self.separator + rest

    def columns(self, names):
        """Names of all columns; names: those that were said, or None."""
        names = list(names or self.names)
        return [ARRIVED] * (self.stamped and bool(names) and names[0] != ARRIVED) + names or None


def told(lines):
    """The Dress that most of a file's first lines wear, or None."""
    some = [(place, *_stamp_of(text)) for place, text in enumerate(lines) if text.strip()]
    stamped = 2 * sum(stamp is not None for _, stamp, _ in some) > len(some)
    rests = [(place, rest if stamped else lines[place]) for place, _, rest in some]
    labels = [(tuple(name for name, _ in _labelled(rest)), place) for place, rest in rests]
    (names, number), = collections.Counter(names for names, _ in labels).most_common(1)
    if not names or 2 * number <= len(labels):
        names = ()
    if not stamped and not names:
        return None
    first = next((place for those, place in labels if those == names), 0) if names else 0
    return Dress(stamped, names, "," if names else _separator([rest for _, rest in rests]), first)


def _stamp_of(text):
    """(time of day that a line begins with or None, what is behind it)."""
    match = STAMPED.match(text)
    return (None, text) if match is None else (match[1] or match[2], text[match.end():])


def _separator(rests):
    """The delimiter that most lines have: some may be greetings."""
    for mark in ",;\t":
        if 2 * sum(mark in rest for rest in rests) > len(rests):
            return mark
    return " "


def _labelled(text):
    """[(name, value)] of a line of labelled values, [] of any other."""
    text = JSON.sub(r"\1", text)
    pairs, place, end = [], 0, len(text.rstrip())
    while place < end:
        match = LABELLED.match(text, place)
        if match is None:
            return []
        pairs.append((match[1].strip(), match[2]))
        place = match.end()
    return pairs if len(pairs) > 2 else []  # three axes; fewer may be a sentence
