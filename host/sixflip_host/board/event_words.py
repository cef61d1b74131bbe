"""What a board's events say, in plain lines for the person with the box in the hand."""

from sixflip.poses.faces import FACES

from ..record_terms import TERMS
from ..terminal import plain

HOW = {
    "moving": "hold still",
    "saturated": "the sensor is at full scale: put the box down gently",
    "stale": "the readings do not change: the sensor hangs, or its cable",
    "crooked": "the box does not lie flat on this face",
    "leaning": "lay the box on one of its six faces",
    "noisy": "more noise than at the start: does the table shake?",
    "not a flip": "turn the box by half a turn, flat on the table",
    "not leaning": "the plan wants the box leaned on something here, on none of its faces",
    "turned": "the plan wants it as it lay: lift it and put it back",
    "already done": "both placements of this face are done, take another face",
}
# Always a quarter turn on, about y, z, x and again: gravity before and after them shows the
# sign of every gyro axis, which half turns do not.
ROUND = ("Z+", "X+", "Y+", "Z-", "X-", "Y-")
GUIDED_ORDER = [face + letter for face in ROUND for letter in "ab"]


def faces_left(missing):
    """"Z+ and its flip, X- (flip)" of ["Z+a", "Z+b", "X-b"]."""
    left = []
    for pose in missing:
        face = pose[:-1]
        if pose.endswith("a"):
            left.append(face + (" and its flip" if face + "b" in missing else ""))
        elif face + "a" not in missing:
            left.append(face + " (flip)")
    return ", ".join(left)


def why(event):
    """The reason of a state or a refusal in words, with number and limit."""
    reason = event.get("reason") or ""
    if event.get("unit") == "face":
        return "this is %s, the plan wants %s up" % (FACES[int(event["value"])],
                                                     FACES[int(event["limit"])])
    return HOW.get(reason, reason) + measured(event)


def next_step(missing):
    """What to do now that a pose was taken."""
    if not missing:
        return "all six faces done"
    flips = [pose for pose in missing if pose.endswith("b") and pose[:-1] + "a" not in missing]
    if flips:
        return "next: turn the box half a turn on the table, same face up (%s)" % flips[0][:-1]
    onward = [face for face in ROUND if face + "a" in missing]
    return "%sleft: %s" % ("next: %s up; " % onward[0] if onward else "", faces_left(missing))


def measured(event):
    """" (0.9 deg, limit 5 deg)" when the event has a number behind its reason."""
    if event.get("reason") and event.get("limit"):
        unit = event.get("unit") or ""
        return " (%.3g %s, limit %.3g %s)" % (event.get("value") or 0, unit, event["limit"], unit)
    return ""


def state_line(event):
    """The line that is rewritten in place: what the board waits for, with number and limit."""
    if event.get("state") == "capturing":
        total = event.get("total") or 1
        done = min(1.0, (event.get("progress") or 0) / total)
        bar = "#" * int(20 * done) + "." * (20 - int(20 * done))
        return "%-3s [%s] %3d %%, keep still %.0f s" % (
            event.get("pose") or "", bar, 100 * done, event.get("left_s") or 0)
    if event.get("state") == "resting":
        return "resting: leave the box alone for %.0f s" % (event.get("left_s") or 0)
    words = [event.get("state") or "", why(event)]
    text = ": ".join(word for word in words if word)
    left = event.get("left_s")
    return text + (" (gives up in %d s)" % left if left and left < 60 else "")


def _solved(event):
    if event.get("verdict") == "refused":
        return "verdict: refused: %s" % event.get("reason", "")
    line = "verdict: %s%s" % (event.get("verdict"), "" if not event.get("reason") else
                              ": " + event["reason"])
    if event.get("tilt_deg") is not None:
        line += "\ntable tilt %.2f deg (faces agree within %.2f deg), residual %.2f mg" % (
            event["tilt_deg"], event.get("tilt_spread_deg") or 0,
            event.get("residual_mg_rms") or 0)
    gyro = event.get("gyro")
    if gyro:
        line += "\ngyro: %s: %s" % (gyro.get("verdict"), gyro.get("reason", ""))
    return line


def saved(event):
    """What became of the record."""
    where = "slot %s, sequence %s" % (event.get("slot"), event.get("sequence"))
    if event.get("written") is not False:
        return "saved in " + where
    return "not written, no better than %s: %s" % (where, event.get("reason") or "no reason given")


def _saved(event):
    kept = event.get("capture")
    return saved(event) + (
        "; the raw capture of this session is kept as %s" % kept if kept else "")


def _record(event):
    return "correction in force: slot %s, sequence %s, verdict %s%s" % (
        event.get("slot"), event.get("sequence"), event.get("verdict"), _terms(event))


def _terms(event):
    """", with g_sensitivity" when a record has terms beyond scale and bias."""
    names = [name for tag, name in TERMS if tag in (event.get("terms") or [])]
    return ", with " + ", ".join(names) if names else ""


