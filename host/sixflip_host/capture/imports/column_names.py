"""What the columns of somebody's table are, by their names: sensor, axis, unit; times."""

import re
from typing import NamedTuple

from .column_vocabulary import (
    ACCEL,
    ARRIVALS,
    AXIS_FIRST,
    DEGREES,
    DERIVED,
    ESTIMATES,
    FILLERS,
    FUSED_TIMES,
    GYRO,
    KINDS,
    MAG,
    PAIRS,
    TEMP,
    TIME_UNITS,
    TIMES,
    UNIT,
    UNIT_OF_TIME,
    WORDS,
)


class Column(NamedTuple):
    """sensor: ACCEL, GYRO, MAG or TEMP; axis: "x", "y", "z", or a number as the name has it, or
    "" of a temperature; unit: as it stands in the name, or ""; group: the name without its axis,
    which the three columns of one sensor share."""

    sensor: str
    axis: str
    unit: str
    group: str


def column(name):
    """The Column that a name says, or None."""
    bare, unit = _without_unit(name)
    words = _words(bare)
    if not words or {word.rstrip("0123456789") for word in words} & DERIVED:
        return None
    if _is_temperature(words):
        said = unit.lower() or (words[-1] if len(words) > 1 else "")
        degrees = (unit for unit, names in DEGREES.items() if said in names)
        return Column(TEMP, "", next(degrees, ""), "")
    parts = _fused(words) or _apart(words) or _by_unit(words, unit)
    if parts is None:
        return None
    sensor, axis, group = parts
    return Column(sensor, axis, _unit(unit, words, sensor), group)


def _without_unit(name):
    """A name without a unit in brackets, or in g in them, and the unit; an index there stays."""
    match = re.search(r"[\[(]\s*(?:in\s+)?([^\])]*?)\s*[\])]\s*\Z", name)
    if not match or match.group(1).isdigit():
        return name, ""
    return name[:match.start()], match.group(1).replace("\\", "")


def _words(name):
    """field.linear_acceleration.x -> field linear acceleration x; AccX, gyroADC[0] likewise."""
    name = re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", name.strip().lstrip("%#"))
    return [word for word in re.split(r"[^a-z0-9°²^µ]+", name.lower()) if word]


def _unit(unit, words, sensor):
    """The unit of a reading, from its brackets or from the words of the name."""
    given = UNIT.get(unit.lower() if unit != "G" else "g", "")
    runs = [words[first:first + length] for length in (3, 2, 1)
            for first in range(1, len(words) - length + 1)]
    for run in runs if not given else ():
        meant = UNIT_IN_WORDS.get(tuple(run), "")
        # A g alone is the unit where it stands last, behind the axis: acc_x_g, ax_g.
        if meant and (run != ["g"] or words[-1] == "g" and words[-2][-1] in "xyz"):
            given = meant
            break
    return given if given in KINDS.get(sensor, ()) else ""


UNIT_IN_WORDS = {tuple(_words(name)): unit for name, unit in UNIT.items() if unit != "counts"}
BESIDE = FILLERS.union(*UNIT_IN_WORDS)  # words that may stand beside a sensor of one letter


def _is_temperature(words):
    return any(word in ("temp", "temperature", "tmp") for word in words) \
        and not set(words) & {"set", "target", "ambient", "cpu", "battery"}


def _fused(words):
    """(sensor, axis, group) of ax, accx, gyro_x written in one word, or None."""
    for number, word in enumerate(words):
        match = re.match(r"([a-z]+?)_?([xyz])\Z", word)
        if match and word not in FILLERS:
            for sensor, names in WORDS.items():
                single, rest = len(match.group(1)) == 1, set(words) - {word}
                if match.group(1) in names and (
                        not single or rest <= BESIDE or number == len(words) - 1):
                    return sensor, match.group(2), " ".join(
                        words[:number] + [match.group(1)] + words[number + 1:])
        if word[0] in "xyz" and word[1:] in AXIS_FIRST:
            return AXIS_FIRST[word[1:]], word[0], word[1:]
    return None


def _apart(words):
    """(sensor, axis, group) of acc_x, linear_acceleration.x, gyro_rad[0], or None."""
    places = [k for k, word in enumerate(words) if word in ("x", "y", "z")]
    if not places and words[-1].isdigit():
        places = [len(words) - 1]
    if not places:
        match = re.match(r"([a-z]+)([0-3])\Z", words[-1])       # acc1
        if not match:
            return None
        words = [*words[:-1], match.group(1), match.group(2)]
        places = [len(words) - 1]
    place = places[-1]
    rest = words[:place] + words[place + 1:]
    stems = [re.sub(r"\d+\Z", "", word) or word for word in rest]
    for sensor, pairs in PAIRS.items():
        if any(pair == tuple(stems[k:k + 2]) for pair in pairs for k in range(len(stems))):
            return sensor, words[place], " ".join(rest)
    for sensor in (ACCEL, GYRO, MAG):
        long = {word for word in WORDS[sensor] if len(word) > 1}
        if set(stems) & long or (stems and stems[0] in WORDS[sensor]
                                 and set(stems[1:]) <= BESIDE) or any(
                stem.startswith(("accel", "gyro", "magneto")) and sensor == stem[0]
                for stem in stems):
            return sensor, words[place], " ".join(rest)
    return None


