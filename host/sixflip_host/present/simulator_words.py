"""The comparison with a user's own simulator for people: conventions, parameters, task."""
from ..terminal import plain, table

CONVENTIONS = ("convention", "sensor", "sure", "what to set")
PARAMETERS = ("parameter", "real by itself", "simulator by itself",
              "real less simulator, of both logs (90 %)", "set to")
EFFECTS = ("effect that it lacks", "sensor", "real less simulator (90 %)", "may as well be")
# Times the interval of the difference, from which on a log by itself says nothing of a number: two
# that are as sure as each other are 1.4 times as sure as their difference.
SAYS_NOTHING = 4.0
SENSOR = {"accel": "accelerometer", "gyro": "gyro", "device": "device"}


def sentence(answer, effects):
    """The first line; effects: function of the answer to the sentence of its effects' layer."""
    conventions = answer["simulator"]["conventions"]
    numbers = differing(answer["simulator"])
    if not conventions and not numbers:
        if answer["verdict"] == "no gap":
            return ("No gap: the simulator says what the real sensor says, as far as these logs "
                    "can show.")
        return effects(answer)
    parts = []
    if conventions:
        parts.append(" ".join(capital(c["words"]) + "." for c in conventions[:2]))
        if len(conventions) > 2:
            parts.append("%d conventions more are in the table." % (len(conventions) - 2))
    if numbers:
        names = list(dict.fromkeys("%s of the %s" % (name.replace("_", " "), SENSOR[sensor])
                                   for sensor, name, _, _ in numbers))
        parts.append("It has other numbers than the real sensor: %s%s." % (
            ", ".join(names[:4]), " and %d more" % (len(names) - 4) if len(names) > 4 else ""))
    if answer["verdict"] in ("unexplained", "partly explained"):
        parts.append("Something else is left that nothing here explains.")
    if answer.get("untold"):
        parts.append("To find out, record %s." % answer["untold"]["record"])
    return " ".join(parts)


def capital(text):
    """The text with its first letter as a capital."""
    return text[:1].upper() + text[1:]


def differing(simulator):
    """[(sensor, name, axis, parameter)] of those that differ."""
    return [(sensor, name, axis, p) for sensor, named in simulator["parameters"].items()
            for name, axes in named.items() for axis, p in axes.items() if p["differs"]]


def show(screen, simulator):
    """Print the layers."""
    for log in simulator["logs"]:
        for remark in log["remarks"]:
            screen.print(plain("  " + remark))
    if simulator["conventions"]:
        screen.print(table("Conventions", CONVENTIONS, convention_rows(simulator), prose=True))
    rows = parameter_rows(simulator)
    if rows:
        screen.print(table("Parameters that differ", PARAMETERS, rows, prose=True))
    rows = effect_rows(simulator)
    if rows:
        screen.print(table("Effects by both logs", EFFECTS, rows, prose=True))
    for line in lines(simulator):
        screen.print(plain(line))


def lines(simulator):
    """The task, the gap and what was not seen, a sentence each."""
    said = []
    for kind, gap in simulator["gap"].items():
        said.append("Simulator less real, %s: %.3g %s before, %.3g with conventions and "
                    "parameters put right (held out), noise alone %s." % (
                        SENSOR[kind], gap["before"], gap["unit"], gap["after"],
                        "%.3g" % gap["floor"] if gap["floor"] else "is not known"))
    task = simulator["task"]
    if task:
        said.append("Task (%s against %s): roll and pitch %.2f° before, %.2f° after; heading "
                    "%.2f° before, %.2f° after." % (
                        task["estimator"], task["against"], task["attitude"]["before"],
                        task["attitude"]["after"], task["heading"]["before"],
                        task["heading"]["after"]))
    said += ["Not seen: %s." % effects for effects in simulator["unseen"]]
    return said


def convention_rows(simulator):
    """Rows of CONVENTIONS."""
    several = len(simulator["logs"]) > 1
    return [(c["words"].replace("the simulator's ", "").replace("the simulator ", "")
             + (" (%s)" % c["log"] if several else ""), SENSOR[c["sensor"]],
             "%.1f %%" % (100.0 * min(c["probability"], 0.999)), c["set"])
            for c in simulator["conventions"]]


def parameter_rows(simulator, all_of_them=False):
    """Rows of PARAMETERS; those that differ, or all."""
    rows = []
    for sensor, named in simulator["parameters"].items():
        for name, axes in named.items():
            for axis, p in axes.items():
                if not (p["differs"] or all_of_them):
                    continue
                label = "%s%s, %s" % (name.replace("_", " "), "" if axis == "all" else " " + axis,
                                      SENSOR[sensor])
                simulated = owned(p["simulator"], p["simulator_interval_90"], p)
                rows.append((label, owned(p["real"], p["real_interval_90"], p), simulated,
                             valued(p["difference"], p["difference_interval_90"], p["unit"]),
                             wanted(p, simulated)))
    return rows


def wanted(parameter, simulated):
    """What to set; where the log does not show what it has, by how much to change it."""
    if parameter["set"] is None:
        return parameter["how"]
    value = "%.4g %s" % (parameter["set"], parameter["unit"])
    unknown = simulated == "-" and parameter["set"] == parameter["difference"]
    return value + " more than it has" if unknown else value


def effect_rows(simulator):
    """Rows of EFFECTS."""
    return [(e["effect"].replace("_", " "), SENSOR[e["sensor"]], ", ".join(
                 "%s %s" % (key, valued(value, e["interval_90"][key], e["unit"]))
                 for key, value in e["value"].items()),
             ", ".join(n.replace("_", " ") for n in e["class"] if n != e["effect"]))
            for e in simulator["effects"]]


def settings(simulator):
    """[(setting, value)] of all that is to be set."""
    pairs = [(c["words"], c["set"]) for c in simulator["conventions"] if c["set"]]
    return pairs + [(row[0], row[4]) for row in parameter_rows(simulator) if row[4]]


def owned(value, interval, parameter):
    """What one log says by itself, or - where that is nothing: an interval that is far wider than
    that of the difference of both logs and about zero, as of a bias in one attitude, or that is
    refuted by it, as where an effect passes for a scale in one log."""
    apart = parameter["difference_interval_90"]
    if value is not None and interval is not None and apart is not None and (
            interval[0] < 0.0 < interval[1] or refuted(parameter)) and (
            interval[1] - interval[0] > SAYS_NOTHING * (apart[1] - apart[0])):
        return "-"
    return valued(value, interval, "")


def refuted(parameter):
    """Whether what each log says by itself differs otherwise than both logs together do."""
    ends = [parameter[key] for key in ("real_interval_90", "simulator_interval_90")]
    if None in ends:
        return False
    (a, b), (c, d) = ends
    off = (a + b) / 2.0 - (c + d) / 2.0 - parameter["difference"]
    return abs(off) > ((b - a) ** 2 + (d - c) ** 2) ** 0.5 / 2.0


def valued(value, interval, unit):
    """A value with its interval and unit, or - for nothing."""
    if value is None:
        return "-"
    text = "%.3g" % value
    if interval is not None:
        text += " (%.3g … %.3g)" % tuple(interval)
    return (text + " " + unit).strip()
