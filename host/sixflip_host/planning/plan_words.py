"""The answer of `sixflip plan` for a person."""
import shutil
import textwrap

from ..terminal import console, plain, styled

TITLES = (("accel", "Accelerometer"), ("gyro", "Gyro"), ("device", "Device"))
NARROWEST = 80


def show(answer):
    """Print the three parts: what is there, what each effect's chances are, what to add."""
    out = console()
    width = max(NARROWEST, min(140, shutil.get_terminal_size((100, 24)).columns))
    out.print(textwrap.fill(overview(answer), width))
    for sensor, title in TITLES:
        effects = [e for e in answer["effects"] if e["sensor"] == sensor]
        if effects:
            out.print("\n%-24s %9s %8s  %-19s %s" % (
                title, "seen from", "typical", "unit", "cannot be told from (alias index)"))
        for effect in effects:
            effect_lines(out, effect, width)
    out.print("\nWhat to add, by what it resolves per minute:")
    for addition in answer["additions"]:
        addition_lines(out, addition, width)
    if not answer["additions"]:
        out.print("  nothing on the list of additions would resolve more")


def overview(answer):
    accel = answer["accel"]
    sessions = len(answer["sessions"])
    return ("%s: %d placements in %d session%s (%s), %.1f minutes, %s, box %s. %d accelerometer "
            "equations leave %d residual degrees of freedom; %d contrasts between faces say "
            "something about the sensor." % (
                plain(answer["protocol"]), answer["placements"], sessions,
                "" if sessions == 1 else "s", plain(", ".join(answer["sessions"])),
                answer["minutes"], answer["sensor"],
                "certified" if answer["certified_box"] else "not certified",
                accel["equations"], accel["residual"], accel["even_contrasts"]))


def effect_lines(out, effect, width):
    """Name, smallest and typical size, unit, and in as many lines as needed what it is
    confused with; green where the typical size would be seen."""
    words = ", ".join("%s %.2f" % (name, index) for name, index in effect["class"].items())
    if effect["silent"]:
        seen, style = "silent", "red"
        words = "absorbed by " + effect["absorbed_by"] + ("; " + words if words else "")
    else:
        seen = "%.2g" % effect["smallest"]
        style = "green" if effect["seen_at_typical_size"] else "yellow"
        words = words or effect["how"] or ""
    typical = "" if effect["typical"] is None else "%.3g" % effect["typical"]
    indent = 64
    lines = textwrap.wrap(words, width - indent) or [""]
    out.print("  %-22s" % effect["effect"], styled("%9s" % seen, style),
              "%8s  %-19s" % (typical, effect["unit"]), lines[0])
    for line in lines[1:]:
        out.print(" " * (indent - 1), line)


def addition_lines(out, addition, width):
    words = []
    for text, items in (("apart: ", ["%s %s|%s" % tuple(p) for p in addition["tells_apart"]]),
                        ("no longer silent: ", [" ".join(s) for s in
                                                addition["no_longer_silent"]]),
                        ("typical size seen: ", [" ".join(s) for s in
                                                 addition["typical_size_reached"]])):
        if items:
            words.append(text + ", ".join(items))
    out.print("  %s: %.1f minutes, resolves %.2g per minute" % (
        addition["add"], addition["minutes"], addition["per_minute"]))
    out.print(textwrap.fill("; ".join(words), width, initial_indent="      ",
                            subsequent_indent="      "))