def _by_unit(words, unit):
    """(sensor, axis, group) of an axis alone whose unit only one sensor has: x [mg], or None."""
    axis = [word for word in words if word != "axis"]
    if len(axis) == 1 and axis[0] in ("x", "y", "z"):
        for sensor in (ACCEL, GYRO):
            if _unit(unit, words, sensor) not in ("", "counts"):
                return sensor, axis[0], "axis"
    return None


def readings(names, file_name=""):
    """({ax … gz, mx … mz, temp: column name}, {ACCEL, GYRO: unit}, {sensor: what was left out}) of
    a table's columns. The first whole set of three of a sensor is taken that has the fewest words
    of an estimate. Columns that are called x, y and z and nothing else are what the file's own
    name says they are."""
    if not any(column(name) for name in names):
        lower = {name.strip().lower(): name for name in names}
        sensor = next((sensor for sensor, part in ((GYRO, "gyr"), (ACCEL, "acc"))
                       if part in file_name.lower()), None)
        if sensor and set("xyz") <= set(lower):
            return {sensor + axis: lower[axis] for axis in "xyz"}, {}, {}
    columns, sets = {}, {}
    for name in names:
        told = column(name)
        if told is None:
            continue
        if told.sensor == TEMP:
            columns.setdefault("temp", name)
        else:
            sets.setdefault((told.sensor, told.group), {}).setdefault(told.axis, (name, told.unit))
    units, remarks = {}, {}
    best = sorted(sets, key=lambda one: len(ESTIMATES.intersection(one[1].split())))
    for sensor in (ACCEL, GYRO, MAG):
        whole = [sets[one] for one in best if one[0] == sensor and _axes(sets[one]) is not None]
        if not whole:       # what there is of it shows what is missing
            for (kind, _), axes in sets.items():
                for axis in set("xyz") & set(axes) if kind == sensor else ():
                    columns.setdefault(sensor + axis, axes[axis][0])
            continue
        for axis, key in zip("xyz", _axes(whole[0])):
            columns[sensor + axis] = whole[0][key][0]
        said = {unit for _, unit in whole[0].values()}
        if len(said) == 1 and "" not in said:
            units[sensor] = said.pop()
        if len(whole) > 1:
            remarks[sensor] = "columns %s are taken, %s are left out" % tuple(
                " ".join(name for other in some for name, _ in other.values())
                for some in (whole[:1], whole[1:]))
    return columns, units, remarks


def _axes(axes):
    """The keys of x, y and z in a set of columns, or None where it is not whole."""
    for keys in (("x", "y", "z"), ("0", "1", "2"), ("1", "2", "3")):
        if set(keys) <= set(axes):
            return keys
    return None


def with_units(names, below):
    """names with the units that stand in the line below them, or None where those are none."""
    known = {*UNIT, *UNIT_OF_TIME, *(unit for names in DEGREES.values() for unit in names)}
    units = [cell.strip().lower() for cell in below]
    if len(below) != len(names) or sum(unit in known for unit in units) < 3:
        return None
    return [name if not unit or _without_unit(name)[1] else "%s [%s]" % (name, unit)
            for name, unit in zip(names, units)]


def looks_like_header(names):
    """True for a line of names that has all three axes of an accelerometer or a gyro."""
    columns = readings(names)[0]
    return any({sensor + axis for axis in "xyz"} <= set(columns) for sensor in (ACCEL, GYRO))


def times(names):
    """[(column name or (seconds, nanoseconds), unit or "")] of times, best and finest first."""
    ranks = []
    for name in names:
        bare, _ = _without_unit(name)
        words = _words(bare)
        if not words or set(words) & {"covariance", "diff", "delta", "dt", "zone"}:
            continue
        if set(words) & TIMES or words[-1] in FUSED_TIMES:
            rank = 0 if {"stamp", "header"} <= set(words) else 3 if set(words) & ARRIVALS \
                else 4 if bare == "T" else 1
            ranks.append((rank, name, unit_of_time(name)))
        elif len(words) == 1 and len(words[0]) > 1 \
                and UNIT_OF_TIME.get(words[0]) in TIME_UNITS:
            ranks.append((2, name, UNIT_OF_TIME[words[0]]))
    chosen = [(pair, "s") for pair in _second_pairs(names)]
    taken = {name for pair, _ in chosen for name in pair}
    left = [row for row in ranks if row[1] not in taken]
    return chosen + [row[1:] for row in sorted(left, key=lambda row: (
        row[0], row[2] not in ("ns", "us")))]


def unit_of_time(name):
    """The unit that a column of times has by its name: in brackets, or its last word; or ""."""
    bare, unit = _without_unit(name)
    last = "".join(_words(bare)[-1:])
    return UNIT_OF_TIME.get(unit.lower()) or (UNIT_OF_TIME | FUSED_TIMES).get(last, "")


def _second_pairs(names):
    """[(seconds, nanoseconds)] of stamps that ROS keeps in two columns."""
    pairs = []
    for name, words in zip(names, map(_words, names)):
        if words and words[-1] in ("sec", "secs", "s"):
            for other in names:
                theirs = _words(other)
                if theirs and theirs[:-1] == words[:-1] and theirs[-1] in (
                        "nanosec", "nsec", "nsecs", "nanosecs"):
                    pairs.append((name, other))
    return pairs
