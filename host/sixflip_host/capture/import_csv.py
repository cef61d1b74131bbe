"""sixflip import: a capture file out of somebody else's CSV or ROS bag."""

import json
import os

import numpy as np

from sixflip.faces import pose_name

from .. import file_kinds, progress
from ..errors import BadFile, UsageError
from ..file_arguments import add_input, add_output
from ..terminal import plain, say
from . import capture_file, csv_mapping, ros_bag, units
from .capture_header import ACCEL, GYRO, MAG, SENSORS, STANDARD_G, check_sensor
from .csv_table import read_table
from .growing import Growing

HELP = "make a capture file from somebody else's CSV or ROS bag, finding the poses by itself"
EXAMPLE = ("sixflip import session.csv.gz -o capture.csv --units si,dps --rate 102.4\n"
           "         sixflip import log.csv -o capture.csv --columns ax,ay,az,-,gx,gy,gz "
           "--accel-lsb 16384 --gyro-lsb 131 --time-column 4 --time-unit ms\n"
           "         sixflip import session.mcap -o capture.csv --topic /imu/data_raw")

TIME_UNITS = {"us": 1, "ms": 1000, "s": 1000000}
LATEST_US = 1e16        # three centuries: what a time column in the wrong unit passes
TEMPERATURE = {"mpu6050": (340, 36.53), "itg3205": (280, 82.142857), "gy85": (280, 82.142857)}


def add_arguments(parser):
    """The options of the verb."""
    add = parser.add_argument
    add_input(parser, "file", help="CSV, plain or gzipped; or a ROS bag with sensor_msgs/Imu: a "
              "rosbag2 folder, .db3, .mcap, .bag")
    add_output(parser, "-o", "--output", required=True,
               kinds=(file_kinds.CAPTURE, file_kinds.SIMULATED),
               help="capture to write, .csv or .csv.gz")
    add("--sensor", default="other", choices=SENSORS, help="the chip (default: other)")
    add("--rate", type=float, metavar="HZ", help="sample rate, when there is no time column")
    add("--time-column", metavar="NAME", help="column of times (or of sample numbers)")
    add("--time-unit", choices=[*TIME_UNITS, "samples"], help="its unit; samples needs --rate")
    add("--sort", action="store_true", help="put the rows in the order of their time")
    add("--columns", metavar="A,B,…", help="names of the columns, - for one to leave out")
    add("--map", action="append", metavar="ax=acc_x", help="a column by its name or number")
    add("--delimiter", default="auto", help="one character, or blank (default: auto)")
    add("--skip", type=int, metavar="N", help="lines before the names (default: finds them)")
    add("--units", metavar="A[,G]", help="of accelerometer and gyro: counts, si, g, mg, dps, "
        "rad/s (default: counts; of a bag si)")
    add("--topic", help="of a bag with several Imu topics")
    add("--accel-lsb", type=float, metavar="N", help="counts per g (else the values' own step)")
    add("--gyro-lsb", type=float, metavar="N", help="counts per deg/s (likewise)")
    add("--temp-units", default="counts", choices=("counts", "c"), help="of a column --map temp=")
    add("--mag-lsb", type=float, metavar="N", help="counts per µT of columns --map mx= my= mz=")
    add("--g", type=float, default=STANDARD_G, help="gravity there, m/s² (default 9.80665)")
    add("--label-column", metavar="NAME", help="column that names the still sections")
    add_input(parser, "--sections", metavar="JSON",
              help="file that names the still sections by sample numbers")
    add("--label", action="append", metavar="up=Z+a", help="what one of their labels means")
    add("--json", action="store_true", help="what was found, as JSON")
    add("--no-poses", action="store_true", help="leave finding the poses to whoever reads it")


