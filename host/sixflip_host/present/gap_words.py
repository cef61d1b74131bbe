"""The answer for people: the verdict in one sentence, then tables."""
from ..calibrate import term_words
from ..diagnosis.detect.line_wander import digits
from ..experiment.terms import DOMAIN
from ..terminal import console, plain, styled, table
from . import simulator_words

SENSOR = {"accel": "accelerometer", "gyro": "gyro", "device": "device",
          "gyro_turns": "gyro in motion", "accel_motion": "accelerometer in motion"}
STYLE = {"no gap": "bold green", "explained": "bold green", "partly explained": "bold yellow",
         "unexplained": "bold red", "cannot tell": "bold yellow"}
WHICH = ("effect", "sensor", "probability", "share", "size (90 % interval)")
UNKNOWN = 10.0  # times its lower end, that an interval reaches to which has no upper one
SUREST = 0.99  # the most that is said of a probability: the model is no surer of itself
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
        return ("This capture cannot tell: it shows no gap, but most effects would not show in "
                "it either.")
    first = " ".join(_clause(c) for c in causes[:2])
    closed = _closed(answer)
    if verdict == "cannot tell":
        unknown = "which" if any(len(c["class"]) > 1 for c in causes[:2]) else \
            "whether that is so" if closed else "how much of the gap goes with that"
        return ("%s This capture cannot tell %s. %s" % (first, unknown, closed)).strip()
    if verdict == "partly explained":
        return first + " " + closed + " Something else is left that the library does not explain."
    return (first + " " + closed).strip()


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
    if _ends_at(cause, "below_range"):
        return "is cut off below its range"
    if _ends_at(cause, "level"):
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


def _ends_at(cause, limit):
    """True when readings of an axis are cut off at such a limit ("cut_off_at" of the answer)."""
    return limit in cause.get("cut_off_at", {}).values()


def _size(cause):
    """The largest size, in units where a log's counts are not its chip's."""
    sizes, unit = _in_units(cause) or (cause["value"], cause["unit"])
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


def show(answer):
    """Print everything."""
    screen = console()
    screen.print(styled(plain(sentence(answer)), STYLE[answer["verdict"]]))
    for remark in answer["remarks"]:
        screen.print(plain("  " + remark))
    if "simulator" in answer:
        simulator_words.show(screen, answer["simulator"])
    if answer["where"]:
        screen.print(table("Where", ("sensor", "axis", "domain", "share", "p"), [
            (SENSOR[w["sensor"]], w["axis"] or "-", w["domain"].replace("_", " "),
             "%.0f %%" % (100 * w["share"]), chance(w["p"])) for w in answer["where"][:12]]))
    if answer["causes"]:
        screen.print(table("Which", WHICH, [row(c) for c in answer["causes"]], prose=True))
    for kind, gap in answer["gap"].items():
        screen.print(plain(holdout_line(kind, gap, answer["held_out"])))
        if "axes" in gap:
            screen.print(plain("  " + axes_line(gap)))
    for kind, loop in answer.get("simulated", {}).items():
        screen.print(plain(loop_line(kind, loop)))
    for sensor, noise in answer["noise"].items():
        for line in noise_lines(sensor, noise):
            screen.print(plain(line))
    _rest(screen, answer)
    if "terms" in answer:
        show_terms(screen, answer["terms"])


def chance(p):
    """A probability; far below what any of its assumptions holds to, only that it is small."""
    return "%.1g" % p if p >= 1e-6 else "< 1e-6"


def percent(p):
    """A probability in words: never more sure than the model is of itself."""
    if p > SUREST:
        return "> %.0f %%" % (100.0 * SUREST)
    return "%.0f %%" % (100.0 * p) if p >= 0.005 else "< 1 %"


def row(c):
    """Effect, sensor, probability, share and every size with its interval, as text."""
    name = c["effect"] or " or ".join("%s %s" % (effect, percent(p)) for effect, p in
                                      c["class_probabilities"].items())
    if _ends_at(c, "below_range"):
        name += " (below the range)"
    elif _ends_at(c, "level"):
        name += " (levels off)"
    if not c["plausible"]:
        name += " (numerically helpful, physically implausible)"
    sizes, form = [], "%.5g" if c["unit"] == "counts" else "%.3g"  # of 16 bits every count
    for key, value in c["value"].items():
        low, high = c["interval_90"].get(key, [None, None])
        span = "" if low is None or low == high else " (%s … %s)" % (form % low, form % high)
        if c["effect"] == "dead_band" and span and high > UNKNOWN * low:
            span = " or more"
        sizes.append("%s %s%s" % (key, "not determined" if value is None else form % value,
                                  span))
    return (name, SENSOR[c["sensor"]], percent(c["probability"]),
            "-" if c["share"] is None else "%.0f %%" % (100 * c["share"]),
            ", ".join(sizes) + " " + c["unit"] + _level(c))


