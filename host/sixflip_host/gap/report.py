"""The report: one page that needs nothing else, and its pictures."""
import base64
import html
from pathlib import Path

from .. import atomic_write
from ..errors import UsageError
from . import pictures, words

STYLE = """body{font:15px/1.45 system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;
color:#1b1b1b}h1{font-size:1.35em}h2{font-size:1.1em;margin-top:1.8em}table{border-collapse:
collapse}td,th{padding:.25em .7em;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}
img{max-width:100%}.note{color:#555}"""


def write(folder, diagnosis, answer, loops):
    """Write index.html and the PNGs into a folder, made if it is not there."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError("--report %s: %s" % (folder, error.strerror)) from None
    drawn = draw(folder, diagnosis, loops)
    atomic_write.write_text(str(folder / "index.html"), page(answer, drawn))


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
    parts = ["<!doctype html><html lang=en><meta charset=utf-8><title>Gap</title><style>%s"
             "</style>" % STYLE, "<h1>%s</h1>" % html.escape(words.sentence(answer))]
    parts += ["<p class=note>%s</p>" % html.escape(r) for r in answer["remarks"]]
    if answer["causes"]:
        rows = [words.row(c) for c in answer["causes"]]
        parts.append("<h2>Which effect</h2>" + table(
            ("effect", "sensor", "size (90 % interval)", "score, nats", "share"), rows))
    lines = [words.shrinkage_line(k, g, answer["held_out"]) for k, g in answer["gap"].items()]
    lines += [words.loop_line(k, g) for k, g in answer.get("simulated", {}).items()]
    if lines:
        parts.append("<h2>How far</h2>" + "".join("<p>%s</p>" % html.escape(x) for x in lines))
    for caption, path in drawn:
        data = base64.b64encode(path.read_bytes()).decode()
        parts.append("<h2>%s</h2><img alt=\"%s\" src=\"data:image/png;base64,%s\">" % (
            html.escape(caption), html.escape(caption), data))
    if answer["next"]:
        parts.append("<h2>To capture next</h2>" + table(
            ("capture", "minutes", "tells apart"),
            [(n["capture"], "%.0f" % n["minutes"], ", ".join(" / ".join(p)
                                                             for p in n["resolves"]))
             for n in answer["next"]]))
    if answer["unseen"]:
        parts.append("<h2>What could not be seen</h2>" + table(
            ("effect", "sensor", "why"),
            [(u["effect"], words.SENSOR[u["sensor"]], u["reason"]) for u in answer["unseen"]]))
    return "\n".join(parts) + "\n</html>\n"


def table(head, rows):
    """An HTML table of plain strings."""
    cells = "".join("<th>%s</th>" % html.escape(h) for h in head)
    body = "".join("<tr>%s</tr>" % "".join("<td>%s</td>" % html.escape(str(c)) for c in row)
                   for row in rows)
    return "<table><tr>%s</tr>%s</table>" % (cells, body)