def run(args):
    """Read, convert, find the poses, write; says what it found."""
    with progress.during("import"):
        capture, remarks = convert(args)
        if capture.pose is None and not args.no_poses:
            from ..solving.find_poses import find_poses
            found = find_poses(capture)
            found.label(capture)
            remarks += found.remarks()
        capture_file.write(args.output, capture)
    if args.json:
        print(json.dumps({
            "format": 1, "kind": "sixflip import", "capture": args.output,
            "samples": len(capture), "meta": capture.meta, "remarks": remarks,
            "poses": [pose_name(one.pose) for one in capture.placements()]
            if capture.pose is not None else None}))
        return 0
    print("%s: %d samples, %.1f s, %g counts per g" % (
        plain(args.output), len(capture), (capture.t_us[-1] - capture.t_us[0]) / 1e6,
        capture.meta["accel_lsb_per_g"]))
    say("  " + remark for remark in remarks)
    return 0


def convert(args):
    """The Capture in a CSV, labelled where the CSV or the command line labels it; remarks."""
    names = args.columns.split(",") if args.columns else None
    if args.delimiter not in ("auto", "blank") and len(args.delimiter) != 1:
        raise UsageError("--delimiter %r: expected one character, auto or blank" % args.delimiter)
    if args.skip is not None and args.skip < 0:
        raise UsageError("--skip %d: expected a number of lines" % args.skip)
    if args.topic and not ros_bag.is_bag(args.file):
        raise UsageError("--topic: only of a ROS bag, %s is none" % args.file)
    if ros_bag.is_bag(args.file):
        table = ros_bag.BagTable(args.file, args.topic)
        args.units = args.units or "si"
        args.time_column, args.time_unit = ros_bag.NAMES[0], "us"
    else:
        table = read_table(args.file, args.delimiter, args.skip, names,
                           csv_mapping.looks_like_header)
    labels = csv_mapping.parse_pairs("--label", args.label)
    columns = csv_mapping.choose_columns(table, csv_mapping.parse_pairs("--map", args.map))
    read = _Columns(args, table, columns)
    pose, remarks = _labelled(args, read, labels)
    t_us, order = _times(args, table, read)
    capture, more = _in_counts(args, read, t_us)
    capture.pose = pose
    if order is not None:
        for name in ("t_us", "accel", "gyro", "temp", "mag", "pose"):
            block = getattr(capture, name)
            setattr(capture, name, block if block is None else block[order])
        remarks.append("rows put in the order of their time")
    return capture, more + remarks


class _Columns:
    """What is wanted of a table, as arrays: rows, times, labels and number, temp, counts.

    counts  {ACCEL, GYRO, MAG: units.Counts}; those whose step has to be found first cost a
            second reading of the table, but no room for all their values
    """

    def __init__(self, args, table, columns):
        _check_options(args)
        self.rows, self._last = 0, -np.inf
        self.labels, self._number = {}, Growing(np.int32)
        self._times, self._temp, self.temp_meta = Growing(float), Growing(np.int16), {}
        self.counts = _counts(args, columns)
        wanted = {group: [columns[name] for name in group] for group in self.counts}
        wanted.update({name: [columns["temp"]] for name in ("temp",) if name in columns})
        wanted.update({"time": [args.time_column]} if args.time_column else {})
        for block in _split(table, wanted, args.label_column):
            self._take(args, table, block)
        looked = [group for group, one in self.counts.items() if one.lsb is None]
        for group in looked:
            self.counts[group].settle()
        for _, values, _ in _split(table, {group: wanted[group] for group in looked}):
            for group in looked:
                self.counts[group].add(_si(args, group, values[group]))

    def _take(self, args, table, block):
        lines, values, labels = block
        self.rows += len(lines)
        if labels is not None:
            self._number.add([self.labels.setdefault(one, len(self.labels)) for one in labels])
        if "time" in values:
            times = values["time"][:, 0]
            if not args.sort:
                _forwards(args, table, lines, times, self._last)
            self._last = times[-1]
            self._times.add(times)
        if "temp" in values:
            self._temp.add(_temperature(args, self.temp_meta, values["temp"][:, 0]))
        for group, one in self.counts.items():
            (one.look if one.lsb is None else one.add)(_si(args, group, values[group]))

    def take_times(self):
        """The times, which are here no longer."""
        times, self._times = self._times.array(), None
        return times

    @property
    def number(self):
        return self._number.array()

    @property
    def temp(self):
        return self._temp.array() if len(self._temp) else None


