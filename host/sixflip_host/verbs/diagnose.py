"""sixflip diagnose: where the gap to the nominal simulator lies, what makes it, how far it
shrinks once that is added."""
import json
import os
from functools import partial

from .. import diagnosis  # noqa: F401 (it settles numpy's threads before that is loaded)

# isort: split
from sixflip.record import correction_record

from .. import file_kinds, progress, side_by_side
from ..calibrate import verify_files
from ..capture import open_recording
from ..did_you_mean import instead
from ..errors import CheckFailed, UsageError
from ..file_arguments import add_input, add_output

EXAMPLE = "sixflip diagnose warming.csv cooling.csv --report gap"
VERDICTS = ("no gap", "explained", "partly explained", "unexplained", "cannot tell")


def add_arguments(parser):
    add = parser.add_argument
    add_input(parser, "captures", nargs="+", metavar="CAPTURE",
              help="one capture or more, a session each")
    add_input(parser, "--reference", metavar="NOISE",
              help="a capture at rest, to know the noise by")
    add_input(parser, "--prior", metavar="FLEET.json",
              help="what boards of this kind are like, from sixflip fleet, instead of the sizes "
                   "of data sheets")
    add_input(parser, "--sim", action="append", default=[], metavar="SIM.csv",
              help="compare with this capture of your own simulator instead of the nominal one")
    add("--add", action="append", default=[], metavar="EFFECT",
        help="run the simulator again with this effect too (`found`: those found)")
    add_output(parser, "--scenario", metavar="TOML", writes=scenario_files,
               help="write the scenario with the effects added, and its plan beside it")
    add_input(parser, "--record", metavar="RECORD", help="put what was found and the board can "
              "take out (drift with temperature, g-sensitivity) into this correction record")
    add_output(parser, "-o", "--output", metavar="NEW", kinds=(file_kinds.RECORD,),
               help="the record to write, for sixflip restore --from")
    add_output(parser, "--report", metavar="DIR", writes=report_files,
               help="write a page with pictures")
    add("--certified-box", action="store_true", help="the box is known to be square")
    add("--without", default="", metavar="EFFECT,…", help="leave effects out of the library")
    add("--json", action="store_true", help="the answer as JSON")
    add("--fail-on", default="", metavar="VERDICT,…", help="exit 1 on any of these verdicts")
    add("--max-gap", type=float, metavar="X",
        help="exit 1 when the gap of a sensor exceeds X times its noise floor")
    add_output(parser, "--junit", metavar="FILE", kinds=(file_kinds.JUNIT,),
               help="also write the checks as JUnit XML")
    add("--jobs", type=int, default=0, metavar="N", help="processors (default: all)")


def run(args):
    from sixflip_sim.effects.library import NAMES

    from ..present import gap_words
    wanted = verdicts(args.fail_on)
    without = [name for name in args.without.split(",") if name]
    for name in without:
        if name not in NAMES:
            raise UsageError("--without %s: %s" % (
                name, instead(name, NAMES, "expected effects out of: %s")))
    if args.max_gap is not None and not args.max_gap > 0.0:
        raise UsageError("--max-gap is %g, expected more than 0" % args.max_gap)
    if args.jobs < 0:
        raise UsageError("--jobs is %d, expected 1 or more" % args.jobs)
    if bool(args.record) != bool(args.output):
        raise UsageError("expected --record and -o, or neither")
    if args.record and args.sim:
        raise UsageError("--record: expected no --sim, a record corrects the sensor and no "
                         "difference between sensor and simulator")
    record = verify_files.accelerometer_record(args.record) if args.record else None
    with progress.during("diagnose"):
        result, terms = answered(args, without, record)
    if args.json:
        print(json.dumps(result, indent=1, allow_nan=False, ensure_ascii=False))
    else:
        gap_words.show(result)
    if record:
        write_terms(terms, args)
    return checked(result, wanted, args)


