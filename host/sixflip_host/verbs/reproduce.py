"""sixflip reproduce: Tables 3 and 4 of Li et al. as simulated experiments, beside the paper's;
with --map their corridor, see reproduce_map."""

import json

import numpy as np

from .. import progress
from ..errors import UsageError
from ..papers import li_tables
from ..papers.corridor.claims import claim
from ..terminal import console, plain, styled, table
from . import reproduce_map

EXAMPLE = "sixflip reproduce --sessions 100"
SESSIONS = 60
FEWEST = 10
SEEDS = 100000
# Degrees. The paper's own words on what it read before: "about ±1° to ±3°".
BEFORE = (1.0, 3.0)
MEDIAN, P95 = 0.3, 0.6
STANDARD_ERRORS = 5.0
GROUPS = (("the angles", slice(0, 6)), ("the scales", slice(6, 9)), ("v", slice(9, 12)))


def add_arguments(parser):
    """The options of the verb."""
    parser.add_argument("--sessions", type=int, default=SESSIONS, metavar="N",
                        help="calibrations behind Table 4, each of another gyro (default: %d)"
                        % SESSIONS)
    parser.add_argument("--seed", type=int, default=1, help="of sensors, noise and hand")
    parser.add_argument("--json", action="store_true", help="the tables as one JSON object")
    reproduce_map.add_arguments(parser)


def run(args):
    """Both experiments; 1 when a claim does not hold."""
    if args.sessions < FEWEST:
        raise UsageError("--sessions %d: expected %d or more, for a 95 %% that means something"
                         % (args.sessions, FEWEST))
    if not 0 <= args.seed < SEEDS:
        raise UsageError("--seed %d: expected 0 to %d" % (args.seed, SEEDS - 1))
    reproduce_map.check(args)
    if args.map:
        return reproduce_map.run(args)
    with progress.during("reproduce"):
        progress.doing("Table 3")
        repeated, claims = table_3(args.seed)
        progress.doing("Table 4, %d calibrations" % args.sessions)
        turned, more = table_4(args.sessions, args.seed)
    result = {"format": 1, "kind": "sixflip reproduce", "seed": args.seed,
              "sessions": args.sessions, "table_3": repeated, "table_4": turned,
              "claims": claims + more}
    if args.json:
        print(json.dumps(result, ensure_ascii=False))
    else:
        show(result)
    return 0 if all(one["holds"] for one in result["claims"]) else 1


def table_3(seed):
    """(rows of Table 3 as dictionaries, claims)."""
    runs = li_tables.repeated_calibrations(seed, li_tables.PLACING_DEG)
    flush = li_tables.repeated_calibrations(seed, 0.0)
    mean, sd, exact = runs.mean(axis=0), runs.std(axis=0, ddof=1), flush.std(axis=0, ddof=1)
    truth = np.array([row[1] for row in li_tables.TABLE_3])
    paper = np.array([row[2] for row in li_tables.TABLE_3])
    rows = [{"parameter": name, "paper_mean": p, "paper_sd": s, "mean": m, "sd": o,
             "sd_flush": e} for (name, p, s), m, o, e in zip(
                 li_tables.TABLE_3, mean.tolist(), sd.tolist(), exact.tolist())]
    off = np.abs(mean - truth) / (sd / np.sqrt(len(runs)))
    claims = [claim("Table 3: every mean within %g standard errors of the sensor's true value"
                    % STANDARD_ERRORS, "%.1f at most" % off.max(), off.max() <= STANDARD_ERRORS)]
    for name, part in GROUPS:
        ours, theirs = (float(np.sqrt(np.mean(x[part] ** 2))) for x in (sd, paper))
        claims.append(claim("Table 3: standard deviation of %s, root mean square ×10⁻², "
                            "not above the paper's %.2f" % (name, theirs), "%.3f" % ours,
                            ours <= theirs))
    return rows, claims