def _in_units(c):
    """({axis: size}, unit) of an imported log, whose counts are the import's; None of others."""
    return next(((c[key], c[unit]) for key, unit in (
        ("cut_off_level", "cut_off_unit"), ("value_in", "value_in_unit")) if key in c), None)


def _level(c):
    """Sizes in units, where counts are the import's."""
    levels, unit = _in_units(c) or ({}, "")
    said = ", ".join("%s %.4g" % level for level in levels.items())
    return " (%s %s)" % (said, unit) if said else ""


def holdout_line(kind, gap, held):
    """How far the gap of a sensor shrinks on what is held out, in a sentence."""
    text = "How far, %s (%s): %.3g %s before" % (SENSOR[kind], held, gap["before"], gap["unit"])
    if gap["explained_share"] is None:
        return text + ", noise alone %.3g." % gap["floor"]
    text += ", %.3g after, noise alone %.3g" % (gap["after"], gap["floor"])
    low, high = gap["interval_90"] or (None, None)
    if low is None:
        return text + "; gap too small to measure."
    return text + "; %.0f %% of what can be explained (90 %%: %.0f to %.0f)." % (
        100 * gap["explained_share"], 100 * low, 100 * high)


def axes_line(gap):
    """Before, after and noise of each axis."""
    return "; ".join("%s %.3g -> %.3g, noise %.3g" % (
        key.upper(), one["before"], one["after"], one["floor"])
        for key, one in gap["axes"].items()) + " " + gap["unit"]


def loop_line(kind, loop):
    """The simulator run again, in a sentence."""
    return ("Simulated again with %s: real less simulated %.3g %s before, %.3g after, noise in "
            "it %.3g (%s)." % (", ".join(sorted({e["effect"] for e in loop["effects"]})),
                                 loop["before"], loop["unit"], loop["after"], loop["floor"],
                                 SENSOR[kind]))


def noise_lines(sensor, noise):
    """What a sensor reads at rest and how it is noisy, a line each."""
    unit = noise["unit"]
    names = [("bias", "bias", unit), ("density", "noise density N, of which a data sheet's "
                                    "one-sided density is 1.41 times", unit + "/√Hz"),
             ("instability", "bias instability", unit), ("walk", "random walk", unit + "/s/√Hz")]
    lines = ["At rest, %s, %.3g s:" % (SENSOR[sensor], noise["seconds"])]
    for key, words, of in names:
        if key not in noise:
            continue
        spans = noise.get(key + "_interval_90", {})
        lines.append("  %s, %s: %s" % (words, of, ", ".join(
            "%s %.3g%s" % (axis.upper(), value, " (%.3g … %.3g)" % tuple(spans[axis])
                           if axis in spans else "") for axis, value in noise[key].items())))
    return lines


def _rest(screen, answer):
    if answer["unseen"]:
        screen.print("Could not be seen:")
        for u in answer["unseen"]:
            screen.print(plain("  %s (%s): %s" % (u["effect"], SENSOR[u["sensor"]], u["reason"])))
    if answer["next"]:
        screen.print("To capture next:")
        for n in answer["next"]:
            screen.print(plain("  %s (%.0f minutes): tells %s" % (
                n["capture"], n["minutes"], ", ".join(" from ".join(p) for p in n["resolves"]))))


def show_terms(screen, result):
    """Print what correction_terms.answer() holds."""
    for term in result["found"]:
        for line in term_words.lines(term):
            screen.print(plain("Into the record: " + line))
    for left in result["left_out"]:
        screen.print(plain("Not into the record: %s (%s): %s" % (
            " or ".join(left["effects"]), left["sensor"], left["reason"])))
    if result["written"]:
        screen.print(plain("%s: sixflip restore --from it puts it onto the board"
                           % result["written"]))
