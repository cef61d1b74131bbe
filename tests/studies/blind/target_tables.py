"""The printed result of a blind run: GAP.md's targets with what was reached, and tables."""

from collections import Counter, defaultdict

from . import reliability
from .reliability import table
from .statsmath import above, wilson

NAMEABLE = ("single", "power", "share", "stranger", "held out")
SHOWN = ("unexplained", "partly explained")
UNSEEN = ("silent", "faint", "other form")  # see scoring.expected


class Rows:
    """A table of targets: name, target, reached, n, Wilson's interval, met or missed."""

    def __init__(self):
        self.rows = []

    def share(self, name, flags, target, at_least=True):
        """A share against a target (0..1); flags is a list of bool."""
        n, hits = len(flags), sum(map(bool, flags))
        if not n:
            self.rows.append((name, _target(target, at_least), "-", 0, "", "not run"))
            return
        low, high = wilson(hits, n)
        met = hits / n >= target if at_least else hits / n <= target
        could = high >= target if at_least else low <= target
        self.rows.append((name, _target(target, at_least), "%.1f %%" % (100 * hits / n), n,
                          "%.1f-%.1f" % (100 * low, 100 * high),
                          "met" if met else "within chance" if could else "MISSED"))

    def band(self, name, flags, low_target, high_target):
        n, hits = len(flags), sum(map(bool, flags))
        if not n:
            self.rows.append((name, "%d-%d %%" % (100 * low_target, 100 * high_target), "-", 0, "",
                              "not run"))
            return
        low, high = wilson(hits, n)
        met = low_target <= hits / n <= high_target
        could = low <= high_target and high >= low_target
        self.rows.append((name, "%d-%d %%" % (100 * low_target, 100 * high_target),
                          "%.1f %%" % (100 * hits / n), n, "%.1f-%.1f" % (100 * low, 100 * high),
                          "met" if met else "within chance" if could else "MISSED"))

    def number(self, name, target, reached, n, met):
        self.rows.append((name, target, reached, n, "", "met" if met else "MISSED"))

    def text(self):
        head = ("what", "target", "reached", "n", "95 % interval", "")
        return table(head, self.rows)


def _target(target, at_least):
    return "%s %g %%" % (">=" if at_least else "<=", 100 * target)


def alarm(result):
    """Whether a null was given a gap that is not there."""
    box_named = bool(result["named"]) and not result["false"]
    return bool(result["false"]) or (result["verdict"] in SHOWN + ("explained",)
                                     and not box_named)


