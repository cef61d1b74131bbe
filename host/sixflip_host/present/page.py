"""One HTML file that needs nothing else: nothing to fetch, every text escaped, and no script but
one of ours that the page names by its hash."""

import base64
import hashlib
import html

from ..terminal import plain

STYLE = """:root{color-scheme:light}
body{font:15px/1.45 system-ui,sans-serif;max-width:64em;margin:2em auto;padding:0 1em;
color:#1b1b1b;background:#fff}
h1{font-size:1.35em}h2{font-size:1.1em;margin-top:1.8em}h3{font-size:1em;margin-bottom:.3em}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.87em;
margin-bottom:1em}
td,th{padding:.25em .7em;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}
img{max-width:100%}.note{color:#555}.scroll{overflow-x:auto}
.good,.holds{color:#1a6e31;font-weight:600}.doubtful{color:#8a5a00;font-weight:600}
.refused,.fails{color:#a61c1c;font-weight:600}"""
# Even where a text should get through unescaped: a browser runs and fetches nothing.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"
VERDICTS = ("good", "doubtful", "refused", "holds", "fails")


def text(value):
    """Anything as text of a page: escaped, and nothing in it that could turn its direction."""
    return html.escape(plain(value))


class Page:
    """A page grows from top to bottom; html() is what goes into the file. script: the one that a
    browser may run, at the end of the page."""

    def __init__(self, title, heading=None, script=""):
        self.script = script
        policy = POLICY + "; script-src 'sha256-%s'" % base64.b64encode(
            hashlib.sha256(script.encode()).digest()).decode() if script else POLICY
        self.parts = [
            "<!doctype html><html lang=en><meta charset=utf-8>"
            "<meta http-equiv=Content-Security-Policy content=\"%s\">"
            "<meta name=viewport content=\"width=device-width\"><title>%s</title>"
            "<style>%s</style>" % (policy, text(title), STYLE),
            "<h1>%s</h1>" % text(heading or title)]

    def heading(self, words, level=2):
        """A heading of level 2 or 3."""
        self.parts.append("<h%d>%s</h%d>" % (level, text(words), level))

    def paragraph(self, words, note=False):
        """A paragraph; note: in the background."""
        self.parts.append("<p%s>%s</p>" % (" class=note" if note else "", text(words)))

    def verdict(self, word, reason, what=""):
        """good, doubtful or refused (holds, fails) in its colour, and why."""
        look = " class=%s" % word if word in VERDICTS else ""
        self.parts.append("<p>%s<span%s>%s</span>%s</p>" % (
            text(what + ": " if what else ""), look, text(word),
            text(": " + reason if reason else "")))

    def table(self, head, rows):
        """A table of plain strings; a cell that is a verdict is coloured."""
        self.parts.append("<div class=scroll>%s</div>" % table(head, rows))

    def picture(self, caption, png, level=2):
        """A picture under its caption; png: bytes."""
        self.heading(caption, level)
        self.parts.append("<img alt=\"%s\" src=\"data:image/png;base64,%s\">" % (
            text(caption), base64.b64encode(png).decode()))

    def html(self):
        """The whole file."""
        script = ["<script>%s</script>" % self.script] if self.script else []
        return "\n".join([*self.parts, *script]) + "\n</html>\n"


def table(head, rows):
    """An HTML table of plain strings."""
    cells = "".join("<th>%s</th>" % text(h) for h in head)
    body = "".join("<tr>%s</tr>" % "".join(_cell(c) for c in row) for row in rows)
    return "<table><tr>%s</tr>%s</table>" % (cells, body)


def _cell(value):
    look = " class=%s" % value if value in VERDICTS else ""
    return "<td%s>%s</td>" % (look, text(value))
