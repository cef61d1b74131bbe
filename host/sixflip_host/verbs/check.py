"""sixflip check: does the calibration still hold? One rest of some seconds against the record."""

import json

from sixflip.record import still_valid
from sixflip.record.correction import correction_of

from ..board.board_events import wait_for
from ..board.ports import add_port, open_link
from ..calibrate import verify_files
from ..capture import capture_file, rests
from ..errors import CheckFailed, UsageError
from ..file_arguments import add_input
from ..history import logbook
from ..terminal import plain, say
from .solve import local_gravity

EXAMPLE = ("sixflip check\n"
           "         sixflip check rest.csv --record record_a.bin")
# A bias that wandered is no fault, it is taken anew at every power-up; so much is another gyro.
BIAS_DPS = 5.0


def add_arguments(parser):
    """The options of the verb."""
    add_input(parser, "capture", nargs="?",
              help="capture of some seconds of rest (default: a board measures now)")
    add_input(parser, "--record", help="the correction record; with a capture")
    parser.add_argument("--g", type=float, help="gravity of this place, m/s² (default: what the "
                        "capture says, else the record)")
    parser.add_argument("--lat", type=float, metavar="DEG", help="latitude, for gravity")
    parser.add_argument("--height", type=float, metavar="M", help="height above the ellipsoid")
    add_port(parser)
    parser.add_argument("--json", action="store_true", help="the answer as one JSON object")


def run(args):
    """Answer in words; 1 when the calibration no longer holds."""
    if args.capture and not args.record:
        raise UsageError("a capture needs --record, the record to hold it against")
    if args.record and not args.capture:
        raise UsageError("--record needs a capture; a board checks its own record")
    if args.capture and args.port:
        raise UsageError("a capture and --port: expected one of the two")
    g = local_gravity(args)
    if g is not None and not args.capture:
        raise UsageError("--g and --lat need a capture; a board knows its g from its settings")
    if args.capture:
        capture = capture_file.read_samples(args.capture)
        board = capture.meta.get("device_id")
        answer = compare(capture, verify_files.accelerometer_record(args.record), g)
    else:
        board, answer = ask_board(args.port)
    logbook.checked(board, answer)
    if args.json:
        print(json.dumps(answer))
    else:
        say(lines(answer))
    return 0 if answer["valid"] else CheckFailed.exit_code


def compare(capture, record, g=None):
    """The answer for a capture at rest; CheckFailed when it is no rest. g in m/s² of the place."""
    verify_files.fits(record, capture)
    rest = rests.longest(capture)
    if rest.reason:
        raise CheckFailed("not checked, there is no rest: %s" % rest.reason)
    correction = correction_of(record)
    g = g or capture.meta.get("g", record.g)
    temp_c = _celsius(capture, rest)
    error_mg = still_valid.length_error_mg(correction, rest.means, g)
    noise_mg = rest.noise_mg(record.accel_lsb_per_g)[0]
    drift_known = still_valid.drift_is_corrected(correction, temp_c)
    answer = {
        "a_error_mg": error_mg, "noise_mg": noise_mg,
        "noise_then_mg": 1e3 * record.accel["noise_g"] if record.accel["noise_g"] else None,
        "temp_c": temp_c, "temp_then_c": record.temp_c, "drift_known": drift_known,
        "bias_dps": None, "bias_then_dps": None, "seconds": rest.n / capture.meta["rate_hz"],
        "record_verdict": record.accel["verdict"], "record_reason": record.accel["reason"]}
    if capture.gyro is not None:
        answer["bias_dps"] = [x / capture.meta["gyro_lsb_per_dps"] for x in rest.means[3:6]]
        if record.gyro_bias:
            answer["bias_then_dps"] = list(record.gyro_bias["bias_dps"])
    return judged(answer, still_valid.against(error_mg, noise_mg, temp_c, record, drift_known))


def _celsius(capture, rest):
    if capture.temp is None:
        return None
    return rest.means[6] / capture.meta["temp_lsb_per_c"] + capture.meta["temp_offset_c"]


def judged(answer, against):
    """The answer with `against`, what speaks against the calibration, and `valid`."""
    against = list(against)
    if answer["record_verdict"] == "refused":
        against.insert(0, "the record itself was refused")
    if answer["bias_dps"] and answer["bias_then_dps"]:
        moved = max(abs(x - y) for x, y in zip(answer["bias_dps"], answer["bias_then_dps"]))
        if not moved <= BIAS_DPS:
            against.append("the gyro's bias moved by %.1f deg/s, %.0f is the limit: it turns, or "
                           "it is another gyro" % (moved, BIAS_DPS))
    return dict(answer, format=1, kind="sixflip check", valid=not against, against=against)


def ask_board(port):
    """(id, answer) of a board's own check; CheckFailed when it has none."""
    seen = {}
    with open_link(port) as link:
        board = link.board_id()
        link.reset()
        started = wait_for(link, ("ready", "calibrating"),
                           seen=lambda event: seen.update({event["event"]: event}))
        if started["event"] == "calibrating":
            raise CheckFailed("%s: no correction is in force, so the board is calibrating; there "
                              "is nothing to check" % link.port)
        link.send(json.dumps({"cmd": "check"}))
        event = wait_for(link, ("check", "error"))
    if event["event"] == "error":
        raise CheckFailed("not checked: %s; expected %s" % (event["what"], event.get("expected")))
    if not event["still"]:
        raise CheckFailed("not checked, there is no rest: %s" % event.get("reason"))
    record = seen.get("record") or {}
    valid = event["verdict"] == "good"
    board = seen.get("hello", {}).get("id") or board
    return board, {
        "format": 1, "kind": "sixflip check", "valid": valid,
        "against": [] if valid else event.get("words") or [],
        "a_error_mg": event.get("a_error_mg"), "noise_mg": event.get("noise_mg"),
        "noise_then_mg": None, "temp_c": event.get("temp_c"),
        "temp_then_c": record.get("temp_c"), "record_verdict": record.get("verdict"),
        "record_reason": record.get("reason"),
        "bias_dps": event.get("bias_dps"), "bias_then_dps": None, "seconds": None}


def lines(answer):
    """The answer for a person: each number beside the record's, then whether it is still valid."""
    said = []
    if answer["a_error_mg"] is not None:
        said.append("|a|          %+.2f mg off gravity (length only: it says nothing of "
                    "directions)" % answer["a_error_mg"])
    said += _beside("noise", answer["noise_mg"], answer["noise_then_mg"], "%.2f mg")
    said += _beside("temperature", answer["temp_c"], answer["temp_then_c"], "%.1f °C")
    if answer["bias_dps"]:
        form = "%+.3f %+.3f %+.3f deg/s"
        then = answer["bias_then_dps"]
        said += _beside("gyro bias", tuple(answer["bias_dps"]), then and tuple(then), form)
    if answer["record_verdict"] == "doubtful":
        said.append(plain("the calibration itself was doubtful: %s" % answer["record_reason"]))
    if answer["valid"]:
        said.append("still valid: nothing speaks against the record")
    else:
        said.append("no longer valid:")
        said += ["  " + plain(one) for one in answer["against"]]
    return said


def _beside(name, now, then, form):
    if now is None:
        return []
    return ["%-12s " % name + form % now
            + ("" if then is None else ", at the calibration " + form % then)]