def answered(args, without, record):
    """(the answer of --json, Terms for a record or None); report and scenario are written."""
    from ..diagnosis import answer, correction_terms
    from ..diagnosis.diagnose import diagnose
    from ..diagnosis.settings import Settings

    def read(paths, gravity=True, gyro_alone=False):
        if paths:
            progress.doing("reading %s" % ", ".join(paths))
        # What can be read once only is read here.
        processors = Settings(jobs=args.jobs).processors if all(map(os.path.isfile, paths)) else 1
        return list(zip(paths, side_by_side.results(
            [partial(open_recording.read_samples, path, gravity, gyro_alone) for path in paths],
            processors)))
    captures = read(args.captures, gyro_alone=not args.sim and not record)
    if record:
        of_this_part(captures, record, args)
    diagnosed = diagnose(captures, read(args.sim, gravity=False),
                         read([args.reference] if args.reference else []),
                         args.certified_box, without, args.jobs, fleet_of(args.prior, captures))
    loops = closed(diagnosed, args)
    result = answer.as_dict(diagnosed)
    if loops:
        result["simulated"] = {kind: answer.of_loop(kind, loop) for kind, loop in loops.items()}
    terms = None
    if record:
        terms = correction_terms.terms_for(diagnosed, record)
        result["terms"] = correction_terms.answer(terms, args.output)
    if args.report:
        from ..present import gap_report
        progress.doing("drawing the report")
        gap_report.write(args.report, diagnosed, result, loops)
    return result, terms


def fleet_of(path, captures):
    """FleetPrior of the captures' chip, None where no fleet was given."""
    from ..fleet import fleet_prior
    return fleet_prior.read(path, captures[0][1].meta["sensor"]) if path else None


def closed(diagnosed, args):
    """{sensor: Loop} of the simulator run again; the scenario file where asked for."""
    from sixflip_sim.effects.library import NAMES

    from ..diagnosis import closed_loops
    named = [name for name in args.add if name != "found"]
    for name in named:
        if name not in NAMES:
            raise UsageError("--add %s: %s" % (name, instead(
                name, NAMES, "expected found, or an effect out of: %s")))
    if not (args.add or args.scenario or args.report) or not diagnosed.gaps:
        return {}
    closed_again = closed_loops.close_all(diagnosed, named)
    if args.scenario:
        closed_loops.write_scenario(args.scenario, diagnosed, [
            e for lo in closed_again.values() for e in lo.effects])
    return closed_again


def scenario_files(value, args):
    """The scenario and the plan that closed_loops.write_scenario puts beside it."""
    from ..diagnosis import closed_loops
    return [(value, (file_kinds.SCENARIO,)),
            (str(closed_loops.plan_beside(value)), (file_kinds.PLAN,))]


def report_files(value, args):
    """The page and the pictures that report.write puts into a folder."""
    from ..present import gap_report
    return [(os.path.join(value, gap_report.PAGE), (file_kinds.PAGE,))] + [
        (os.path.join(value, name + ".png"), (file_kinds.PNG,)) for name in gap_report.PICTURES]


def verdicts(text):
    """The verdicts of --fail-on; UsageError names those there are."""
    named = [" ".join(part.replace("_", " ").split()) for part in text.split(",") if part.strip()]
    for verdict in named:
        if verdict not in VERDICTS:
            raise UsageError("--fail-on %s: %s" % (verdict, instead(
                verdict, VERDICTS, "expected verdicts out of: %s")))
    return named


def failures(result, wanted, max_gap):
    """{check: what went wrong or ""}"""
    checks = {}
    if wanted:
        bad = result["verdict"] in wanted
        checks["verdict"] = "the verdict is %s" % result["verdict"] if bad else ""
    if max_gap is not None:
        for kind, gap in result["gap"].items():
            ratio = gap["before"] / max(gap["floor"], 1e-12)
            checks["gap of the " + kind] = "" if ratio <= max_gap else \
                "%.3g times the noise floor, expected at most %g" % (ratio, max_gap)
    return checks


def checked(result, wanted, args):
    """Exit code 0, or CheckFailed with the first failure; the JUnit file where asked for."""
    checks = failures(result, wanted, args.max_gap)
    if args.junit:
        from ..present import gap_report
        gap_report.write_junit(args.junit, checks or {"verdict": ""})
    for name, failure in checks.items():
        if failure:
            raise CheckFailed("%s: %s" % (name, failure))
    return 0


def of_this_part(captures, record, args):
    """CheckFailed or BadFile when the record is another sensor's: before the diagnosis, which
    takes its time."""
    from ..diagnosis import correction_terms
    from ..experiment import blocks
    for _, capture in captures:
        verify_files.fits(record, capture)
    correction_terms.fitting([blocks.session_of(*one) for one in captures], record, args.record)


def write_terms(terms, args):
    """The record with the terms; CheckFailed when there are none."""
    from .. import atomic_write
    if not terms.accepted:
        raise CheckFailed("nothing was found that a record can take out: %s is not written"
                          % args.output)
    atomic_write.write_bytes(args.output, correction_record.encode(terms.record))
