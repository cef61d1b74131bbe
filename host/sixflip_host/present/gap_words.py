"""The answer for people: the sentence of gap_sentence.py, then tables."""
from ..calibrate import term_words
from ..terminal import console, plain, styled, table
from . import simulator_words
from .gap_sentence import SENSOR, ends_at, in_units, sentence

STYLE = {"no gap": "bold green", "explained": "bold green", "partly explained": "bold yellow",
         "unexplained": "bold red", "cannot tell": "bold yellow"}
WHICH = ("effect", "sensor", "probability", "share", "size (90 % interval)")
UNKNOWN = 10.0  # times its lower end, that an interval reaches to which has no upper one
SUREST = 0.99  # the most that is said of a probability: the model is no surer of itself


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
    if ends_at(c, "below_range"):
        name += " (below the range)"
    elif ends_at(c, "level"):
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


def _level(c):
    """Sizes in units, where counts are the import's."""
    levels, unit = in_units(c) or ({}, "")
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
