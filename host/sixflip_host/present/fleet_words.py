"""What sixflip fleet says in a terminal: the batch first, then who stands out, then failures."""
import os

from ..terminal import console, plain, styled, table

MOST_ROWS = 20  # of a table in a terminal; fleet.json and the page have all of them
SAYS = {"batch": "systematic", "individual": "individual", "both": "both", "neither": "-"}


def show(answer, output, page):
    """found: the answer; output: folder; page: name of the page in it, or nothing."""
    screen = console()
    for remark in answer["remarks"]:
        screen.print(plain(remark))
    for group in answer["groups"]:
        _group(screen, group)
    if answer["failures"]:
        rows = [[one["board"], one["why"]] for one in answer["failures"]]
        screen.print(table("left out (%d)" % len(rows), ["board", "why"], rows, prose=True))
    screen.print(plain("%s%s" % (os.path.join(output, "fleet.json"),
                                 ", " + os.path.join(output, page) if page else "")))


def cannot_express(missing):
    """What each form of the randomisation leaves out: {file: [effect]}."""
    for name, effects in missing.items():
        if effects:
            console().print(plain("%s cannot express: %s" % (name, ", ".join(effects))))


def kind_of(group):
    """Chip and ranges in words."""
    words = [group["chip"]]
    for key, form in (("accel_range_g", "±%g g"), ("gyro_range_dps", "±%g °/s")):
        if group[key] is not None:
            words.append(form % group[key])
    return " ".join(words)


def _group(screen, group):
    screen.print(styled(plain("%s: %d board%s" % (
        kind_of(group), group["boards"], "" if group["boards"] == 1 else "s")), "bold"))
    for batch in group["batches"]:
        name = "batch %s, " % batch["batch"] if batch["batch"] else ""
        if not batch["parameters"]:
            screen.print(plain("%stoo few boards for a population: %d, expected three at least" % (
                name, batch["boards"])))
            continue
        rows = [[p["name"], number(p["mean"]) + " ± " + number(p["error"]), number(p["spread"]),
                 p["unit"], word(p)] for p in batch["parameters"] if told(p)]
        screen.print(table("%s%d boards: mean, and spread between boards" % (
            name, batch["boards"]), ["parameter", "mean", "spread", "", "it is"], rows))
        loud = {p["name"].rpartition(".")[0] for p in batch["parameters"] if told(p)}
        quiet = dict.fromkeys(p["name"].rpartition(".")[0] for p in batch["parameters"]
                              if p["name"].rpartition(".")[0] not in loud)
        if quiet:
            screen.print(plain("no sign of: %s (sizes and limits are in fleet.json)" % ", ".join(
                "%s (%s)" % tuple(reversed(name.split("."))) for name in quiet)))
        outliers(screen, batch)
    if group["unseen"]:
        screen.print(plain("these captures cannot show: " + ", ".join(group["unseen"])))
    if group["lots"]:
        screen.print(table("batches that differ from the others", ["batch", "parameter", "by"], [
            [one["batch"], one["parameter"], "%s ± %s" % (
                number(one["difference"]), number(one["error"]))]
            for one in group["lots"][:MOST_ROWS]]))


def told(p):
    """Whether a parameter has a row: all of the calibration, an effect where there is one."""
    return p["kind"] != "neither" or "." not in p["name"]


def outliers(screen, batch):
    """The boards that stand out, each with its reason."""
    its = batch["outliers"]
    if not its:
        return
    rows = [[one["board"], reason(one)] for one in its[:MOST_ROWS]]
    more = "" if len(its) <= MOST_ROWS else ", the first %d of %d" % (MOST_ROWS, len(its))
    screen.print(table("boards that stand out (beyond %.1f sigma%s)" % (
        batch["cutoff_sigmas"], more), ["board", "why"], rows, prose=True))


def reason(outlier):
    """The sentence on an outlier."""
    if outlier["why"] == "drifted":
        return "%s moved by %s against its own history, %.1f sigma" % (
            outlier["parameter"], number(outlier["value"]), abs(outlier["sigmas"]))
    return "%s is %s, the batch has %s ± %s: %.1f sigma" % (
        outlier["parameter"], number(outlier["value"]), number(outlier["mean"]),
        number(outlier["sigma"]), abs(outlier["sigmas"]))


def word(p):
    """What a parameter is, in a word; the names it may have as well."""
    said = SAYS[p["kind"]]
    if p["kind"] == "both":
        said = "systematic, and individual" if p["common_share"] >= 0.5 else \
            "individual, and systematic"
    return said + (" (or %s)" % ", ".join(p["aliases"]) if p.get("aliases") else "")


def number(value):
    """Four digits, or - for nothing."""
    return "-" if value is None else "%.4g" % value
