"""The first sentence of an answer: the verdict, and what each of the likeliest causes does."""
from ..diagnosis.detect.line_wander import digits
from ..experiment.terms import DOMAIN
from . import simulator_words

SENSOR = {"accel": "accelerometer", "gyro": "gyro", "device": "device",
          "gyro_turns": "gyro in motion", "accel_motion": "accelerometer in motion"}
DOES = {  # what a part with this effect does
    "thermal_bias": "drifts with temperature", "thermal_scale": "changes its scale with "
    "temperature", "warm_up": "drifts after it is switched on", "thermal_rate": "follows how fast "
    "the temperature changes", "quadratic": "is bent (quadratic)", "cross_quadratic":
    "feels products of the other axes", "cubic": "is bent (cubic)", "asymmetry":
    "has different scales up and down", "g_sensitivity": "feels gravity", "drift":
    "wanders by itself", "quantisation": "counts in steps", "dead_band": "has a dead band",
    "saturation": "hits its limit", "vibration": "is shaken at a steady frequency",
    "vibration_rectification": "shifts when it is shaken", "hysteresis":
    "remembers the pose before", "creep": "creeps after each move", "box_tilt":
    "sits in a box whose faces are not square", "torn_reads": "mixes bytes of two readings",
    "axis_swap": "has its axes swapped or inverted", "sample_rate": "runs at another rate than "
    "it says", "dropped_samples": "loses samples", "supply": "follows the supply",
    "lever_arm": "sits off the point it is turned about", "filter_lag": "is behind the other "
    "sensor"}


def sentence(answer):
    """The first line."""
    if "simulator" in answer:
        return simulator_words.sentence(answer, _effects_sentence)
    return _effects_sentence(answer)


def _effects_sentence(answer):
    """The first line of the effects alone; what is damaged comes before everything."""
    damage = [one["words"] for one in answer["damage"]]
    first = "".join("The recording is damaged: %s. " % words for words in damage[:1])
    return first + _of_effects(answer)


def _of_effects(answer):
    causes = [c for c in answer["causes"] if c["plausible"]]
    verdict = answer["verdict"]
    if verdict == "no gap":
        return "No gap: the real sensor does what the nominal simulator does%s." % (
            ", as far as this capture can show" if answer["unseen"] else "")
    if verdict == "unexplained":
        return "There is a gap, but nothing in the library explains it%s." % _place(answer)
    if verdict == "cannot tell" and not causes:
        return "This capture cannot tell: %s.%s" % (answer["untold"]["why"], to_record(answer))
    first = " ".join(_clause(c) for c in causes[:2])
    closed = _closed(answer)
    if verdict == "cannot tell":
        unknown = "which" if any(len(c["class"]) > 1 for c in causes[:2]) else \
            "whether that is so" if closed else "how much of the gap goes with that"
        return ("%s This capture cannot tell %s. %s" % (first, unknown, closed)).strip() + (
            to_record(answer))
    if verdict == "partly explained":
        return first + " " + closed + " Something else is left that the library does not explain."
    return (first + " " + closed).strip()


def to_record(answer):
    """What to record to find out, a sentence behind others, or "" of a verdict that tells."""
    untold = answer.get("untold")
    return " To find out, record %s." % untold["record"] if untold else ""


def _place(answer):
    if not answer["where"]:
        return ""
    w = answer["where"][0]
    return ": look at %s%s of the %s" % (
        w["domain"].replace("_", " "), ", axis " + w["axis"] if w["axis"] else "",
        SENSOR[w["sensor"]])


def _clause(cause):
    axes = " and ".join(a.upper() for a in cause["axes"])
    who = "The %s%s" % (axes + " " if axes else "", SENSOR[cause["sensor"]])
    if cause["effect"]:
        return "%s %s%s." % (who, _does(cause), _size(cause))
    names = [n.replace("_", " ") for n in cause["class"]]
    if len({DOMAIN[n] for n in cause["class"]}) == 1:
        return "%s %s%s (%s)." % (who, DOES.get(cause["class"][0]), _size(cause),
                                  " or ".join(names))
    return "%s shows one of: %s." % (who, ", ".join(names))


def _does(cause):
    """What a part with this effect does; what shakes it has a frequency or has none; what cuts
    its readings off is the chip's limit or another one, or nobody knows which."""
    if ends_at(cause, "below_range"):
        return "is cut off below its range"
    if ends_at(cause, "level"):
        return "levels off"
    if cause["effect"] != "vibration":
        return DOES.get(cause["effect"], cause["effect"])
    if not cause.get("hz"):
        about = sorted({"%.3g" % line["hz"] for line in cause.get("lines", {}).values()})
        return "is shaken%s, at no steady frequency" % (
            " at about %s Hz" % " and ".join(about) if about else "")
    lines = {}
    for axis, hz in cause["hz"].items():
        known = cause.get("lines", {}).get(axis, {}).get("interval_90_hz", (hz, hz))
        lines.setdefault("%s Hz" % digits(hz, *known), []).append(axis.upper())
    other = [axis.upper() for axis in cause["axes"] if axis not in cause["hz"]]
    alone = len(lines) == 1 and not other
    return "is shaken at a steady frequency, " + ", ".join(
        hz + ("" if alone else " on " + " and ".join(axes)) for hz, axes in lines.items()) + (
        ", and at none on " + " and ".join(other) if other else "")


def ends_at(cause, limit):
    """True when readings of an axis are cut off at such a limit ("cut_off_at" of the answer)."""
    return limit in cause.get("cut_off_at", {}).values()


def _size(cause):
    """The largest size, in units where a log's counts are not its chip's."""
    sizes, unit = in_units(cause) or (cause["value"], cause["unit"])
    values = [v for v in sizes.values() if v is not None]
    if not values or unit in ("1", "axis"):
        return ""
    joined = " at " if _does(cause) == "levels off" else ", "
    return "%s%s%.3g %s" % (joined, "up to " if len(values) > 1 else "", max(values, key=abs),
                            unit)


def _closed(answer):
    parts = []
    for kind, gap in answer["gap"].items():
        if gap["explained_share"] is not None:
            parts.append("%.0f %% of the %s's gap" % (100 * max(0.0, gap["explained_share"]),
                                                      SENSOR[kind]))
    return "Adding that closes %s." % " and ".join(parts) if parts else ""


def in_units(c):
    """({axis: size}, unit) of an imported log, whose counts are the import's; None of others."""
    return next(((c[key], c[unit]) for key, unit in (
        ("cut_off_level", "cut_off_unit"), ("value_in", "value_in_unit")) if key in c), None)
