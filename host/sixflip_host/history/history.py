"""sixflip history: every calibration and check of every board, and how its parameters drift."""

import json
import math
from datetime import datetime, timezone

from .. import file_kinds
from ..errors import CheckFailed, UsageError
from ..file_arguments import add_output
from ..solving.solve import finite
from ..terminal import console, plain, styled, table, verdict_text
from . import drift, parameters, store
from .parameters import AXES

HELP = "every calibration and check of a board so far, and how its parameters drift"
EXAMPLE = ("sixflip history\n"
           "         sixflip history e6614c311b4c5a2f --plot drift.png")
SEEN_NOTE = "~ fetched then: the board has no clock, it was calibrated some time before"
DRIFT_NOTE = "± is one standard error, * beyond doubt"


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
    from ..reporting.figures import save
    from .drift_picture import draw
    figure = draw(calibrations)
    if figure is None:
        raise CheckFailed("%s: not drawn, no calibration of this board says its parameters" % path)
    save(figure, path)


def _chosen(word, boards):
    """The one board whose id begins like that."""
    found = [board for board in boards if board == word] or \
        [board for board in boards if board.startswith(word)]
    if len(found) == 1:
        return found[0]
    raise UsageError("%s: %s, expected one of %s" % (
        word, "no such board in the history" if not found else "%d boards begin so" % len(found),
        " ".join(found or boards) or "none, the history is empty"))


def _boards(args, file, rows):
    """One line a board: what is known of it and when it was last calibrated and checked."""
    found = {}
    for row in rows:
        found.setdefault(row.board, []).append(row)
    listed = [_summary(board, its) for board, its in sorted(found.items())]
    if args.json:
        print(json.dumps({"format": 1, "kind": "sixflip history", "file": file and str(file),
                          "boards": listed}))
    elif not listed:
        print(plain("nothing in the history yet (%s)" % (
            file or "%s is empty: none is kept" % store.VARIABLE)))
    else:
        console().print(table("boards (%s)" % file, [
            "board", "sessions", "last one", "verdict", "checked", ""], [
            [one["board"], str(one["calibrations"]), when(one["calibrated"])[:10],
             _coloured(one["verdict"]), when(one["checked"])[:10],
             _coloured(one["holds"])] for one in listed]))
    return 0


def _summary(board, rows):
    calibrations = [row for row in rows if row.kind == "calibration"]
    checks = [row for row in rows if row.kind != "calibration"]
    last, seen = (its[-1] if its else None for its in (calibrations, checks))
    return {"board": board, "chip": next((row.chip for row in reversed(rows) if row.chip), None),
            "calibrations": len(calibrations), "calibrated": last and last.at,
            "verdict": last and last.verdict, "checks": len(checks), "checked": seen and seen.at,
            "holds": seen and seen.verdict}


def when(unix):
    """2026-11-21 22:40, UTC; - for never, or for a time no calendar has."""
    try:
        return datetime.fromtimestamp(unix, timezone.utc).strftime("%Y-%m-%d %H:%M")
    except (TypeError, ValueError, OverflowError, OSError):
        return "-"


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
    out = console()
    for remark in remarks:
        out.print(plain(remark))
    if calibrations:
        out.print(table("calibrations of board %s" % board, *_coloured_rows(
            *calibration_rows(calibrations), 4)))
    if any(one.time_is == store.SEEN for one, _ in calibrations):
        out.print(SEEN_NOTE)
    head, checks = check_rows(rows)
    if checks:
        out.print(table("checks", *_coloured_rows(head, checks, 3), prose=True))
    head, moved = drift_rows(drifts)
    if moved:
        out.print(table("drift (%s)" % DRIFT_NOTE, head, moved))
    for note in drift_notes(drifts):
        out.print(plain(note))


def calibration_rows(calibrations):
    """Every calibration with its scale, bias and gyro bias: head, rows of text."""
    return ["UTC", "by", "no.", "°C", "verdict", "scale x y z", "bias x y z, mg",
            "gyro bias x y z, deg/s"], [
        [("~" if one.time_is == store.SEEN else "") + when(one.at), one.verb,
         "-" if one.sequence is None else str(one.sequence), _cell(one.temp_c, "%.1f"),
         one.verdict, _triple(found, "accel_scale_%s", "%.5f"),
         _triple(found, "accel_bias_%s_mg", "%+.2f"),
         _triple(found, "gyro_bias_%s_dps", "%+.3f")] for one, found in calibrations]


def check_rows(rows):
    """Every verification and check: head, rows of text."""
    return ["UTC", "by", "°C", "", "why"], [
        [when(row.at), row.verb, _cell(row.temp_c, "%.1f"), row.verdict, row.reason]
        for row in rows if row.kind != "calibration"]


def drift_rows(drifts):
    """What moved with time or temperature: head, rows of text."""
    return ["parameter", "change", "per °C", "per 30 days"], [
        [one.name, "%+.5g" % one.change, _slope(one.per_c), _slope(one.per_30_days)]
        for one in drifts if one.per_c or one.per_30_days]


def drift_notes(drifts):
    """Sentences on why drifts are not named."""
    moved = any(one.per_c or one.per_30_days for one in drifts)
    return ["no drift of %s named: %s" % ("the others" if moved else "any parameter", note)
            for note in dict.fromkeys(one.note for one in drifts if one.note)]


def _coloured_rows(head, rows, column):
    return head, [[_coloured(cell) if k == column else cell for k, cell in enumerate(row)]
                  for row in rows]


def _cell(value, form):
    return "-" if value is None else form % value


def _triple(found, pattern, form):
    values = [found.get(pattern % axis, (None,))[0] for axis in AXES]
    return "-" if None in values else " ".join(form % value for value in values)


def _coloured(verdict):
    style = {"holds": "green", "fails": "bold red"}.get(verdict)
    return styled(verdict, style) if style else verdict_text(verdict or "-")


def _slope(slope):
    """Value and error with the digits that the error leaves meaning to; six at most."""
    if slope is None:
        return "-"
    value, error, sure = slope
    digits = 1 - math.floor(math.log10(error)) if error > 0 else 6
    most = 5 - math.floor(math.log10(abs(value))) if value else 6
    digits, star = max(0, min(digits, most)), " *" if sure else ""
    if digits > 6:
        return "%+.1e ± %.0e%s" % (value, error, star)
    return "%+.*f ± %.*f%s" % (digits, value, digits, error, star)