def table_4(sessions, seed):
    """(rows of Table 4 as dictionaries, claims)."""
    before, after = li_tables.heading_turns(sessions, 1000 * seed)
    rows, claims = [], []
    for k, (turn, paper_before, paper_after) in enumerate(li_tables.TABLE_4):
        was, now = np.abs(before[:, k] - turn), np.abs(after[:, k] - turn)
        rows.append({
            "turn_deg": turn, "paper_before": paper_before, "paper_after": paper_after,
            "first_before": float(before[0, k].mean()), "first_after": float(after[0, k].mean()),
            "before_mean_error": float(was.mean()), "after_median_error": float(np.median(now)),
            "after_95_error": float(np.quantile(now, 0.95)), "repetitions": int(now.size)})
    was = float(np.mean([row["before_mean_error"] for row in rows]))
    theirs = np.mean([abs(row[1] - row[0]) for row in li_tables.TABLE_4])
    claims.append(claim("Table 4: before calibration the mean error is the paper's size, %g to "
                        "%g° (the paper's four: %.1f°)" % (*BEFORE, theirs), "%.2f°" % was,
                        BEFORE[0] <= was <= BEFORE[1]))
    for row in rows:
        claims.append(claim(
            "Table 4: after calibration a turn of %d° is read within %g° (median) and %g° (95 %%) "
            "of %d repetitions" % (row["turn_deg"], MEDIAN, P95, row["repetitions"]),
            "%.3f° and %.3f°" % (row["after_median_error"], row["after_95_error"]),
            row["after_median_error"] <= MEDIAN and row["after_95_error"] <= P95))
    return rows, claims


def show(result):
    """Both tables and the claims on the terminal."""
    screen = console()
    screen.print(table(
        "Table 3: %d calibrations of one sensor" % li_tables.CALIBRATIONS,
        ["parameter", "paper mean", "sd", "ours mean", "sd", "sd, flush"],
        [[row["parameter"], *("%.2f" % row[key] for key in ("paper_mean", "paper_sd")),
          *("%.3f" % row[key] for key in ("mean", "sd", "sd_flush"))]
         for row in result["table_3"]]))
    screen.print(plain(_about_table_3(result["table_3"])))
    screen.print()
    screen.print(table(
        "Table 4: turns of a robot on the floor, degrees, before and after",
        ["turn", "paper", "after", "ours", "after", "error before", "median after", "95 %"],
        [["%d°" % row["turn_deg"], *("%.1f" % row[key] for key in ("paper_before", "paper_after")),
          *("%.2f" % row[key] for key in ("first_before", "first_after", "before_mean_error")),
          *("%.3f" % row[key] for key in ("after_median_error", "after_95_error"))]
         for row in result["table_4"]]))
    screen.print(plain(_about_table_4(result["sessions"], result["table_4"][0]["repetitions"])))
    screen.print()
    for stated in result["claims"]:
        word = styled("holds", "bold green") if stated["holds"] else styled(
            "does not hold", "bold red")
        screen.print(word, plain(": %s: %s" % (stated["claim"], stated["found"])), sep="")


def _about_table_3(rows):
    better = [sum(row[key] < row["paper_sd"] for row in rows) for key in ("sd", "sd_flush")]
    return ("  ×10⁻², v in m/s²; simulated: a GY-85 whose true parameters are the paper's means, "
            "table tilted by %g°, %g° of hand error in each flip, boxes laid down to %g° (flush: "
            "exactly); our sd is below the paper's in %d of 12, flush in %d" % (
                li_tables.TILT_DEG, li_tables.HAND_DEG,
                li_tables.PLACING_DEG, *better))


def _about_table_4(sessions, repetitions):
    return ("  ours: the first calibration, its ten repetitions averaged as in the paper; errors: "
            "mean before, median and 95 %% after, of %d calibrations of as many gyros, %d "
            "repetitions of each turn, each counted by itself (those of one calibration share "
            "its error); %g° of hand error in each flip" % (
                sessions, repetitions, li_tables.HAND_DEG))