def _split(table, wanted, label=None):
    """(line numbers, {name: float (n, columns)}, labels) of every block; none of nothing."""
    if not wanted:
        return
    names = [name for columns in wanted.values() for name in columns]
    for block in table.blocks(names, label):
        values, at = {}, 0
        for name, columns in wanted.items():
            values[name] = block.values[:, at:at + len(columns)]
            at += len(columns)
        yield block.lines, values, block.labels


def _counts(args, columns):
    """{group: units.Counts} of the groups that have columns."""
    accel_unit, gyro_unit = _units(args.units or "counts")
    if "mx" in columns and args.mag_lsb is None:
        raise UsageError("columns mx my mz need --mag-lsb, counts per µT")
    settings = {ACCEL: ("accelerometer", accel_unit, args.accel_lsb, units.ACCEL_UNITS),
                GYRO: ("gyro", gyro_unit, args.gyro_lsb, units.GYRO_UNITS),
                MAG: ("magnetometer", "counts", args.mag_lsb, units.ACCEL_UNITS)}
    return {group: units.Counts(args.file, *settings[group]) for group in settings
            if group[0] in columns}


def _si(args, group, values):
    """Values of a group; an acceleration in m/s² as if gravity were the standard one."""
    if group == ACCEL and _units(args.units or "counts")[0] in ("si", "m/s2"):
        return values * (STANDARD_G / args.g)
    return values


def _check_options(args):
    """UsageError for numbers that cannot be, before anything is read."""
    for name in ("accel_lsb", "gyro_lsb", "mag_lsb", "g"):
        value = getattr(args, name)
        if value is not None and not 0 < value < 1e9:
            raise UsageError("--%s %g: expected a number above 0" % (
                name.replace("_", "-"), value))
    if args.rate is not None and not 0 < args.rate < 1e6:
        raise UsageError("--rate %g: expected samples per second" % args.rate)
    if not args.time_column and args.rate is None:
        raise UsageError("expected --rate HZ, or --time-column with --time-unit")
    if args.time_column and (not args.time_unit or (
            args.time_unit == "samples" and args.rate is None)):
        raise UsageError("--time-column needs --time-unit us, ms, s, or samples and --rate HZ")
    if args.label_column and args.sections:
        raise UsageError("--label-column and --sections: expected one of the two")


def _labelled(args, read, labels):
    """Pose codes from a label column or a sections file, or None; remarks."""
    if args.label_column:
        pose, moving = csv_mapping.poses_from_labels(list(read.labels), read.number, labels)
    elif args.sections:
        pose, moving = csv_mapping.poses_from_sections(args.sections, read.rows, labels)
    else:
        return None, []
    if not pose.any():
        raise BadFile("%s: no label is a pose, expected --label THEIRS=Z+a for %s" % (
            args.sections or args.file, " ".join(moving)))
    return pose, ["taken as moving: " + " ".join(moving)] if moving else []


def _forwards(args, table, lines, times, last):
    """BadFile for the first time that is before the one before it."""
    steps = np.diff(times, prepend=last)
    if (steps < 0).any():
        row = int(np.argmax(steps < 0))
        raise BadFile.at(table.path, lines[row], "%s runs backwards, from %g to %g" % (
            args.time_column, times[row] - steps[row], times[row]), "increasing times (or --sort)")


def _times(args, table, read):
    """int64 microseconds, and the order that sorts them or None."""
    if not args.time_column:
        if not read.rows / args.rate < LATEST_US / 1e6:
            raise UsageError("--rate %g: expected samples per second" % args.rate)
        return np.rint(np.arange(read.rows) * (1e6 / args.rate)).astype(np.int64), None
    scale = TIME_UNITS.get(args.time_unit) or 1e6 / args.rate
    times = read.take_times()
    order = None
    if args.sort and (np.diff(times) < 0).any():
        order = np.argsort(times, kind="stable")
    times -= times.min()
    longest = float(times.max()) * scale
    if not longest < LATEST_US:
        raise BadFile("%s: %s spans %.3g s, expected less than %.0g: is --time-unit %s right?" % (
            table.path, args.time_column, longest / 1e6, LATEST_US / 1e6, args.time_unit))
    times *= scale
    return np.rint(times, out=times).astype(np.int64), order


