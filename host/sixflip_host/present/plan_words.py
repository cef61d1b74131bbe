"""The answer of `sixflip plan` for a person."""
from ..terminal import console, plain, styled, table

TITLES = (("accel", "Accelerometer"), ("gyro", "Gyro"), ("device", "Device"))
UNIT = {"accel": "mg", "gyro": "°/s"}
NAME = {"accel": "accelerometer", "gyro": "gyro", "device": "device"}


def show(answer):
    """Print what can be told, what cannot and what to add in three lines; then what is there,
    each effect's chances and every addition."""
    screen = console()
    for line in (can_tell(answer), cannot_tell(answer), add_this(answer)):
        screen.print(plain(line))
    screen.print()
    screen.print(overview(answer))
    for sensor, title in TITLES:
        effects = [e for e in answer["effects"] if e["sensor"] == sensor]
        if effects:
            screen.print(table(title, ("effect", "seen from", "typical", "unit", "remark"),
                               [effect_row(effect) for effect in effects], prose=True))
    screen.print("What to add, by what it resolves per minute:")
    for addition in answer["additions"]:
        addition_lines(screen, addition)
    if not answer["additions"]:
        screen.print("  nothing on the list of additions would resolve more")


def can_tell(answer):
    """What would be seen at its typical size and called by its own name."""
    return "Can tell: %s." % named(_pairs(answer, True))


def cannot_tell(answer):
    """All the others: at their typical size they leave no trace, or another one leaves it too."""
    return "Cannot tell: %s." % named(_pairs(answer, False))


def _pairs(answer, told):
    return [(e["sensor"], e["effect"]) for e in answer["effects"]
            if told == (e["seen_at_typical_size"] and not e["class"])]


def named(pairs):
    """(sensor, effect) pairs by sensor: "accelerometer thermal_bias, cubic; gyro cubic"."""
    said = []
    for sensor, _ in TITLES:
        names = [name for kind, name in pairs if kind == sensor]
        if names:
            said.append("%s %s" % (NAME[sensor], ", ".join(names)))
    return "; ".join(said) or "nothing"


def add_this(answer):
    """The addition that resolves most per minute."""
    if not answer["additions"]:
        return "Add this: nothing on the list would resolve more."
    first = answer["additions"][0]
    return "Add this: %s (%s), which %s." % (first["add"], minutes(first), resolved(first))


def minutes(addition):
    """How much longer an addition makes the capture."""
    return "no more time" if addition["minutes"] < 0.05 else "%.1f minutes" % addition["minutes"]


def resolved(addition):
    """What an addition makes visible, in a clause."""
    apart = {}
    for sensor, effect, other in addition["tells_apart"]:
        apart.setdefault((sensor, effect), []).append(other)
    said = [] if not apart else ["tells " + "; ".join(
        "%s %s from %s" % (NAME[sensor], one, ", ".join(others))
        for (sensor, one), others in apart.items())]
    for words, pairs in (("shows", addition["no_longer_silent"]),
                         ("shows at its typical size", addition["typical_size_reached"])):
        if pairs:
            said.append("%s %s" % (words, named(pairs)))
    return "; ".join(said)


def overview(answer):
    """The protocol in a paragraph: placements, sessions, time, equations, noise."""
    accel = answer["accel"]
    sessions = len(answer["sessions"])
    return ("%s: %d placements in %d session%s (%s), %.1f minutes, %s, box %s. %d accelerometer "
            "equations leave %d residual degrees of freedom; %d contrasts between faces say "
            "something about the sensor. Noise of a sample: %s, %g a second. Alike: does more "
            "than 0.9 of the same (alias index)." % (
                plain(answer["protocol"]), answer["placements"], sessions,
                "" if sessions == 1 else "s", plain(", ".join(answer["sessions"])),
                answer["minutes"], answer["sensor"],
                "certified" if answer["certified_box"] else "not certified",
                accel["equations"], accel["residual"], accel["even_contrasts"],
                " and ".join("%.2g %s" % (max(sigma), UNIT[kind])
                             for kind, sigma in answer["noise"].items()), answer["rate_hz"]))


def effect_row(effect):
    """Name, smallest and typical size, unit and what it is confused with; green where the
    typical size would be seen."""
    words = ", ".join("%s %.2f" % (name, index) for name, index in effect["class"].items())
    words = words and "alike: " + words
    if effect["silent"]:
        seen, style = "silent", "red"
        why = effect["how"] or "absorbed by " + effect["absorbed_by"]
        words = why + ("; " + words if words else "")
    else:
        seen = "%.2g" % effect["smallest"]
        style = "green" if effect["seen_at_typical_size"] else "yellow"
        words = words or effect["how"] or ""
    typical = "" if effect["typical"] is None else "%.3g" % effect["typical"]
    return effect["effect"], styled(seen, style), typical, effect["unit"], words


def addition_lines(screen, addition):
    """Print an addition: its price, and below it what it resolves."""
    screen.print(plain("  %s: %s, resolves %.2g per minute" % (
        addition["add"], minutes(addition), addition["per_minute"])))
    screen.print(plain("    " + resolved(addition)))