def _term_range(event):
    return ("%.1f °C is outside of %.1f to %.1f °C, what the record's terms were measured at: the "
            "edge holds" % (event["temp_c"], event["low_c"], event["high_c"]))


def _rest(event):
    """The bias, and what speaks against the calibration in this rest."""
    against = event.get("words") if event.get("verdict") == "doubtful" else None
    return "\n".join(filter(None, [_bias(event), against and "the calibration is doubtful: "
                                   + "; ".join(map(str, against))])) or None


def _bias(event):
    if event.get("bias") == "measured now":
        return "gyro bias measured at rest; %s" % event.get("note")
    if not event.get("reason"):
        return None     # a sensor without gyro
    held = event.get("bias")
    return "gyro bias not measured now: %s; %s" % (
        event["reason"], "there is none" if held == "none" else "the %s one is used" % held)


def _gravity(event):
    return ("the calibration is doubtful: |a| at rest is %+.1f mg off, %.0f is the limit: "
            "calibrate again" % (event["a_error_mg"], event["limit_mg"]))


def _mounted(event):
    if event.get("off"):
        return "no mounting any more: samples are in the sensor's axes"
    return ("mounted: roll %.2f deg, pitch %.2f deg (order R_%s, yaw 0: gravity does not "
            "show it), good to %.3f deg by noise alone\n%s: the robot's x y z lie along the "
            "sensor's %s; samples are %s; %s" % (
                event["roll_deg"], event["pitch_deg"], event["order"], event["sigma_deg"],
                event["frame"], event["axes"], "forward, right, down" if event["frame"] == "ned"
                else "forward, left, up", saved(event) if event["written"] else "as stored"))


def _capture(event):
    if event.get("sums_only"):
        return "raw capture: only the sums are kept (%s)" % event.get("reason", "short of space")
    return "raw capture: %s samples, %s bytes" % (event.get("samples"), event.get("bytes"))


WORDS = {
    "hello": lambda e: "board %s, %s%s" % (
        e.get("id"), e.get("chip") or "no sensor found",
        "" if e.get("sensor") != "adxl345"
        else "\nno gyro: lift the box for each half turn, or it is not seen"),
    "grace": lambda e: "starts in %.1f s" % ((e.get("ms") or 0) / 1000),
    "no_record": lambda e: "no correction in flash: %s" % e.get("reason", ""),
    "record": _record,
    "calibrating": lambda e: "calibrating: lay the box on a face and let go, Z+ up to begin "
                             "with; left: %s" % faces_left(e.get("missing") or []),
    "pose": lambda e: "%s taken; %s" % (e.get("pose"), next_step(e.get("missing") or [])),
    "afresh": lambda e: "there is no unfinished session to go on with (%s): all six faces" % (
        e.get("reason")),
    "redo": lambda e: "%s again; left: %s" % (e.get("face"), faces_left(e.get("missing") or [])),
    "refused": lambda e: "%s not taken: %s" % (e.get("pose") or "placement", why(e)),
    "solved": _solved,
    "saved": _saved,
    "capture": _capture,
    "rest": _rest,
    "gravity": _gravity,
    "mounted": _mounted,
    "not_mounted": lambda e: "mounting not measured: %s" % e.get("reason"),
    "not_restored": lambda e: "the record offered was refused: %s" % e.get("reason"),
    "restored": lambda e: "restored: slot %s, sequence %s%s" % (
        e.get("slot"), e.get("sequence"), _terms(e)),
    "term_range": _term_range,
    "bus_error": lambda e: "bus error %s (%s so far): %s" % (
        e.get("errno"), e.get("count"), e.get("action")),
    "error": lambda e: "error: %s; expected %s" % (e.get("what"), e.get("expected")),
    # one of many live ones is not worth a line
    "misfit": lambda e: None if e["of"] in ("state", "sample", "heading")
    else "the board says something that cannot be used: " + e["why"],
}


def planned(event, step):
    """The lasting line for an event of a session that follows a plan, None for other ones."""
    kind = event["event"]
    if kind == "calibrating":
        return "calibrating by a plan of %d placements\n%s" % (
            len(event.get("missing") or []), step(0))
    if kind not in ("pose", "redo") or not isinstance(event.get("at"), int):
        return None
    done = "%s taken" % event.get("pose") if kind == "pose" else "%s again" % event.get("face")
    if kind == "redo":
        return "%s (%d of %s): as it lay before" % (done, event["at"], event.get("of"))
    return "%s (%d of %s); %s%s" % (done, event["at"], event.get("of"),
                                    "next " if event["at"] < event["of"] else "",
                                    step(event["at"]))


def words(event, step=None):
    """The lasting line or lines for an event, None when it has none. step(at): what to do for that
    placement of a plan."""
    said = planned(event, step) if step else None
    if said is not None:
        return said
    make = WORDS.get(event["event"])
    return make(event) if make else None


def lasting(event, step=None):
    """The lasting lines for a checked event, escaped."""
    text = words(event, step)
    return [] if text is None else [plain(line) for line in text.split("\n")]
