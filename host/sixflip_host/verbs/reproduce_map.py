"""sixflip reproduce --map: Li's looped corridor, mapped by a real SLAM engine."""

import json
from pathlib import Path

from .. import atomic_write, file_kinds, progress
from ..capture import recordings
from ..errors import BadFile, UsageError
from ..file_arguments import add_output
from ..papers.corridor import botlab, claims, engine, experiment
from ..terminal import console, plain, styled, table

GYROS, MOST = 10, 100
PICTURE, TABLE = "corridor.png", "corridor.json"    # what --keep leaves
HONEST = ("With a healthy lidar, scan matching hides the gyro almost completely: under the "
          "Gmapping proposal the medians of raw, rest and Sixflip are nearly the same, and the "
          "worst says where matching lost its way. The paper's picture appears where odometry "
          "carries the heading. Between rest and Sixflip under optimal sampling nothing is "
          "claimed.")
RECORDED = ("A real robot (MAEBot, 6 m, 903° of turns): mean distance in mm of scans held out "
            "from the walls of the map of the others. It shows what removing the bias brings; "
            "six flips were not done there, and another scale than 1 brings nothing.")


def add_arguments(parser):
    """The options of the map."""
    parser.add_argument("--map", action="store_true",
                        help="the map of section 5 instead, before and after, by MRPT's rbpf-slam "
                             "(Debian's mrpt-apps, unpacked without root where it is missing)")
    parser.add_argument("--gyros", type=int, metavar="N",
                        help="gyros behind the map (default: %d)" % GYROS)
    add_output(parser, "--keep", metavar="DIR", type=Path,
               writes=lambda value, args: [(str(Path(value) / PICTURE), (file_kinds.PNG,)),
                                           (str(Path(value) / TABLE), (file_kinds.JSON,))],
               help="leave %s, %s and the engine's logs and settings there" % (PICTURE, TABLE))


def check(args):
    """UsageError for options that do not go together."""
    for name in ("gyros", "keep"):
        if getattr(args, name) is not None and not args.map:
            raise UsageError("--%s is an option of --map" % name)
    if args.gyros is not None and not 1 <= args.gyros <= MOST:
        raise UsageError("--gyros %d: expected 1 to %d" % (args.gyros, MOST))
    if args.keep is not None and not may_be_used(args.keep):
        raise UsageError("%s: holds files, and not those of this command, expected another folder"
                         % args.keep)


def may_be_used(folder):
    """Whether a folder is new, empty, or one that this command filled."""
    if not folder.exists():
        return True
    return folder.is_dir() and (not any(folder.iterdir()) or (folder / TABLE).is_file())


def run(args):
    """The maps and their claims; 1 when a claim does not hold."""
    gyros = args.gyros or GYROS
    program = engine.fetch(lambda text: None if args.json else print(plain(text)))
    with progress.during("reproduce --map"):
        results = experiment.run(program, gyros, 1000 * args.seed, experiment.CORRIDOR,
                                 keep=args.keep)
        rows = claims.rows(results)
        result = {"format": 1, "kind": "sixflip reproduce --map", "seed": args.seed,
                  "gyros": gyros, "corridor": rows, "claims": claims.corridor(rows, gyros)}
        try:
            recording = botlab.load(recordings.folder() / botlab.RECORDING)
        except BadFile as error:
            result["recording"], result["no_recording"] = None, str(error)
        else:
            progress.doing("a real recording")
            result["recording"] = claims.recorded(program, recording)
            result["claims"] += claims.real(result["recording"])
    if args.keep:
        args.keep.mkdir(parents=True, exist_ok=True)
        experiment.draw(args.keep / PICTURE, results[0])
        atomic_write.write_text(args.keep / TABLE, json.dumps(result, ensure_ascii=False) + "\n")
    if args.json:
        print(json.dumps(result, ensure_ascii=False))
    else:
        show(result, args.keep)
    return 0 if all(one["holds"] for one in result["claims"]) else 1


def show(result, keep):
    """Tables, claims and the honest words on the terminal."""
    screen, gyros = console(), result["gyros"]
    for name in dict.fromkeys(row["engine"] for row in result["corridor"]):
        screen.print(table(
            "A looped corridor of %g m, %s: median/worst of %d gyro%s" % (
                experiment.CORRIDOR.around, name, gyros, "" if gyros == 1 else "s"),
            ["reading", "heading °", "corner °", "closure m", "walls m", "off", "closed"],
            [[row["reading"], *("%s/%s" % (short(row[name]["median"]), short(row[name]["worst"]))
                                for name in ("heading_deg", "corner_deg", "closure_m", "wall_m")),
              "%.0f %%" % (100 * row["off"]["median"]), "%d" % row["closed"]]
             for row in result["corridor"] if row["engine"] == name]))
    screen.print(plain("  at the end; the worst of four corners; from the way round; from the "
                       "real ones; farther than %g m; within %g m of the start. raw: datasheet "
                       "numbers; rest: and the bias of the first rest; Sixflip: the record of a "
                       "session of six flips and that bias" % (
                           experiment.OFF_M, experiment.CLOSES_M)))
    screen.print(plain(HONEST))
    screen.print()
    if result["recording"]:
        show_recording(screen, result["recording"])
    else:
        screen.print(plain("The real recording was not looked at: " + result["no_recording"]))
    screen.print()
    for stated in result["claims"]:
        word = styled("holds", "bold green") if stated["holds"] else styled(
            "does not hold", "bold red")
        screen.print(word, plain(": %s: %s" % (stated["claim"], stated["found"])), sep="")
    screen.print(plain("the picture: %s" % (keep / PICTURE) if keep else
                       "--keep DIR leaves the picture of the first gyro's nine maps"))


def short(value):
    """Hundredths, whole numbers from ten on."""
    return "%.0f" % value if value >= 10 else "%.2f" % value


def show_recording(screen, recorded):
    """The ladder and the scales of the real recording."""
    screen.print(table("Real recording", ["engine", *botlab.READINGS],
                       [[name, *("%.1f" % row[reading] for reading in botlab.READINGS)]
                        for name, row in recorded["ladder_mm"].items()]))
    screen.print(table("Real recording, no SLAM, the gyro's scale changed", ["scale", *recorded[
        "scale_mm"]], [["%g" % scale, *("%.1f" % mm[k] for mm in recorded["scale_mm"].values())]
                       for k, scale in enumerate(recorded["scales"])]))
    screen.print(plain("  " + RECORDED))
