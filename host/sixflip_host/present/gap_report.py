"""What a diagnosis leaves in files: a page that needs nothing else, its pictures, and its checks
for JUnit."""
from pathlib import Path
from xml.sax.saxutils import quoteattr

from .. import atomic_write
from ..capture.registers import SENSORS
from ..errors import UsageError
from . import gap_pictures, gap_sentence, gap_words, simulator_report
from .page import Page

PAGE = "index.html"
PICTURES = ("where", "residuals_accel", "residuals_gyro", "poses_accel", "poses_gyro", "noise",
            "alias", "simulator_traces", "simulator_spectra")


def write(folder, diagnosis, answer, loops):
    """Write index.html and the PNGs into a folder, made if it is not there."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError("--report %s: %s" % (folder, error.strerror)) from None
    drawn = draw(folder, diagnosis, loops)
    atomic_write.write_text(str(folder / PAGE), page(answer, drawn))


def draw(folder, diagnosis, loops):
    """[(caption, path of the PNG)]"""
    pictures = []

    def picture(name, caption, function, *args):
        path = folder / (name + ".png")
        if function(*args, str(path)) is not False:
            pictures.append((caption, path))

    compared = next((x for x in diagnosis.comparisons if x.fits), None)
    if compared is not None:
        picture("simulator_traces", "Real, simulated, and simulated with what was found",
                simulator_report.traces, compared)
        picture("simulator_spectra", "What is left, by frequency", simulator_report.spectra,
                compared)
    picture("where", "Where the gap lies", gap_pictures.heat_map, diagnosis)
    for kind, gap in diagnosis.gaps.items():
        title = SENSORS[kind]
        picture("residuals_" + kind, "Residuals of the %s before and after" % title,
                gap_pictures.residuals, gap)
        picture("poses_" + kind, "Residuals of the %s by placement" % title,
                gap_pictures.poses, gap)
    if diagnosis.sessions[0].n:
        picture("noise", "Spectrum and Allan deviation", gap_pictures.noise, diagnosis, loops)
    if diagnosis.gaps:
        picture("alias", "What could be taken for what", gap_pictures.alias_matrix, diagnosis)
    return pictures


def page(answer, drawn):
    """The HTML, pictures included."""
    html = Page("Gap", gap_sentence.sentence(answer))
    sections(html, answer, [(caption, path.read_bytes()) for caption, path in drawn])
    return html.html()


def sections(page, answer, drawn):
    """What the answer holds, behind its sentence; drawn: [(caption, bytes of a PNG)]"""
    for remark in answer["remarks"]:
        page.paragraph(remark, note=True)
    if "simulator" in answer:
        simulator_report.sections(page, answer["simulator"])
    if answer["causes"]:
        page.heading("Which effect")
        page.table(gap_words.WHICH, [gap_words.row(c) for c in answer["causes"]])
    lines = [gap_words.holdout_line(k, g, answer["held_out"]) for k, g in answer["gap"].items()]
    lines += [gap_words.loop_line(k, g) for k, g in answer.get("simulated", {}).items()]
    if lines:
        page.heading("How far")
        for line in lines:
            page.paragraph(line)
    for caption, png in drawn:
        page.picture(caption, png)
    if answer["next"]:
        page.heading("To capture next")
        page.table(("capture", "minutes", "tells apart"),
                   [(n["capture"], "%.0f" % n["minutes"],
                     ", ".join(" / ".join(p) for p in n["resolves"])) for n in answer["next"]])
    if answer["unseen"]:
        page.heading("What could not be seen")
        page.table(("effect", "sensor", "why"), [
            (u["effect"], gap_sentence.SENSOR[u["sensor"]], u["reason"])
            for u in answer["unseen"]])


def write_junit(path, checks):
    """Write the checks of a diagnosis as a JUnit file; checks: {name: failure or ""}."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>',
             '<testsuite name="sixflip diagnose" tests="%d" failures="%d">'
             % (len(checks), sum(bool(f) for f in checks.values()))]
    for name, failure in checks.items():
        lines.append("  <testcase classname=\"sixflip.diagnose\" name=%s%s" % (
            quoteattr(name), "/>" if not failure else "><failure message=%s/></testcase>"
            % quoteattr(failure)))
    lines.append("</testsuite>\n")
    atomic_write.write_bytes(path, "\n".join(lines).encode())