def report(results):
    """(text, never): the whole printed result, and whether the run must fail."""
    answered = [r for r in results if r["verdict"] is not None]
    suites = defaultdict(list)
    for r in answered:
        suites[r["suite"]].append(r)
    rows = Rows()
    nulls = suites["null"]
    rows.share("false alarms, no effect", [alarm(r) for r in nulls], 0.05, at_least=False)
    rows.share("  of them recommended session", [alarm(r) for r in nulls
                                                 if r["protocol"] == "recommended"], 0.05, False)
    if any(r["noise_of"] for r in nulls):
        rows.share("  carried by recorded noise", [alarm(r) for r in nulls if r["noise_of"]],
                   0.05, False)
    _known(rows, suites["single"] + suites["power"] + suites["share"])
    violations = [(r, reason) for r in answered for reason in r["never"]]
    rows.number("single name in a silent or aliased class", "never", len(violations),
                len(answered), not violations)
    for suite in ("stranger", "held out"):
        here = [r for r in suites[suite] if r["effects"][0]["multiple"] < 1]
        rows.share("family not in the library (%s), 0.3x: not called explained" % suite,
                   [r["verdict"] != "explained" for r in here], 0.9)
        here = [r for r in suites[suite] if r["effects"][0]["multiple"] >= 1]
        rows.share("family not in the library (%s): said so" % suite,
                   [r["verdict"] in SHOWN for r in here], 0.9)
        rows.share("  and in the right domain",
                   [r["verdict"] in SHOWN and r["effects"][0]["domain_listed"] for r in here], 0.9)
    rows.share("effect left out of the library: not called explained",
               [r["verdict"] != "explained" or _alias_named(r) for r in suites["left out"]], 0.9)
    pairs = suites["pair"]
    rows.share("pairs: both classes", [all(e["class_right"] for e in r["effects"])
                                       for r in pairs], 0.95)
    rows.share("  both of them to be seen",
               [all(e["class_right"] for e in r["effects"]) for r in pairs
                if all(e["expected"] not in UNSEEN for e in r["effects"])], 0.95)
    if pairs:
        false = sum(len(r["false"]) for r in pairs) / len(pairs)
        rows.number("pairs: false classes a run", "<= 0.1", "%.2f" % false, len(pairs),
                    false <= 0.1)
    _shrinkage(rows, answered)
    rows.share("12 poses of the paper: no false name", [not r["single_false"] and not r["never"]
                                                       for r in suites["paper"]], 1.0)
    error, number = reliability.calibration_error(results)
    rows.number("stated probabilities: expected calibration error", "<= 0.05", "%.3f" % error,
                number, error <= 0.05)
    crashed = [r for r in results if r["verdict"] is None]
    rows.number("runs without an answer", "0 (but axis_swap refused)", len(crashed), len(results),
                all(any(t[0] == "axis_swap" for t in r["truth"]) for r in crashed))
    parts = ["Targets of GAP.md\n\n" + rows.text(), _by_effect(suites), _confusion(answered),
             reliability.table_of(answered), reliability.by_name_table(answered),
             _families(suites), _seconds(answered), _failures(results, violations)]
    too_many = above(sum(alarm(r) for r in nulls), len(nulls), 0.05)
    return "\n\n\n".join(p for p in parts if p), bool(violations) or too_many


def _alias_named(result):
    """A left-out effect answered by an alias the theory knows is right."""
    return result["effects"][0]["expected"] == "aliased"


def _known(rows, results):
    effects = [(r, e) for r in results for e in r["effects"]]
    for times, target in ((0.3, 0.95), (1.0, 0.99), (3.0, 0.99)):
        here = [e for r, e in effects if e["multiple"] == times and r["suite"] == "single"]
        rows.share("right class at %gx, all" % times,
                   [e["class_right"] for e in here if e["expected"] not in ("silent", "motion")],
                   target)
        rows.share("  alias index < 0.8 and above 5 sigma",
                   [e["class_right"] for e in here if e["expected"] == "clear"], target)
        rows.share("  in motion (lever arm, lag)",
                   [e["class_right"] for e in here if e["expected"] == "motion"], target)
        rows.share("  in counts, rows or times",
                   [e["class_right"] for e in here if e["expected"] == "integrity"], target)
    other = [(r, e) for r, e in effects if e["expected"] == "other form" and e["multiple"] >= 1]
    rows.share("quite another form or no column: named or not called explained",
               [e["class_right"] or r["verdict"] in SHOWN for r, e in other], 0.9)
    rows.share("right name, alias index < 0.8",
               [e["name_right"] for _, e in effects if e["expected"] == "clear"
                and e["multiple"] >= 1], 0.9)
    found = [e for _, e in effects if e["class_right"] and e["axes_true"]]
    rows.share("axis, where the class is right", [e["axes_right"] for e in found], 0.97)
    seen = [e for _, e in effects if e["expected"] in ("clear", "aliased", "integrity")
            and e["multiple"] >= 1]
    rows.share("domain listed, 1x and more", [e["domain_listed"] for e in seen], 0.95)
    rows.share("  and first in the list", [e["domain_first"] for e in seen], 0.95)


def _shrinkage(rows, results):
    shares = [r["share"] for r in results if r.get("share")]
    rows.band("share intervals hold the share, by the twin's floor",
              [low <= true <= high for true, low, high in shares], 0.86, 0.94)
    values = [i for r in results for e in r["effects"] for i in e["intervals"]]
    rows.band("value intervals hold the true value",
              [low <= true <= high for _, true, low, high in values], 0.86, 0.94)
    rows.share("0.9 of the explainable gap closed at 1x",
               [e["explained_share"] >= 0.9 for r in results if len(r["effects"]) == 1
                for e in r["effects"] if e["explained_share"] is not None and e["multiple"] == 1
                and (e["attainable"] or 0) > 0.95], 0.9)


