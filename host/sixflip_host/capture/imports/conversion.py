"""A capture out of somebody else's table: columns, times, units and labels, each given or told
from names and values, and every assumption said."""

import os
from dataclasses import dataclass, replace

import numpy as np

from sixflip.chips import catalogue

from ...errors import BadFile, UsageError
from .. import clock
from ..capture_file import Capture, check_times
from ..capture_header import ACCEL, GYRO, MAG, check_sensor
from ..growing import Growing
from . import column_names, csv_mapping, time_stamps, units
from .options import with_the_file
from .told_units import ToldUnits

TEMPERATURE = {row[0]: catalogue.driver(row[0]).TEMPERATURE for row in catalogue.CHIPS
               if row[1] and catalogue.driver(row[0]).TEMPERATURE}
CELSIUS = (100, 0.0)            # counts per °C and offset, of a chip whose own are not known
COLD_C, HOT_C = -60.0, 150.0    # what a chip can have


@dataclass(frozen=True)
class Imported:
    """capture; assumed: sentences on what nobody said; remarks: on what was found."""

    capture: Capture
    assumed: tuple
    remarks: tuple


class Conversion:
    """One table becoming a Capture, step by step; `assumed` and `remarks` grow on the way."""

    def __init__(self, options, table):
        self.options, self.table = with_the_file(options, table), table
        self.assumed, self.remarks = [], []
        self.columns, self.named_units = self._readings()
        self.time = self._time_column()

    def run(self):
        """Imported."""
        values, times, labels = self._read()
        for why, lines in self.table.passed_over.items():
            self.remarks.append("passed over: %s (%d line%s)" % (why, lines, "s" * (lines > 1)))
        self.assumed += getattr(self.table, "said", ())
        pose = self._poses(labels)
        celsius = values.get("temp")
        t_us, order = self._times(times, values, None if celsius is None else celsius[:, 0])
        if order is not None:
            values = {name: block[order] for name, block in values.items()}
            pose = pose if pose is None else pose[order]
        capture = self._capture(values, t_us, pose)
        return Imported(capture, tuple(self.assumed), tuple(self.remarks))

    # what is which

    def _readings(self):
        """({our name: column of the table}, {sensor: unit in the names})."""
        options, table = self.options, self.table
        given = csv_mapping.parse_pairs("--map", options.map)
        for name in given:
            if name not in csv_mapping.TARGETS:
                raise UsageError("--map %s: expected one of %s" % (
                    name, " ".join(csv_mapping.TARGETS)))
            table.index(given[name])
        found, named, remarks = column_names.readings(table.names or (),
                                                      os.path.basename(str(table.path)))
        used = set(given.values())
        chosen = {ours: name for ours, name in found.items()
                  if ours not in given and name not in used}
        if "mx" in chosen and options.mag_lsb is None:      # of no use to anybody here
            for name in MAG:
                chosen.pop(name, None)
        chosen.update(given)
        for group in (ACCEL, GYRO, MAG):
            there = [name for name in group if name in chosen]
            if there and len(there) < 3:
                self._no_column(next(name for name in group if name not in chosen))
        if "ax" not in chosen and "gx" not in chosen:
            self._no_column("ax")
        self.remarks += remarks
        return chosen, {**named, **table.units}

    def _no_column(self, absent):
        names = self.table.names
        if not names:
            raise BadFile("%s: no column names in it, expected --columns with a name for each of "
                          "its %d columns, such as ax,ay,az,gx,gy,gz, and - for others" % (
                              self.table.path, self.table.width))
        raise BadFile("%s: no column for %s, expected --map %s=NAME with one of %s" % (
            self.table.path, absent, absent, " ".join(names)))

    def _time_column(self):
        """Names of the columns that hold the times (two: seconds and nanoseconds), or None."""
        options, table = self.options, self.table
        if options.time_column:
            table.index(options.time_column)
            self._stamps(options.time_column)
            return (options.time_column,)
        taken = set(self.columns.values())
        for name, unit in column_names.times(table.names or ()):
            pair = name if isinstance(name, tuple) else (name,)
            if set(pair) & taken:
                continue
            if len(pair) == 1 and self._stamps(name):
                self.assumed.append("times are the dates and times of day in the column %s" % name)
                return pair
            if all(table.holds_numbers(one) for one in pair):
                self._named_time_unit = unit
                if options.rate is not None and options.time_unit is None and not unit:
                    return None         # the rate was said, and no more
                self.assumed.append("times are in the column %s" % " and ".join(pair))
                return pair
        stated = getattr(table, "rate_hz", None)
        if options.rate is None and stated is not None:
            self.options = replace(options, rate=stated)
            self.assumed.append("%g Hz, as the file says" % stated)
        elif options.rate is None:
            raise UsageError("%s: no column of times was recognised, expected --rate HZ, or "
                             "--time-column with one of %s" % (table.path, " ".join(
                                 table.names or ["1 to %d" % table.width])))
        return None

    _named_time_unit = ""
    _dated = False          # times are dates and times of day, which are read as seconds

    def _stamps(self, name):
        """Whether a column holds dates and times of day."""
        self._dated = getattr(self.table, "holds_stamps", lambda one: False)(name)
        if self._dated and self.options.time_unit not in (None, "s"):
            raise UsageError("--time-unit %s: %s holds dates and times of day, expected none" % (
                self.options.time_unit, name))
        self._named_time_unit = "s" if self._dated else ""
        return self._dated

    # reading

    def _read(self):
        """({group: float32 (n, k)}, float64 times (n, 1 or 2) or None, labels)."""
        groups = {group: [self.columns[name] for name in group]
                  for group in (ACCEL, GYRO, MAG) if group[0] in self.columns}
        if "temp" in self.columns:
            groups["temp"] = [self.columns["temp"]]
        names = [name for columns in groups.values() for name in columns]
        names += list(self.time or ())
        grown = {group: Growing(np.float32, len(columns)) for group, columns in groups.items()}
        self._sizes = {group: units.Sizes() for group in (ACCEL, GYRO) if group in groups}
        times = Growing(float)
        self._lines, self._label_number, self._label_of = [], Growing(np.int32), {}
        last = -np.inf
        rows = 0
        for block in self.table.blocks(names, self.options.label_column):
            at = 0
            self._lines.append((rows, block.lines))
            rows += len(block.lines)
            for group, columns in groups.items():
                some = block.values[:, at:at + len(columns)]
                grown[group].add(self._of_a_sensor(group, some))
                if group in self._sizes:    # before they are rounded to 32 bits
                    self._sizes[group].add(some)
                at += len(columns)
            if self.time:
                stamps = block.values[:, at]
                if len(self.time) == 2:     # seconds and nanoseconds
                    stamps = self._whole_seconds(stamps) + 1e-9 * block.values[:, at + 1]
                if not self.options.sort:
                    self._forwards(block.lines, stamps, last)
                last = stamps[-1]
                times.add(stamps)
            if block.labels is not None:
                self._label_number.add([self._label_of.setdefault(one, len(self._label_of))
                                        for one in block.labels])
        self.rows = rows
        labels = self._label_number.array() if self.options.label_column else None
        return ({group: one.array() for group, one in grown.items()},
                times.array() if self.time else None, labels)

    _first_second = None

    def _whole_seconds(self, seconds):
        """Seconds from the first one on: with nanoseconds behind them they are beyond a float."""
        if self._first_second is None:
            self._first_second = seconds[0]
        return seconds - self._first_second

    def _of_a_sensor(self, group, values):
        if group != "temp" and len(values) and not np.abs(values).max() < units.LARGEST:
            raise BadFile("%s: the %s reaches %g, expected less than %g" % (
                self.table.path, _what(group), np.abs(values).max(), units.LARGEST))
        return values

    def _forwards(self, lines, times, last):
        """BadFile for the first time that is before the one before it."""
        steps = np.diff(times, prepend=last)
        if (steps < 0).any():
            row = int(np.argmax(steps < 0))
            raise BadFile.at(self.table.path, lines[row], "%s runs backwards, from %.17g to %.17g"
                             % (" and ".join(self.time), times[row] - steps[row], times[row]),
                             "increasing times (or --sort)")

    def line_of(self, row):
        """Line of the file that a row came from, 0 where it has no lines."""
        for first, lines in reversed(self._lines):
            if row >= first:
                return lines[row - first]
        return 0

    # times

    def _times(self, times, values, celsius):
        """int64 microseconds, and the order that sorts them or None."""
        options = self.options
        if times is None:
            if not self.rows / options.rate < time_stamps.LATEST_US / 1e6:
                raise UsageError("--rate %g: expected samples per second" % options.rate)
            return np.rint(np.arange(self.rows) * (1e6 / options.rate)).astype(np.int64), None
        name = " and ".join(self.time)
        order = None
        if options.sort:
            order, moved, farthest = time_stamps.sorted_order(times)
            if order is not None:
                times = times[order]
                self.remarks.append("%d rows moved to put %s in order, the farthest by %d rows"
                                    % (moved, name, farthest))
        unit = options.time_unit or ("s" if len(self.time) == 2 else self._named_time_unit)
        if not unit:
            unit, words = time_stamps.unit_of(self.table.path, name, times, celsius)
            self.assumed.append(words)
        scale = 1e6 / options.rate if unit == "samples" else column_names.TIME_UNITS[unit]
        time_stamps.check_stretch(
            self.table.path, name, times, scale,
            lambda row: self.line_of(int(row if order is None else order[row])))
        return time_stamps.microseconds(self.table.path, name, times, scale, unit), order

    # labels

    def _poses(self, labels):
        """Pose codes from a label column or a sections file, or None."""
        options = self.options
        given = csv_mapping.parse_pairs("--label", options.label)
        if options.label_column:
            pose, moving = csv_mapping.poses_from_labels(list(self._label_of), labels, given)
        elif options.sections:
            pose, moving = csv_mapping.poses_from_sections(options.sections, self.rows, given)
        else:
            return None
        if not pose.any():
            raise BadFile("%s: no label is a pose, expected --label THEIRS=Z+a for %s" % (
                options.sections or options.file, " ".join(moving)))
        if moving:
            self.remarks.append("taken as moving: " + " ".join(moving))
        return pose

    # counts

    def _capture(self, values, t_us, pose):
        options, path = self.options, self.table.path
        rate = self._rate(t_us)
        check_times(path, t_us, rate["rate_hz"])
        meta = {"sensor": options.sensor, **rate, "g": options.g}
        accel, gyro = values.pop(ACCEL, None), values.pop(GYRO, None)
        for group, block in ((ACCEL, accel), (GYRO, gyro)):
            signed = units.give_sign(block) if block is not None else ""
            if signed:
                self.assumed.append("%s counts have no sign: taken as %s" % (
                    _what(group), signed))
        told = ToldUnits(path, options, self.named_units, self.rows, self.assumed)
        accel_unit, accel_lsb = told.of_accelerometer(accel)
        gyro_unit = told.of_gyro(gyro, accel_unit)
        if accel is not None and gyro is not None:
            gyro_unit = told.turned(accel, gyro, gyro_unit, meta["rate_hz"])
        counts = {}
        if accel is not None:
            per_unit = {"si": 1 / options.g, "m/s2": 1 / options.g}.get(
                accel_unit, units.ACCEL_UNITS[accel_unit])
            counts[ACCEL] = units.counts_of(path, "accelerometer", accel, accel_unit,
                                            accel_lsb, per_unit, self._sizes[ACCEL].step())
            meta["accel_lsb_per_g"] = counts[ACCEL].lsb
            del accel
            step = units.common_step(counts[ACCEL].counts)
            if step > 1:
                self.remarks.append("every accelerometer count is a multiple of %d: its "
                                    "resolution is %.2f mg" % (step, 1e3 * step
                                                               / counts[ACCEL].lsb))
        if gyro is not None:
            counts[GYRO] = units.counts_of(path, "gyro", gyro, gyro_unit, options.gyro_lsb,
                                           units.GYRO_UNITS[gyro_unit],
                                           self._sizes[GYRO].step())
            meta["gyro_lsb_per_dps"] = counts[GYRO].lsb
            del gyro
        if MAG in values:
            counts[MAG] = units.counts_of(path, "magnetometer", values[MAG], "counts",
                                          options.mag_lsb, None)
            meta["mag_lsb_per_ut"] = options.mag_lsb
        for group, key in ((ACCEL, "accel_values"), (GYRO, "gyro_values")):
            if group in counts:
                self.remarks += counts[group].remarks
                if counts[group].kind == "float":
                    meta[key] = "float"
        temp = self._temperature(meta, values["temp"][:, 0]) if "temp" in values else None
        meta["imported_from"] = os.path.basename(str(path))
        capture = Capture(meta, t_us, *(counts[group].counts if group in counts else None
                                        for group in (ACCEL, GYRO)), temp=temp,
                          mag=counts[MAG].counts if MAG in counts else None, pose=pose)
        check_sensor(meta, capture.columns(), lambda found, expected: BadFile(
            "%s: %s, expected %s" % (path, found, expected)))
        return capture

    def _rate(self, t_us):
        """rate_hz of the header, and whether it was measured."""
        if self.options.rate is not None and (self.time is None
                                              or self.options.time_unit == "samples"):
            return {"rate_hz": self.options.rate, "rate": "stated"}
        measured = clock.measure(t_us)
        if measured is None:
            if self.options.rate is None:
                raise BadFile("%s: the times do not say the rate, expected times that run, or "
                              "--rate HZ" % self.table.path)
        else:
            self.remarks += clock.words(measured)
        if self.options.rate is not None:
            return {"rate_hz": self.options.rate, "rate": "stated"}
        return clock.header(measured)

    def _temperature(self, meta, values):
        """int16 counts of the thermometer; None where the column is none."""
        options, path = self.options, self.table.path
        lsb, offset = TEMPERATURE.get(options.sensor, CELSIUS)
        kind = options.temp_units
        if kind is None:
            celsius = bool(values.min() >= COLD_C and values.max() <= HOT_C)
            kind = "c" if celsius else "counts" if options.sensor in TEMPERATURE else None
            if kind == "c":
                self.assumed.append("%s is in °C" % self.columns["temp"])
            elif kind is None:
                self.remarks.append("%s goes from %g to %g, which is no °C: left out" % (
                    self.columns["temp"], values.min(), values.max()))
                return None
        if kind == "counts" and options.sensor not in TEMPERATURE:
            raise UsageError("--temp-units counts needs --sensor %s" % " or ".join(TEMPERATURE))
        counts = np.rint((values.astype(float) - offset) * lsb if kind == "c" else values)
        if np.abs(counts).max() > 32767:
            raise BadFile("%s: the temperature reaches %g, expected %s" % (
                path, values[np.argmax(np.abs(counts))],
                "°C" if kind == "c" else "16 bit counts (or --temp-units c)"))
        meta["temp_lsb_per_c"], meta["temp_offset_c"] = lsb, offset
        return counts.astype(np.int16)


def _what(group):
    return {ACCEL: "accelerometer", GYRO: "gyro", MAG: "magnetometer"}[group]


