"""sixflip history: every calibration and check of every board, and how its parameters drift."""
import json

from .. import file_kinds
from ..errors import CheckFailed, UsageError
from ..file_arguments import add_output
from ..history import drift, parameters, store, tables
from ..json_numbers import finite
from ..terminal import console, plain, table

EXAMPLE = ("sixflip history\n"
           "         sixflip history e6614c311b4c5a2f --plot drift.png")


def add_arguments(parser):
    """The options of the verb."""
    parser.add_argument("board", nargs="?", metavar="BOARD",
                        help="id of a board, or how it begins (default: a list of all boards)")
    add_output(parser, "--plot", metavar="FILE.png", kinds=(file_kinds.PNG,),
               help="draw the parameters over time and temperature; needs BOARD")
    parser.add_argument("--json", action="store_true", help="the same as JSON")


def run(args):
    """List boards, or what happened to one."""
    if args.plot and not args.board:
        raise UsageError("--plot: expected a BOARD to draw")
    file = store.path()
    rows = [] if file is None else store.read(file)
    if args.board is None:
        return _boards(args, file, rows)
    board = _chosen(args.board, sorted({row.board for row in rows}))
    rows = [row for row in rows if row.board == board]
    calibrations, remarks = parameters.readable(rows)
    of_board = [pair for pair in calibrations if pair[0].verb != "refine"]
    drifts = drift.drifts(of_board)
    if args.plot:
        _plot(args.plot, of_board)
    if args.json:
        print(json.dumps(finite(to_json(board, rows, calibrations, drifts, remarks))))
    else:
        _words(board, rows, calibrations, drifts, remarks)
    return 0


def _plot(path, calibrations):
    from ..figures import save
    from ..present.calibration_pictures import drift
    figure = drift(calibrations)
    if figure is None:
        raise CheckFailed("%s: not drawn, no calibration of this board says its parameters" % path)
    save(figure, path)


def _chosen(word, boards):
    """The one board whose id begins like that."""
    matching = [board for board in boards if board == word] or \
        [board for board in boards if board.startswith(word)]
    if len(matching) == 1:
        return matching[0]
    raise UsageError("%s: %s, expected one of %s" % (
        word, "%d boards begin so" % len(matching) if matching else "no such board in the history",
        " ".join(matching or boards) or "none, the history is empty"))


def _boards(args, file, rows):
    """One line a board: what is known of it and when it was last calibrated and checked."""
    rows_of = {}
    for row in rows:
        rows_of.setdefault(row.board, []).append(row)
    listed = [_summary(board, its) for board, its in sorted(rows_of.items())]
    if args.json:
        print(json.dumps({"format": 1, "kind": "sixflip history", "file": file and str(file),
                          "boards": listed}))
    elif not listed:
        print(plain("nothing in the history yet (%s)" % (
            file or "%s is empty: none is kept" % store.VARIABLE)))
    else:
        console().print(table("boards (%s)" % file, [
            "board", "sessions", "last one", "verdict", "checked", ""], [
            [one["board"], str(one["calibrations"]), tables.when(one["calibrated"])[:10],
             tables._coloured(one["verdict"]), tables.when(one["checked"])[:10],
             tables._coloured(one["holds"])] for one in listed]))
    return 0


def _summary(board, rows):
    calibrations = [row for row in rows if row.kind == "calibration"]
    checks = [row for row in rows if row.kind != "calibration"]
    last, seen = (its[-1] if its else None for its in (calibrations, checks))
    return {"board": board, "chip": next((row.chip for row in reversed(rows) if row.chip), None),
            "calibrations": len(calibrations), "calibrated": last and last.at,
            "verdict": last and last.verdict, "checks": len(checks), "checked": seen and seen.at,
            "holds": seen and seen.verdict}




def to_json(board, rows, calibrations, drifts, remarks):
    """dict: what happened in the order of time, with parameters; the drifts; remarks."""
    known = {id(one): found for one, found in calibrations}
    return {
        "format": 1, "kind": "sixflip history of a board", "board": board, "remarks": remarks,
        "happened": [{
            "kind": row.kind, "verb": row.verb, "unix_time": row.at, "time_is": row.time_is,
            "chip": row.chip, "session": row.session, "sequence": row.sequence,
            "verdict": row.verdict, "reason": row.reason, "temp_c": row.temp_c,
            "parameters": {name: {"value": value, "sigma": sigma}
                           for name, (value, sigma) in known.get(id(row), {}).items()},
            "answer": row.answer} for row in rows],
        "drift": [{"parameter": one.name, "change": one.change, "note": one.note,
                   "per_c": _slope_json(one.per_c),
                   "per_30_days": _slope_json(one.per_30_days)} for one in drifts]}


def _slope_json(slope):
    return slope and {"value": slope[0], "sigma": slope[1], "beyond_doubt": slope[2]}


def _words(board, rows, calibrations, drifts, remarks):
    screen = console()
    for remark in remarks:
        screen.print(plain(remark))
    if calibrations:
        screen.print(table("calibrations of board %s" % board, *tables._coloured_rows(
            *tables.calibration_rows(calibrations), 4)))
    if any(one.time_is == store.SEEN for one, _ in calibrations):
        screen.print(tables.SEEN_NOTE)
    head, checks = tables.check_rows(rows)
    if checks:
        screen.print(table("checks", *tables._coloured_rows(head, checks, 3), prose=True))
    head, moved = tables.drift_rows(drifts)
    if moved:
        screen.print(table("drift (%s)" % tables.DRIFT_NOTE, head, moved))
    for note in tables.drift_notes(drifts):
        screen.print(plain(note))


