def _by_effect(suites):
    rows = defaultdict(lambda: defaultdict(list))
    for r in suites["single"]:
        for e in r["effects"]:
            rows[e["effect"], e["sensor"]][e["multiple"]].append(e)
    if not rows:
        return ""
    out = []
    for (effect, sensor), sizes in sorted(rows.items()):
        line = [effect, sensor]
        for times in (0.3, 1.0, 3.0):
            here = sizes.get(times, [])
            line.append("%d/%d %s" % (sum(e["class_right"] for e in here), len(here),
                                      here[0]["expected"]) if here else "-")
        out.append(line)
    return "Right class by effect (right/cases, and what theory expects)\n\n" + table(
        ("effect", "sensor", "0.3x", "1x", "3x"), out)


def confusion(results):
    """{(true, named): n} over single effects of the suites NAMEABLE; "nothing" where no cause
    was named."""
    out = Counter()
    for r in results:
        if r["suite"] not in NAMEABLE:
            continue
        e = r["effects"][0]
        if e["class_right"]:
            named = e["effect"] if e["name_right"] else "class with it"
        elif r["named"]:
            named = r["named"][0][1] if "|" not in r["named"][0][1] else "class without it"
        else:
            named = "nothing" if r["verdict"] in ("no gap", "cannot tell") else "unexplained"
        out[e["effect"], named] += 1
    return out


def _confusion(results):
    counts = confusion(results)
    if not counts:
        return ""
    rows = []
    for true in sorted({t for t, _ in counts}):
        named = sorted(((n, c) for (t, n), c in counts.items() if t == true),
                       key=lambda x: (-x[1], x[0]))
        rows.append((true, sum(c for _, c in named),
                     ", ".join("%s %d" % (n, c) for n, c in named)))
    return "Confusion: what was there, what was named\n\n" + table(("true", "n", "named"), rows)


def _families(suites):
    rows = []
    groups = defaultdict(list)
    for suite in ("stranger", "held out", "left out", "paper"):
        for r in suites[suite]:
            groups[suite, r["truth"][0][0], r["truth"][0][1]].append(r)
    for key, here in groups.items():
        verdicts = Counter(r["verdict"] for r in here)
        named = Counter(n[1] for r in here for n in r["named"])
        rows.append((*key, ", ".join("%s %d" % x for x in verdicts.most_common()),
                     ", ".join("%s %d" % x for x in named.most_common(4))))
    return "Families outside the library, effects left out, the paper's 12 poses\n\n" + table(
        ("suite", "family", "sensor", "verdicts", "named"), rows) if rows else ""


def _seconds(results):
    times = sorted(r["cpu_s"] for r in results)
    if not times:
        return ""
    return "Processor seconds a diagnosis: median %.1f, 95 %% %.1f, most %.1f" % (
        times[len(times) // 2], times[int(0.95 * (len(times) - 1))], times[-1])


def _failures(results, violations):
    """The cases to look at, with what is needed to make them again."""
    lines = ["%s seed %d: %s; truth %s" % (r["id"], r["seed"], reason, _truth(r))
             for r, reason in violations]
    lines += ["%s seed %d %s %s %s: false alarm: %s %s" % (
        r["id"], r["seed"], r["chip"], r["protocol"], r["habits"], r["verdict"], r["named"])
        for r in results if r["suite"] == "null" and r["verdict"] and alarm(r)]
    lines += ["%s seed %d: named %s; truth %s" % (r["id"], r["seed"], r["false"], _truth(r))
              for r in results if r["suite"] not in ("null",) and r["false"]]
    lines += ["%s seed %d: no answer, code %s: %s; truth %s" % (
        r["id"], r["seed"], r["code"], r["error"], _truth(r))
        for r in results if r["verdict"] is None]
    return "To look at\n\n" + "\n".join(lines) if lines else ""


def _truth(result):
    return ", ".join("%s %s %gx" % tuple(t) for t in result["truth"]) or "nothing"
