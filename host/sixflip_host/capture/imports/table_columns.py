"""Which columns of a table hold the readings and which the times: said, or told from the names and
the first row."""

import os
from typing import NamedTuple

import numpy as np

from ...errors import BadFile, UsageError
from ..capture_header import ACCEL, GYRO, MAG
from ..capture_rows import quoted
from . import column_names, csv_mapping, wall_clock

# Share of rows that have another stamp than the row before, where a clock tells them apart: a log
# that is read three times as fast as its sensor may take the sensor's stamps with its values.
ROWS_OF_THEIR_OWN = 0.3


class Readings(NamedTuple):
    """columns: {our name: column of the table}; units: {sensor: unit in the names}; remarks:
    sentences on what was left out."""

    columns: dict
    units: dict
    remarks: list


class Times(NamedTuple):
    """columns: names of those that hold the times (two: seconds and nanoseconds), or None; unit
    in the name, or ""; rate: Hz that the file says where it has no times, or None; assumed:
    sentences."""

    columns: object
    unit: str
    rate: object
    assumed: tuple


def readings(options, table):
    """Readings of a table; UsageError for a --map that is none, BadFile for an axis without a
    column."""
    given = csv_mapping.parse_pairs("--map", options.map)
    for name in given:
        if name not in csv_mapping.TARGETS:
            raise UsageError("--map %s: expected one of %s" % (
                name, " ".join(csv_mapping.TARGETS)))
        table.index(given[name])
    columns, named, left = column_names.readings(table.names or (),
                                                 os.path.basename(str(table.path)))
    mapped = [sensor for sensor in (column_names.ACCEL, column_names.GYRO, column_names.MAG)
              if {sensor + axis for axis in "xyz"} <= set(given)]
    remarks = [words for sensor, words in left.items() if sensor not in mapped]
    for sensor in mapped:       # the unit is that of the columns that were said
        told = [column_names.column(table.names[table.index(given[sensor + axis])])
                for axis in "xyz" if table.names]
        said = {one.unit if one and one.sensor == sensor else "" for one in told}
        named[sensor] = said.pop() if len(said) == 1 else ""
    used = set(given.values())
    chosen = {ours: name for ours, name in columns.items()
              if ours not in given and name not in used}
    if "mx" in chosen and options.mag_lsb is None:      # of no use to anybody here
        for name in MAG:
            chosen.pop(name, None)
    chosen.update(given)
    rates = {name.strip().lower(): name for name in table.names or () if name not in used}
    if "gx" not in chosen and "ax" in chosen and set("pqr") <= set(rates):
        chosen.update((ours, rates[letter]) for ours, letter in zip(GYRO, "pqr"))
        remarks.append("columns %s are taken as the gyro's: the rates of roll, pitch and yaw" % (
            " ".join(chosen[ours] for ours in GYRO)))
    for group in (ACCEL, GYRO, MAG):
        there = [name for name in group if name in chosen]
        if there and len(there) < 3:
            _no_column(table, next(name for name in group if name not in chosen))
    if "ax" not in chosen and "gx" not in chosen:
        _no_column(table, "ax")
    named = {sensor: unit for sensor, unit in named.items() if unit}
    return Readings(chosen, {**named, **table.units}, remarks)


def _no_column(table, absent):
    if not table.names:
        raise BadFile("%s: no column names in it, expected --columns with a name for each of "
                      "its %d columns, such as ax,ay,az,gx,gy,gz, and - for others" % (
                          table.path, table.width))
    raise BadFile("%s: no column for %s, expected --map %s=NAME with one of %s" % (
        table.path, absent, absent, " ".join(table.names)))


def times(options, table, taken):
    """Times of a table; taken: the columns of its readings. Where nobody says a rate, UsageError
    where there is no column of that name, BadFile where what is in it is no time."""
    if options.time_column:
        table.index(options.time_column)
        return Times((options.time_column,), _unit_of_stamps(options, table, options.time_column)
                     or column_names.unit_of_time(options.time_column), None, ())
    found, unread = [], []
    for name, unit in column_names.times(table.names or ()):
        pair = name if isinstance(name, tuple) else (name,)
        if set(pair) & taken:
            continue
        if len(pair) == 1 and _unit_of_stamps(options, table, name):
            found.append(Times(pair, "s", None, (
                "times are the dates and times of day in the column %s" % name,)))
        elif all(table.holds_numbers(one) for one in pair):
            found.append(Times(None, unit, None, ()) if options.rate is not None
                         and options.time_unit is None and not unit     # the rate was said
                         else Times(pair, unit, None, (
                             "times are in the column %s" % " and ".join(pair),)))
        else:
            unread += [one for one in pair if not table.holds_numbers(one)]
    if found:
        fine = [one for one in found if len(found) == 1 or _tells_rows_apart(table, one.columns)]
        return (fine or found)[0]
    stated = getattr(table, "rate_hz", None)
    if options.rate is None and stated is not None:
        return Times(None, "", stated, ("%g Hz, as the file says" % stated,))
    if options.rate is None:
        if unread:
            raise BadFile("%s: the column %s begins with %s, expected a number or %s; or --rate HZ"
                          % (table.path, unread[0], quoted(table.first_cell(unread[0])),
                             wall_clock.EXPECTED))
        raise UsageError("%s: no column of times was recognised, expected --rate HZ, or "
                         "--time-column with one of %s" % (table.path, " ".join(
                             table.names or ["1 to %d" % table.width])))
    return Times(None, "", None, ())


def _tells_rows_apart(table, columns):
    """True where the first rows of columns of times, or of none, have stamps of their own: more
    than whole seconds are, which the rows of one share."""
    if columns is None:
        return True
    try:
        stamps = next(table.blocks(list(columns))).values
    except BadFile:         # which is said where they are read, if they are the best there are
        return True
    anew = np.any(stamps[1:] != stamps[:-1], axis=1)
    return not len(anew) or bool(anew.mean() > ROWS_OF_THEIR_OWN)


def _unit_of_stamps(options, table, name):
    """"s" of a column of dates and times of day, which are read as seconds; "" of any other."""
    if not getattr(table, "holds_stamps", lambda one: False)(name):
        return ""
    if options.time_unit not in (None, "s"):
        raise UsageError("--time-unit %s: %s holds dates and times of day, expected none" % (
            options.time_unit, name))
    return "s"
