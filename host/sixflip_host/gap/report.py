"""The report: one page that needs nothing else, and its pictures."""
from pathlib import Path

from .. import atomic_write
from ..errors import UsageError
from ..reporting.page import Page
from . import pictures, words

PAGE = "index.html"
PICTURES = ("where", "residuals_accel", "residuals_gyro", "poses_accel", "poses_gyro", "noise",
            "alias")


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
    found = []

    def picture(name, caption, function, *args):
        path = folder / (name + ".png")
        if function(*args, str(path)) is not False:
            found.append((caption, path))

    picture("where", "Where the gap lies", pictures.heat_map, diagnosis)
    for kind, gap in diagnosis.gaps.items():
        title = pictures.NAME[kind]
        picture("residuals_" + kind, "Residuals of the %s before and after" % title,
                pictures.residuals, gap)
        picture("poses_" + kind, "Residuals of the %s by placement" % title, pictures.poses, gap)
    if diagnosis.sessions[0].n:
        picture("noise", "Spectrum and Allan deviation", pictures.noise, diagnosis, loops)
    if diagnosis.gaps:
        picture("alias", "What could be taken for what", pictures.alias_matrix, diagnosis)
    return found


def page(answer, drawn):
    """The HTML, pictures included."""
    out = Page("Gap", words.sentence(answer))
    sections(out, answer, [(caption, path.read_bytes()) for caption, path in drawn])
    return out.html()


def sections(page, answer, drawn):
    """What the answer holds, behind its sentence; drawn: [(caption, bytes of a PNG)]"""
    for remark in answer["remarks"]:
        page.paragraph(remark, note=True)
    if answer["causes"]:
        page.heading("Which effect")
        page.table(words.WHICH, [words.row(c) for c in answer["causes"]])
    lines = [words.shrinkage_line(k, g, answer["held_out"]) for k, g in answer["gap"].items()]
    lines += [words.loop_line(k, g) for k, g in answer.get("simulated", {}).items()]
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
            (u["effect"], words.SENSOR[u["sensor"]], u["reason"]) for u in answer["unseen"]])
