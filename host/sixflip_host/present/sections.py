"""What a report is made of, one function each: they add to a Page."""

import numpy as np

from ..calibrate import verify_files
from ..calibrate.verification import verify
from ..figures import png
from ..history import drift, parameters, store, tables
from . import calibration_pictures as pictures
from . import calibration_words

LONGEST = 200           # of a text that a file says of itself


def facts(page, capture, record, board):
    """What was measured, with what."""
    meta = capture.meta
    rows = [("board", board or "unknown"), ("sensor", meta["sensor"])]
    who = meta.get("who_am_i")
    if isinstance(who, list):
        rows.append(("who_am_i", "/".join("0x%02x" % one if isinstance(one, int) else str(one)
                                          for one in who)[:LONGEST]))
    rows += [(words, str(meta[key])[:LONGEST]) for key, words in (
        ("board", "kind of board"), ("firmware", "firmware"), ("started", "started"),
        ("accel_range_g", "range, ± g"), ("accel_lsb_per_g", "counts per g"),
        ("gyro_range_dps", "range, ± deg/s"), ("gyro_lsb_per_dps", "counts per deg/s"),
        ("rate_hz", "samples a second")) if key in meta]
    rows.append(("gravity, m/s²", "%.5f" % capture.g))
    if len(capture):
        rows.append(("samples", "%d in %.1f s" % (
            len(capture), (capture.t_us[-1] - capture.t_us[0]) * 1e-6)))
    if record is not None:
        rows.append(("record", "number %d, session %d%s" % (
            record.sequence, record.session,
            "" if record.temp_c is None else ", at %.1f °C" % record.temp_c)))
    page.table(("", ""), rows)


def calibration(page, solution, record):
    """Verdict, vectors, residuals, tilt, parameters; what the board kept where it differs."""
    if record is not None and record.accel is not None:
        page.verdict(record.accel["verdict"], record.accel["reason"], "kept on the board")
    page.verdict(solution.verdict, solution.reason, "solved here from the capture")
    for remark in solution.remarks + solution.flips.words():
        page.paragraph(remark, note=True)
    if solution.accel is None:
        return
    P = record.accel["P"] if record is not None and record.accel else solution.accel.P
    names, raw, corrected, true = pictures.vectors(solution, P)
    worst = [1e3 * np.linalg.norm(one - true, axis=1).max() for one in (raw, corrected)]
    page.paragraph("worst vector of the poses: %.2f mg raw, %.2f mg corrected" % tuple(worst))
    page.picture("Error of every vector, raw and corrected",
                 png(pictures.errors(names, raw, corrected, true)))
    page.heading("Raw and corrected vectors, face by face")
    page.paragraph("Gravity's part along the table. Turned by 180°, it must point the other way: "
                   "a corrected pair lies about the middle, as far from it as the table tilts.",
                   note=True)
    page.picture("The two captures of every face", png(
        pictures.flip_pairs(names, raw, corrected, true)), 3)
    page.picture("What is left over", png(pictures.residuals(solution)))
    page.table(*calibration_words.pose_rows(solution))
    page.heading("The table's tilt")
    page.paragraph(calibration_words.tilt_line(solution.accel))
    if solution.accel.tilts:
        page.picture("As every face saw it", png(pictures.tilts(solution)), 3)
    _parameters(page, solution)


def _parameters(page, solution):
    r = solution.accel
    page.heading("Accelerometer (%s)" % r.level)
    page.table(*calibration_words.parameter_rows(solution))
    page.paragraph("true = T·S·(a + v), [a 1]·P = true, m/s²; ± is one standard error", note=True)
    page.table(("true x", "true y", "true z: P ± its standard error"), [
        ["%+.6f ± %.6f" % (r.P[i][j], r.sigma_P[i][j]) for j in range(3)] for i in range(4)])
    page.heading("Gyro")
    if solution.gyro is None:
        page.paragraph("not calibrated: " + solution.no_gyro)
        return
    page.verdict(solution.gyro.verdict, solution.gyro.reason)
    page.table(*calibration_words.gyro_rows(solution.gyro))
    if solution.gyro.flips:
        page.table(*calibration_words.flip_rows(solution.gyro, solution.flips))


def session(page, capture):
    """The capture over time."""
    if len(capture):
        page.picture("The session", png(pictures.session(capture)))


def verification(page, capture, record_path, record):
    """The board's arithmetic against the host's."""
    checks, remarks = verify(capture, record, verify_files.record_before(record_path, record))
    failed = [check for check in checks if not check.ok]
    page.heading("Verification")
    page.verdict("fails" if failed else "holds",
                 "%d of %d comparisons differ" % (len(failed), len(checks)) if failed else
                 "all %d comparisons agree (board with %d-bit floats)" % (
                     len(checks), record.float_bits), "the board's arithmetic")
    for remark in remarks:
        page.paragraph(remark, note=True)
    if failed:
        page.table(("", "board", "host", "limit"), [check.row() for check in failed])


def board_history(page, board):
    """What happened to this board before, and how it drifts; nothing where nothing is known."""
    file = store.path()
    rows = store.read(file, board) if file is not None and board else []
    if not rows:
        return
    calibrations, remarks = parameters.readable(rows)
    page.heading("History of this board")
    for remark in remarks:
        page.paragraph(remark, note=True)
    own = [pair for pair in calibrations if pair[0].verb != "refine"]
    if calibrations:
        page.table(*tables.calibration_rows(calibrations))
        if any(one.time_is == store.SEEN for one, _ in calibrations):
            page.paragraph(tables.SEEN_NOTE, note=True)
    head, checks = tables.check_rows(rows)
    if checks:
        page.table(head, checks)
    figure = pictures.drift(own) if len(own) > 1 else None
    if figure is not None:
        page.picture("Its parameters since the first calibration", png(figure), 3)
    drifts = drift.drifts(own)
    head, moved = tables.drift_rows(drifts)
    if moved:
        page.heading("Drift (%s)" % tables.DRIFT_NOTE, 3)
        page.table(head, moved)
    for note in tables.drift_notes(drifts):
        page.paragraph(note, note=True)


def gap(page, folder, paths):
    """What a nominal simulator of this sensor lacks, by `diagnose`; folder: for its pictures."""
    from ..capture import capture_file
    from ..diagnosis import answer, closed_loops
    from ..diagnosis.diagnose import diagnose
    from . import gap_report, gap_sentence
    diagnosed = diagnose([(path, capture_file.read_samples(path)) for path in paths],
                         jobs=0)
    closed = closed_loops.close_all(diagnosed)
    result = answer.as_dict(diagnosed)
    if closed:
        result["simulated"] = {kind: answer.of_loop(kind, one) for kind, one in closed.items()}
    page.heading("The gap to a nominal simulator")
    page.paragraph(gap_sentence.sentence(result))
    drawn = gap_report.draw(folder, diagnosed, closed)
    gap_report.sections(page, result, [(caption, path.read_bytes()) for caption, path in drawn])
