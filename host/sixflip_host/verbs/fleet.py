"""sixflip fleet: the captures of many boards together; what their batch shares, what one has."""
import json
import os

from .. import atomic_write, file_kinds, progress
from ..errors import BadFile, UsageError
from ..file_arguments import add_input, add_output

EXAMPLE = ("sixflip fleet captures -o fleet-out --report\n"
           "         sixflip fleet boards.csv -o fleet-out --scheduler tcp://10.0.0.5:8786")
JSON_NAME, PAGE_NAME = "fleet.json", "fleet.html"


def add_arguments(parser):
    """The options of the verb."""
    add = parser.add_argument
    add_input(parser, "boards", metavar="DIR | MANIFEST.csv | HISTORY.sqlite",
              help="captures in a folder for each board; a CSV with the columns board, capture "
                   "and batch; or a history; or what an earlier run wrote")
    add_output(parser, "-o", "--output", default="fleet-out", metavar="DIR", writes=files,
               help="folder for fleet.json and the boards that are done (default: %(default)s)")
    add_input(parser, "--scheduler", metavar="ADDRESS | FILE",
              help="run on this Dask cluster (tcp://host:8786, or a scheduler file) instead of "
                   "the cores of this computer")
    add("--workers", type=int, default=0, metavar="N",
        help="processes on this computer (default: one a core)")
    add("--report", action="store_true", help="also write a page, fleet.html")
    add("--randomise", action="store_true",
        help="also write the population as a simulator's randomisation: imu_numpy.py, "
             "imu_mujoco.py and imu_isaaclab.py")
    add("--diagnose", action="store_true",
        help="also diagnose every board by itself, from the rests (takes seconds for each)")
    add("--no-summaries", action="store_true",
        help="do not put a summary beside each capture; a later run reads them all again")
    add("--json", action="store_true", help="what stands in fleet.json on stdout")


def files(value, args):
    """What is written into the folder, beside the data set."""
    from ..fleet import answer
    written = [(os.path.join(value, JSON_NAME), (file_kinds.FLEET,)),
               (os.path.join(value, answer.ESTIMATES), (file_kinds.PARQUET,))]
    if args.report:
        written.append((os.path.join(value, PAGE_NAME), (file_kinds.PAGE,)))
    if args.randomise:
        from ..fleet import randomisation
        written += [(os.path.join(value, name), (file_kinds.RANDOMISATION,))
                    for name in randomisation.NAMES.values()]
    return written


def run(args):
    """Do what is not done, then judge all; 0 whatever single boards are like."""
    from ..fleet import analysis, answer, cluster, members, run_fleet
    if args.workers < 0:
        raise UsageError("--workers is %d, expected 1 or more" % args.workers)
    if args.workers and args.scheduler:
        raise UsageError("--workers and --scheduler: expected one of the two")
    target = cluster.Target(args.scheduler, args.workers)
    with progress.during("fleet"):
        done = run_fleet.boards(args.boards, args.output, target, analysis.Options(
            not args.no_summaries, args.diagnose))
        progress.doing("the population")
        kinds = answer.judged(done.rows(), done.rows(members.KEYS))
    result = answer.population(kinds, done.failures, done.remarks)
    os.makedirs(args.output, exist_ok=True)
    atomic_write.write_text(os.path.join(args.output, JSON_NAME),
                            json.dumps(result, indent=1, ensure_ascii=False) + "\n")
    answer.write_estimates(args.output, kinds)
    if args.randomise and kinds:
        from ..fleet import randomisation
        for name, text in randomisation.files(*kinds[0][:2]).items():
            atomic_write.write_text(os.path.join(args.output, name), text)
    if args.report:
        from ..present import fleet_page
        progress.doing("drawing the page")
        atomic_write.write_text(os.path.join(args.output, PAGE_NAME),
                                fleet_page.html(kinds, done, args.output))
    if args.json:
        print(json.dumps(result, indent=1, ensure_ascii=False))
    else:
        from ..present import fleet_words
        fleet_words.show(result, args.output, args.report and PAGE_NAME)
        if args.randomise and kinds:
            fleet_words.cannot_express(randomisation.cannot_express(kinds[0][1]))
    if not kinds:
        raise BadFile("%s: no board of it could be solved" % args.boards)
    return 0
