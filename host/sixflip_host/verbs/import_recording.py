"""sixflip import: a capture file out of somebody else's CSV or ROS bag."""

import dataclasses
import json
import re

from sixflip.poses.faces import pose_name

from .. import file_kinds, progress
from ..capture import capture_file, clock, clock_words
from ..capture.capture_header import SENSORS, STANDARD_G
from ..capture.imports import presets
from ..capture.imports.column_vocabulary import TICKS, TIME_UNITS
from ..file_arguments import add_input, add_output
from ..terminal import plain, say

EXAMPLE = ("sixflip import log.csv -o capture.csv\n"
           "         sixflip import session.csv.gz -o capture.csv --units si,dps --rate 102.4\n"
           "         sixflip import log.csv -o capture.csv --columns ax,ay,az,-,gx,gy,gz "
           "--accel-lsb 16384 --gyro-lsb 131 --time-column 4 --time-unit ms\n"
           "         sixflip import session.mcap -o capture.csv --topic /imu/data_raw")


def add_arguments(parser):
    """The options of the verb."""
    # argparse takes `--columns -,ax` for two options without this
    parser._negative_number_matcher = re.compile(r"-\d+\Z|-\d*\.\d+\Z|-,")
    add = parser.add_argument
    add_input(parser, "file", help="CSV, plain or gzipped; a ROS bag with sensor_msgs/Imu (a "
              "rosbag2 folder, .db3, .mcap, .bag); a PX4 ULog; .mat; .npz; what gz topic prints")
    add_output(parser, "-o", "--output", required=True,
               kinds=(file_kinds.CAPTURE, file_kinds.SIMULATED),
               help="capture to write, .csv or .csv.gz")
    add("--from", dest="preset", choices=tuple(presets.PRESETS), help="what the file is (default: "
        "told by its content)")
    add("--sensor", default="other", choices=SENSORS, help="the chip (default: other)")
    add("--rate", type=float, metavar="HZ", help="sample rate that was set (default: measured "
        "from the times)")
    add("--time-column", metavar="NAME", help="column of times, or of sample numbers (default: "
        "told by its name)")
    add("--time-unit", choices=[*TIME_UNITS, *TICKS, "samples"], help="its unit (default: told "
        "from its name and values); samples needs --rate")
    add("--sort", action="store_true", help="put the rows in the order of their time, and say "
        "what was moved")
    add("--columns", metavar="A,B,…", help="names of the columns, - for one to leave out")
    add("--map", action="append", metavar="ax=acc_x", help="a column by its name or number")
    add("--delimiter", default="auto", help="one character, or blank (default: auto)")
    add("--skip", type=int, metavar="N", help="lines before the names (default: finds them)")
    add("--units", metavar="A[,G]", help="of accelerometer and gyro: counts, si, g, mg, dps, "
        "rad/s, each may be left out (default: told from gravity at rest)")
    add("--topic", help="of a bag with several Imu topics, or of a ULog")
    add("--accel-lsb", type=float, metavar="N", help="counts per g (else the values' own step)")
    add("--gyro-lsb", type=float, metavar="N", help="counts per deg/s (likewise)")
    add("--temp-units", choices=("counts", "c"), help="of the temperature: counts of the chip, or "
        "°C (default: told from its values)")
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
        names = [field.name for field in dataclasses.fields(presets.Options)]
        imported = presets.convert(presets.Options(**{
            name: getattr(args, name) for name in names if hasattr(args, name)}))
        capture, assumed, remarks = imported.capture, list(imported.assumed), list(
            imported.remarks)
        if capture.pose is None and capture.accel is not None and not args.no_poses:
            from ..capture.find_poses import find_poses
            found_poses = find_poses(capture)
            found_poses.label(capture)
            remarks += found_poses.remarks()
        capture_file.write(args.output, capture)
    if args.json:
        measured = clock.sample_clock(capture)
        print(json.dumps({
            "format": 1, "kind": "sixflip import", "capture": args.output,
            "samples": len(capture), "meta": capture.meta, "assumed": assumed,
            "remarks": remarks, "clock": measured and clock_words.as_json(measured),
            "poses": [pose_name(one.pose) for one in capture.placements()]
            if capture.pose is not None else None}))
        return 0
    print("%s: %d samples, %.1f s%s" % (
        plain(args.output), len(capture), (capture.t_us[-1] - capture.t_us[0]) / 1e6,
        "".join(", %g counts per %s" % (capture.meta[key], of) for key, of in (
            ("accel_lsb_per_g", "g"), ("gyro_lsb_per_dps", "deg/s")) if key in capture.meta)))
    say(["  assumed: " + sentence for sentence in assumed] + ["  " + one for one in remarks])
    return 0
