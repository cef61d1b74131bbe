"""sixflip simulate: captures of a simulated sensor with any of the canonical effects."""
import json

import numpy as np

from .. import file_kinds, progress
from ..atomic_write import write_text
from ..capture import capture_file
from ..errors import BadFile, UsageError
from ..file_arguments import add_input, add_output
from ..simulation import scenario, simulated_session

EXAMPLE = "sixflip simulate scenario.toml -o warming.csv cooling.csv"


def add_arguments(parser):
    add_input(parser, "scenario", metavar="SCENARIO.toml")
    add_output(parser, "-o", "--output", nargs="+", metavar="CSV", required=True,
               kinds=(file_kinds.SIMULATED,),
               help="one capture file (.csv or .csv.gz) for each session of the scene")
    add_output(parser, "--worlds", metavar="JSON", kinds=(file_kinds.WORLDS,),
               help="also write the worlds, for `sixflip virtual-board --world`")


def run(args):
    plan = scenario.read(args.scenario)
    if len(args.output) != len(plan.worlds):
        raise UsageError("the scene %s has %d session%s, expected as many files after -o, got %d"
                         % (plan.scene, len(plan.worlds), "" if len(plan.worlds) == 1 else "s",
                            len(args.output)))
    if args.worlds:
        write_text(args.worlds, json.dumps(plan.worlds, indent=1) + "\n")
    for path, number in zip(args.output, range(len(plan.worlds))):
        try:
            with progress.during("simulate: %s, %d of %d" % (path, number + 1, len(plan.worlds))):
                capture = simulated_session.session(plan, number)
                capture_file.write(path, capture)
        except ValueError as error:
            raise BadFile("%s: %s" % (args.scenario, error)) from None
        print("%s: %d samples, %d placements, %.1f minutes" % (
            path, len(capture), np.count_nonzero(np.diff(capture.pose) > 0)
            + (capture.pose[0] > 0), capture.t_us[-1] / 6e7))
    return 0












