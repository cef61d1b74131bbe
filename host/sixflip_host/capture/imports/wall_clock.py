"""Stamps that are written as dates and times of day, made seconds.

ISO 8601, with T or a blank between, fractions behind a point or a comma, and a zone or none; the
month by its English name, as MATLAB writes it (31-May-2024); or the time of day alone. A date
with slashes says day or month first, nobody knows which, and is refused.
"""

import datetime
import functools
import re

MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
STAMP = re.compile(r"(?:(?:(\d{4})-(\d\d)-(\d\d)|(\d\d)-(" + "|".join(MONTHS) + r")-(\d{4}))"
                   r"[T ])?(\d\d):(\d\d):(\d\d)(?:[.,](\d{1,12}))?"
                   r"\s?(Z|UTC|GMT|[+-]\d\d:?\d\d)?\Z", re.IGNORECASE)
AMBIGUOUS = re.compile(r"\d{1,4}[/.]\d{1,2}[/.]\d{1,4}(\D|\Z)")
EXPECTED = "ISO 8601, such as 2024-05-31T12:00:00.250"


def is_stamp(cell):
    """True for a date with a time of day, or a time of day."""
    return STAMP.match(cell) is not None


def is_ambiguous(cell):
    """True for a date whose day and month cannot be told apart by its form."""
    return AMBIGUOUS.match(cell) is not None


def seconds(cell):
    """Seconds of a stamp, from 1970 in its own zone or else as if in UTC, or from midnight;
    ValueError for what is none, or for a day that there is not."""
    match = STAMP.match(cell)
    if match is None:
        raise ValueError(cell)
    year, month, day, named_day, name, named_year, *time = match.groups()
    hours, minutes, whole, part, zone = time
    if name:
        year, month, day = named_year, MONTHS.index(name.lower()) + 1, named_day
    total = int(hours) * 3600 + int(minutes) * 60 + int(whole) - _ahead(zone or "")
    if int(hours) > 23 or int(minutes) > 59 or int(whole) > 60:
        raise ValueError(cell)
    if year:
        total += _days(int(year), int(month), int(day)) * 86400
    return total + (int(part) / 10 ** len(part) if part else 0.0)


@functools.lru_cache(maxsize=64)
def _days(year, month, day):
    return datetime.date(year, month, day).toordinal() - datetime.date(1970, 1, 1).toordinal()


@functools.lru_cache(maxsize=64)
def _ahead(zone):
    """Seconds that a zone is ahead of UTC."""
    if not zone or zone[0] not in "+-":
        return 0
    digits = zone[1:].replace(":", "")
    size = int(digits[:2]) * 3600 + int(digits[2:]) * 60
    return -size if zone[0] == "-" else size
