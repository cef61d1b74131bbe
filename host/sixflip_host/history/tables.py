"""What became of a board, as rows and sentences."""

import math
from datetime import datetime, timezone

from ..terminal import styled, verdict_text
from . import store
from .parameters import AXES

SEEN_NOTE = "~ fetched then: the board has no clock, it was calibrated some time before"
DRIFT_NOTE = "± is one standard error, * beyond doubt"


def when(unix):
    """2026-11-21 22:40, UTC; - for never, or for a time no calendar has."""
    try:
        return datetime.fromtimestamp(unix, timezone.utc).strftime("%Y-%m-%d %H:%M")
    except (TypeError, ValueError, OverflowError, OSError):
        return "-"


def calibration_rows(calibrations):
    """Every calibration with its scale, bias and gyro bias: head, rows of text."""
    return ["UTC", "by", "no.", "°C", "verdict", "scale x y z", "bias x y z, mg",
            "gyro bias x y z, deg/s"], [
        [("~" if row.time_is == store.SEEN else "") + when(row.at), row.verb,
         "-" if row.sequence is None else str(row.sequence), _cell(row.temp_c, "%.1f"),
         row.verdict, _triple(parameters, "accel_scale_%s", "%.5f"),
         _triple(parameters, "accel_bias_%s_mg", "%+.2f"),
         _triple(parameters, "gyro_bias_%s_dps", "%+.3f")] for row, parameters in calibrations]


def check_rows(rows):
    """Every verification and check: head, rows of text."""
    return ["UTC", "by", "°C", "", "why"], [
        [when(row.at), row.verb, _cell(row.temp_c, "%.1f"), row.verdict, row.reason]
        for row in rows if row.kind != "calibration"]


def drift_rows(drifts):
    """What moved with time or temperature: head, rows of text."""
    return ["parameter", "change", "per °C", "per 30 days"], [
        [drift.name, "%+.5g" % drift.change, _slope(drift.per_c), _slope(drift.per_30_days)]
        for drift in drifts if drift.per_c or drift.per_30_days]


def drift_notes(drifts):
    """Sentences on why drifts are not named."""
    moved = any(drift.per_c or drift.per_30_days for drift in drifts)
    return ["no drift of %s named: %s" % ("the others" if moved else "any parameter", note)
            for note in dict.fromkeys(drift.note for drift in drifts if drift.note)]


def _coloured_rows(head, rows, column):
    return head, [[_coloured(cell) if k == column else cell for k, cell in enumerate(row)]
                  for row in rows]


def _cell(value, form):
    return "-" if value is None else form % value


def _triple(parameters, pattern, form):
    values = [parameters.get(pattern % axis, (None,))[0] for axis in AXES]
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