def _in_counts(args, read, t_us):
    """A Capture of whole counts, and remarks on how they were recovered."""
    accel_unit, gyro_unit = _units(args.units or "counts")
    accel = read.counts[ACCEL].array()
    accel_lsb = read.counts[ACCEL].lsb
    remarks = _remarks("accelerometer", "g", accel_unit, args.accel_lsb, read.counts[ACCEL])
    step = units.common_step(accel)
    if step > 1:
        remarks.append("every accelerometer count is a multiple of %d: its resolution is %.2f mg"
                       % (step, 1e3 * step / accel_lsb))
    meta = {"sensor": args.sensor, "rate_hz": args.rate or _rate(t_us), "g": args.g,
            "accel_lsb_per_g": accel_lsb}
    capture_file.check_times(args.file, np.sort(t_us), meta["rate_hz"])
    capture = capture_file.Capture(meta, t_us, accel, temp=read.temp)
    if GYRO in read.counts:
        capture.gyro, meta["gyro_lsb_per_dps"] = read.counts[GYRO].array(), read.counts[GYRO].lsb
        remarks += _remarks("gyro", "deg/s", gyro_unit, args.gyro_lsb, read.counts[GYRO])
    if MAG in read.counts:
        capture.mag, meta["mag_lsb_per_ut"] = read.counts[MAG].array(), args.mag_lsb
    meta.update(read.temp_meta)
    meta["imported_from"] = os.path.basename(args.file)
    check_sensor(meta, capture.columns(), lambda found, expected: BadFile(
        "%s: %s, expected %s" % (args.file, found, expected)))
    return capture, remarks


def _units(text):
    """`si` or `g,dps` -> unit of the accelerometer, unit of the gyro."""
    words = text.split(",")
    accel, gyro = words if len(words) == 2 else (words[0], words[0])
    if len(words) == 1 and accel in ("g", "mg", "m/s2"):
        gyro = "dps"
    if accel not in units.ACCEL_UNITS or gyro not in units.GYRO_UNITS or len(words) > 2:
        raise UsageError("--units %s: expected one of %s, a comma, one of %s" % (
            text, " ".join(units.ACCEL_UNITS), " ".join(units.GYRO_UNITS)))
    return accel, gyro


def _remarks(what, of, unit, given, counts):
    """What was found out about the counts behind the units."""
    if unit == "counts":
        return []
    if given is None:
        return ["%s values are whole steps of 1/%.6g %s" % (what, counts.lsb, of)]
    if counts.rounding > units.ON_GRID:
        return ["%s values are not whole counts at %g per %s: rounded by up to %.2f count" % (
            what, counts.lsb, of, counts.rounding)]
    return []


def _rate(t_us):
    """Samples per second from the usual interval."""
    usual = float(np.median(np.diff(t_us))) if len(t_us) > 1 else 0
    if not usual:
        raise UsageError("the times do not say the rate, expected --rate HZ")
    return round(1e6 / usual, 3)


def _temperature(args, meta, values):
    """int16 counts of the chip's thermometer."""
    if args.sensor not in TEMPERATURE:
        raise UsageError("a temperature needs --sensor %s" % " or ".join(TEMPERATURE))
    lsb, offset = TEMPERATURE[args.sensor]
    meta["temp_lsb_per_c"], meta["temp_offset_c"] = lsb, offset
    counts = np.rint((values - offset) * lsb if args.temp_units == "c" else values)
    if np.abs(counts).max() > 32767:
        raise BadFile("%s: the temperature reaches %g, expected %s" % (
            args.file, values[np.argmax(np.abs(counts))],
            "°C" if args.temp_units == "c" else "16 bit counts (or --temp-units c)"))
    return counts.astype(np.int16)
