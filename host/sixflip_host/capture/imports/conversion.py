"""A capture out of somebody else's table: columns, times, units and labels, each given or told
from names and values, and every assumption said."""

import os
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadFile, UsageError
from ..capture_file import Capture, check_times
from ..capture_header import ACCEL, GYRO, MAG, check_sensor
from ..growing import Growing
from . import (
    chip_steps,
    column_vocabulary,
    copied_rows,
    csv_mapping,
    header_rate,
    table_columns,
    temperature,
    time_stamps,
    units,
)
from .options import with_the_file
from .told_units import ToldUnits

WHAT = {ACCEL: "accelerometer", GYRO: "gyro", MAG: "magnetometer"}


@dataclass(frozen=True)
class Imported:
    """capture; assumed: sentences on what nobody said; remarks: on what was found."""

    capture: Capture
    assumed: tuple
    remarks: tuple


class Conversion:
    """One table becoming a Capture, step by step; `assumed` and `remarks` grow on the way."""

    def __init__(self, options, table):
        options = with_the_file(options, table)
        readings = table_columns.readings(options, table)
        times = table_columns.times(options, table, set(readings.columns.values()))
        self.options = options if times.rate is None else replace(options, rate=times.rate)
        self.table = table
        self.columns, self.named_units = readings.columns, readings.units
        self.time, self._named_time_unit = times.columns, times.unit
        self.assumed, self.remarks = list(times.assumed), list(readings.remarks)

    def run(self):
        """Imported."""
        values, times, labels = self._read()
        times, values, labels, new, words = copied_rows.left_out(times, values, labels)
        if new is not None:
            self.remarks.append(words)
            self._lines = [(0, np.concatenate([lines for _, lines in self._lines])[new])]
            self.rows = int(new.sum())
        for why, lines in self.table.passed_over.items():
            self.remarks.append("passed over: %s (%d line%s)" % (why, lines, "s" * (lines > 1)))
        self.assumed += getattr(self.table, "said", ())
        pose, moving = csv_mapping.poses(self.options, list(self._label_of), labels, self.rows)
        if moving:
            self.remarks.append("taken as moving: " + " ".join(moving))
        celsius = values.get("temp")
        t_us, order = self._times(times, values, None if celsius is None else celsius[:, 0])
        if order is not None:
            values = {name: block[order] for name, block in values.items()}
            pose = pose if pose is None else pose[order]
        capture = self._capture(values, t_us, pose)
        return Imported(capture, tuple(self.assumed), tuple(self.remarks))

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
        self._sizes = {group: chip_steps.Sizes() for group in (ACCEL, GYRO) if group in groups}
        times = Growing(float)
        self._lines, self._label_number, self._label_of = [], Growing(np.int32), {}
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
                times.add(stamps)
            if block.labels is not None:
                self._label_number.add([self._label_of.setdefault(one, len(self._label_of))
                                        for one in block.labels])
        self.rows = rows
        labels = self._label_number.array() if self.options.label_column else None
        return ({group: one.array() for group, one in grown.items()},
                times.array() if self.time else None, labels)

    _first_second = _spread = None

    def _whole_seconds(self, seconds):
        """Seconds from the first one on: with nanoseconds behind them they are beyond a float."""
        if self._first_second is None:
            self._first_second = seconds[0]
        return seconds - self._first_second

    def _of_a_sensor(self, group, values):
        if group != "temp" and len(values) and not np.abs(values).max() < units.LARGEST:
            raise BadFile("%s: the %s reaches %g, expected less than %g" % (
                self.table.path, WHAT[group], np.abs(values).max(), units.LARGEST))
        return values

    def _forwards(self, times):
        """BadFile for the first time that is before the one before it."""
        back = np.diff(times) < 0
        if back.any():
            row = int(np.argmax(back)) + 1
            raise BadFile.at(self.table.path, self.line_of(row),
                             "%s runs backwards, from %.17g to %.17g" % (
                                 " and ".join(self.time), times[row - 1], times[row]),
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
        times, anew, size = time_stamps.unwrapped(times)
        if len(anew):
            self.assumed.append("%s begins anew at %.10g, first in line %d: it goes on there" % (
                name, size, self.line_of(int(anew[0]))))
        if not options.sort:
            self._forwards(times)
        else:
            order, moved, farthest = time_stamps.sorted_order(times)
            if order is not None:
                times = times[order]
                self.remarks.append("%d rows moved to put %s in order, the farthest by %d rows"
                                    % (moved, name, farthest))
        unit = options.time_unit or ("s" if len(self.time) == 2 else self._named_time_unit)
        if not unit:
            unit, words = time_stamps.unit_of(self.table.path, name, times, celsius)
            time_stamps.check_stated(self.table.path, words, times, unit,
                                     getattr(self.table, "rate_hz", None))
            self.assumed.append(words)
        elif not options.time_unit:
            words = time_stamps.check_named(self.table.path, name, times, unit)
            self.assumed += [words] if words else []
        scale = 1e6 / options.rate if unit == "samples" else (
            column_vocabulary.TIME_UNITS | column_vocabulary.TICKS
            | column_vocabulary.LONG_UNITS)[unit]
        time_stamps.check_stretch(
            self.table.path, name, times, scale,
            lambda row: self.line_of(int(row if order is None else order[row])))
        t_us = time_stamps.microseconds(self.table.path, name, times, scale, unit)
        self._spread = time_stamps.spread(t_us)
        if self._spread is not None:
            self.assumed.append("%s goes on in steps of %.4g s, which %d rows share: they are "
                                "spread evenly" % (name, self._spread.step_us / 1e6,
                                                   self._spread.rows))
            t_us = self._spread.t_us
        return t_us, order

    # counts

    def _capture(self, values, t_us, pose):
        options, path = self.options, self.table.path
        rate, words = header_rate.told(path, options, self.time, t_us, self._spread)
        self.remarks += words
        check_times(path, t_us, rate["rate_hz"])
        meta = {"sensor": options.sensor, **rate, "g": options.g}
        accel, gyro = values.pop(ACCEL, None), values.pop(GYRO, None)
        for group, block in ((ACCEL, accel), (GYRO, gyro)):
            signed = units.give_sign(block) if block is not None else ""
            if signed:
                self.assumed.append("%s counts have no sign: taken as %s" % (
                    WHAT[group], signed))
        told = ToldUnits(path, options, self.columns, self.named_units, self.rows,
                         self._sizes, meta["rate_hz"], self.assumed, self.remarks)
        accel_unit, accel_lsb = told.of_accelerometer(accel)
        gyro_unit, gyro_lsb = told.of_gyro(gyro, accel_unit)
        if accel is not None and gyro is not None:
            gyro_unit = told.turned(accel, gyro, gyro_unit, gyro_lsb, meta["rate_hz"])
        counts = {}
        if accel is not None:
            per_unit = {"si": 1 / options.g, "m/s2": 1 / options.g, "mm/s2": 1e-3 / options.g}.get(
                accel_unit, units.ACCEL_UNITS[accel_unit])
            counts[ACCEL] = chip_steps.counts_of(ACCEL, path, "accelerometer", accel, accel_unit,
                                                 accel_lsb, per_unit, self._sizes[ACCEL])
            meta["accel_lsb_per_g"] = counts[ACCEL].lsb
            del accel
            step = units.common_step(counts[ACCEL].counts)
            if step > 1:
                self.remarks.append("every accelerometer count is a multiple of %d: its "
                                    "resolution is %.2f mg" % (step, 1e3 * step
                                                               / counts[ACCEL].lsb))
        if gyro is not None:
            counts[GYRO] = chip_steps.counts_of(GYRO, path, "gyro", gyro, gyro_unit, gyro_lsb,
                                                units.GYRO_UNITS[gyro_unit], self._sizes[GYRO])
            meta["gyro_lsb_per_dps"] = counts[GYRO].lsb
            del gyro
        if MAG in values:
            counts[MAG] = units.counts_of(path, "magnetometer", values[MAG], "counts",
                                          options.mag_lsb, None)
            meta["mag_lsb_per_ut"] = options.mag_lsb
        for group in (ACCEL, GYRO):
            if group in counts:
                more, words = chip_steps.of_header(group, counts[group])
                self.remarks += counts[group].remarks + words
                meta.update(more)
        temp = None
        if "temp" in values:
            told = temperature.counts(path, options, self.columns["temp"], values["temp"][:, 0])
            temp = told.counts
            meta.update(told.meta)
            self.assumed += told.assumed
            self.remarks += told.remarks
        meta["imported_from"] = os.path.basename(str(path))
        capture = Capture(meta, t_us, *(counts[group].counts if group in counts else None
                                        for group in (ACCEL, GYRO)), temp=temp,
                          mag=counts[MAG].counts if MAG in counts else None, pose=pose)
        check_sensor(meta, capture.columns(), lambda found, expected: BadFile(
            "%s: %s, expected %s" % (path, found, expected)))
        return capture
