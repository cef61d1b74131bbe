"""sixflip show: what is in a record or a capture, in words."""

import json
import math

import numpy as np

from sixflip.accelerometer.scale_form import scale_form
from sixflip.poses.faces import pose_name

from .. import atomic_write, file_kinds, record_terms
from ..board.ports import add_port, open_link
from ..calibrate import solution, term_words
from ..calibrate.record_json import record_json
from ..calibrate.verify_files import RECORDS, decode_record
from ..capture import clock, clock_words, open_recording
from ..capture.capture_binary import EXTRAS, PAUSES, write_pauses
from ..errors import BadFile
from ..file_arguments import add_input
from ..json_numbers import finite
from ..terminal import console, plain, table, verdict_text

EXAMPLE = "sixflip show capture.csv"


def add_arguments(parser):
    """The options of the verb."""
    add_input(parser, "file", nargs="?", help="record or capture (default: a board's records)")
    add_port(parser)
    parser.add_argument("--json", action="store_true", help="the same as JSON")


def run(args):
    """Print one record or capture, or both records of a board."""
    if args.file is None:
        return _board(args)
    if file_kinds.kind_of(args.file) == file_kinds.RECORD:
        return _show_record(args.file, atomic_write.read_bytes(args.file), args.json)
    capture = open_recording.read(args.file, gyro_alone=True)
    if args.json:
        print(json.dumps(finite(_capture_json(capture))))
    else:
        _capture_words(args.file, capture)
    return 0


def _board(args):
    with open_link(args.port) as link:
        present = [name for name in RECORDS if name in link.files([])]
        contents = [(name, link.get(name)) for name in present]
        link.reset()
    if not contents:
        raise BadFile("the board holds no record: sixflip calibrate")
    if args.json:
        print(json.dumps({"format": 1, "kind": "sixflip records of a board", "records": {
            name: _json_of(name, data) for name, data in contents}}))
        return 0
    for name, data in contents:
        try:
            _show_record(name, data, False)
        except BadFile as error:
            console().print(plain(str(error)))
    return 0


def _json_of(name, data):
    """A record as JSON, or why it cannot be read."""
    try:
        return record_json(decode_record(name, data))
    except BadFile as error:
        return {"error": str(error)}


def _show_record(name, data, as_json):
    record = decode_record(name, data)
    if as_json:
        print(json.dumps(record_json(record)))
    else:
        _record_words(name, record)
    return 0


def _record_words(name, record):
    screen = console()
    screen.print(plain("%s: correction for a %s (who_am_i %s), number %d, session %d" % (
        name, record.chip, "/".join("0x%02x" % one for one in record.who_am_i),
        record.sequence, record.session)))
    screen.print(plain("  ±%g g at %g counts per g, ±%g deg/s at %g counts per deg/s, g %.5f "
                       "m/s²" % (
        record.accel_range_g, record.accel_lsb_per_g, record.gyro_range_dps,
        record.gyro_lsb_per_dps, record.g)))
    if record.temp_c is not None:
        screen.print("  measured at %.1f °C" % record.temp_c)
    for section in ("accel", "gyro"):
        fields = getattr(record, section)
        if fields is None:
            screen.print("%s: not measured" % section)
            continue
        screen.print(_matrix(section, fields["P"], record.g if section == "accel" else None))
        if fields.get("tilt_deg") is not None:
            screen.print("table tilt %.3f deg, the faces agree to %.3f deg (%s)" % (
                fields["tilt_deg"], fields["tilt_spread_deg"], fields["level"]))
        screen.print(verdict_text(fields["verdict"]), ": ", plain(fields["reason"]), sep="")
    if record.gyro_bias is not None:
        screen.print("gyro bias %s deg/s" % _numbers(record.gyro_bias["bias_dps"], "%+.4f"))
    if record.mounting is not None:
        screen.print("mounting: roll %.3f deg, pitch %.3f deg, order %s" % tuple(
            record.mounting[key] for key in ("roll_deg", "pitch_deg", "order")))
    for name, fields in record_terms.terms(record).items():
        for line in term_words.lines(term_words.facts(name, fields)):
            screen.print(plain(line))


def _numbers(values, form):
    return "  ".join(form % value for value in values)


def _matrix(section, P, g):
    """Scale, bias and angles out of a P."""
    try:
        T, scale, v, _ = scale_form(P)
    except ValueError as error:
        raise BadFile("the record's %s section cannot be a correction: %s" % (section, error))
    bias = [-1e3 * x / g if g else -math.degrees(x) for x in v]
    rows = [["xyz"[k], "%.5f" % scale[k], ("%+.2f" if g else "%+.4f") % bias[k],
             _numbers([math.degrees(T[k][j]) for j in range(3) if j != k], "%+.3f")]
            for k in range(3)]
    return table({"accel": "accelerometer"}.get(section, section),
                 ["axis", "scale", "bias, mg" if g else "bias, deg/s", "angles, deg"], rows)


def _capture_json(capture):
    measured = clock.sample_clock(capture)
    return {"format": 1, "kind": "sixflip capture", "meta": capture.meta,
            "samples": len(capture), "columns": capture.columns(),
            "duration_s": _duration(capture), "remarks": solution.capture_remarks(capture),
            "notes": capture.notes, "clock": clock_words.as_json(measured) if measured else None,
            "placements": [{"pose": pose_name(one.pose), "first": one.first, "n": one.n,
                            "mean": [s / one.n for s in one.sums], "noise": one.noise}
                           for one in capture.placements()]}


def _duration(capture):
    return float(capture.t_us[-1] - capture.t_us[0]) / 1e6 if len(capture) else 0.0


def _capture_words(name, capture):
    screen = console()
    screen.print(plain("%s: %d samples of a %s in %.1f s, columns %s" % (
        name, len(capture), capture.meta["sensor"], _duration(capture),
        " ".join(capture.columns()))))
    pauses = write_pauses(capture)
    for key, value in capture.meta.items():
        if key == EXTRAS and isinstance(value, dict):       # hundreds of times, counted below
            value = {name: kept for name, kept in value.items() if name != PAUSES}
        screen.print(plain("  %s: %s" % (key, json.dumps(value))))
    for line in capture.assumed + solution.capture_remarks(capture) + capture.notes:
        screen.print(plain("  " + line))
    measured = clock.sample_clock(capture)
    if measured:
        gaps = np.diff(capture.t_us)
        screen.print("  longest interval %.1f ms, usual %.1f ms" % (
            gaps.max() / 1e3, np.median(gaps) / 1e3))
        for line in clock_words.words(measured):
            screen.print("  " + line)
    if len(pauses):
        screen.print("  %d of the pauses are writes to the board's flash" % len(pauses))
    lsb = capture.meta.get("accel_lsb_per_g")
    rows = [[pose_name(one.pose), str(one.first), str(one.n),
             _numbers([s / one.n / lsb for s in one.sums[:3]], "%+.4f"),
             _numbers([1e3 * x / lsb for x in one.noise[:3]], "%.2f")]
            for one in capture.placements()]
    if rows:
        screen.print(table("placements", [
            "pose", "first", "samples", "mean x y z, g", "noise, mg"], rows))
    else:
        screen.print("  no labelled poses")
