"""The page of a fleet: one file, with a table of its boards that sorts itself, and beside it a
page for every board with its own values against the batch."""
import html as markup
import json
import os
import re

import numpy as np

from .. import atomic_write
from ..fleet import diagnosed
from . import fleet_pictures, fleet_words
from .page import Page, text

FOLDER = "reports"
COLUMNS = ("board", "batch", "written", "failure", "verdicts", "reasons", "verified", "findings",
           "remarks", "paths", "gap")
# A click on a heading sorts the table's rows by that column, numbers as numbers.
SORTING = """document.querySelectorAll("table.sortable th").forEach(function (th) {
  th.tabIndex = 0;
  function sort() {
    var body = th.closest("table").tBodies[0], k = th.cellIndex;
    var down = th.getAttribute("aria-sort") !== "descending";
    var rows = Array.prototype.slice.call(body.rows, 0);
    rows.sort(function (a, b) {
      var x = a.cells[k].dataset.v, y = b.cells[k].dataset.v;
      if (x === undefined) x = a.cells[k].textContent;
      if (y === undefined) y = b.cells[k].textContent;
      var m = parseFloat(x), n = parseFloat(y);
      var order = isNaN(m) || isNaN(n) ? x.localeCompare(y) : m - n;
      return down ? -order : order;
    });
    rows.forEach(function (row) { body.appendChild(row); });
    th.parentNode.querySelectorAll("th").forEach(function (o) { o.removeAttribute("aria-sort"); });
    th.setAttribute("aria-sort", down ? "descending" : "ascending");
  }
  th.addEventListener("click", sort);
  th.addEventListener("keydown", function (e) { if (e.key === "Enter") sort(); });
});"""
HEAD = ("board", "batch", "worst, sigma", "of", "what stands out", "verdict", "verified")
VERDICTS = ("good", "doubtful", "refused")


def html(kinds, done, output):
    """The page; kinds: [(Members, [Batch], [LotDifference])], done: run_fleet.Run. The pages of
    single boards are written below the folder output."""
    page = Page("Sixflip: fleet", "A fleet of %d boards" % sum(
        len(them.boards) for them, _, _ in kinds), SORTING)
    for remark in done.remarks:
        page.paragraph(remark)
    about = {(one["batch"], one["board"]): one for one in done.rows(COLUMNS)}
    for them, batches, lots in kinds:
        _kind(page, them, batches, lots, about, output)
    if done.failures:
        page.heading("Left out")
        page.table(["board", "why"], [[str(board), why] for board, why in done.failures])
    return page.html()


def _kind(page, them, batches, lots, about, output):
    page.heading("%s: %d boards" % (them.spelled(), len(them.boards)))
    page.paragraph("Click a heading to sort. Sigmas are of the batch's spread and the board's own "
                   "error together; a board is named beyond %s of them, so that fewer than one "
                   "sound board in 200 is." % ", ".join(sorted({
                       "%.1f" % batch.cutoff for batch in batches})), note=True)
    _boards(page, them, batches, about, output)
    page.heading("What the batch has, and what single boards have", 3)
    for batch in batches:
        rows = [[p.name, "%s ± %s" % (fleet_words.number(p.mean), fleet_words.number(p.error)),
                 fleet_words.number(p.spread), p.unit, fleet_words.word(vars(p) | {
                     "common_share": p.share})] for p in batch.parameters]
        if batch.name:
            page.paragraph("batch %s, %d boards" % (batch.name, len(batch.boards)))
        page.table(["parameter", "mean", "spread between boards", "unit", "it is"], rows)
    if them.unseen:
        page.paragraph("These captures cannot show: " + ", ".join(them.unseen), note=True)
    if lots:
        page.heading("Batches that differ", 3)
        page.table(["batch", "parameter", "from the others by"], [
            [one.batch, one.parameter, "%s ± %s" % (fleet_words.number(one.difference),
                                                    fleet_words.number(one.error))]
            for one in lots])
    if fleet_pictures.drawn(them) and any(b.populations for b in batches):
        page.picture("Distributions", fleet_pictures.distributions(them, batches), 3)
        page.picture("Control charts, in the order of the boards",
                     fleet_pictures.control_charts(them, batches), 3)


def _boards(page, them, batches, about, output):
    batch_of = dict(zip(them.boards, them.batches))
    rows = []
    for batch in batches:
        for number, board in enumerate(batch.boards):
            own = about.get((batch_of[board], board), {})
            standing = distances(batch, number)
            its = [o for o in batch.outliers if o.board == board]
            worst = max([*standing, *((o.parameter, o.sigmas) for o in its)],
                        key=lambda one: abs(one[1]), default=("", 0.0))
            named = [fleet_words.reason(vars(o)) for o in its]
            link = "%s/%s" % (FOLDER, file_name(batch_of[board], board))
            atomic = os.path.join(output, FOLDER)
            os.makedirs(atomic, exist_ok=True)
            atomic_write.write_text(os.path.join(output, link), _board(
                board, batch_of[board], them, standing, named, own))
            verdicts = own.get("verdicts") or [""]
            verdict = max(verdicts, key=lambda v: VERDICTS.index(v) if v in VERDICTS else -1)
            rows.append((abs(worst[1]), [
                "<a href=\"%s\">%s</a>" % (markup.escape(link), text(board)),
                text(batch_of[board]), "%.1f" % abs(worst[1]), text(worst[0]),
                text("; ".join([*named, *_said(own)])),
                "<span class=%s>%s</span>" % (verdict or "none", text(verdict)),
                text(own.get("verified") or "")]))
    rows.sort(key=lambda row: -row[0])
    head = "".join("<th>%s</th>" % text(name) for name in HEAD)
    body = "".join("<tr>%s</tr>" % "".join("<td>%s</td>" % cell for cell in cells)
                   for _, cells in rows)
    page.parts.append("<div class=scroll><table class=sortable><thead><tr>%s</tr></thead><tbody>%s"
                      "</tbody></table></div>" % (head, body))


def _said(own):
    """Sentences of a board's diagnosis, or of what its samples show where it has none."""
    if own.get("gap"):
        return [diagnosed.words(json.loads(own["gap"]))]
    return own.get("findings") or []


def distances(batch, number):
    """[(parameter, sigmas from the batch, value, sigma)] of a board of a judgement.Batch."""
    rows = []
    for block, fitted in batch.populations.values():
        values, = block.y[[number]]
        sigmas, = fitted.sigma(np.einsum("nii->ni", block.R[[number]]))
        for j, name in enumerate(block.names):
            value, sigma = values[j], float(sigmas[j])
            if np.isfinite(value):
                rows.append((name, float((value - fitted.mean[j]) / sigma), float(value), sigma))
    return rows


def file_name(batch, board):
    """Of a board's own page; two boards never share one."""
    from hashlib import sha256
    word = re.sub(r"[^A-Za-z0-9_-]", "_", board)[:40] or "board"
    return "%s-%s.html" % (word, sha256(repr((batch, board)).encode()).hexdigest()[:8])


def _board(board, batch, them, standing, named, own):
    """The page of one board."""
    page = Page("Sixflip: %s" % board, "Board %s" % board)
    page.paragraph("%s%s" % (them.spelled(), ", batch " + batch if batch else ""))
    for verdict, reason in zip(own.get("verdicts") or [], own.get("reasons") or []):
        page.verdict(verdict, reason)
    if own.get("verified"):
        page.verdict(own["verified"], "the board's record against its capture")
    for sentence in [*named, *_said(own), *(own.get("remarks") or [])]:
        page.paragraph(sentence)
    page.heading("Against its batch")
    page.table(["parameter", "value", "sigma", "sigmas from the batch"], [
        [name, fleet_words.number(value), fleet_words.number(sigma), "%+.1f" % away]
        for name, away, value, sigma in sorted(standing, key=lambda one: -abs(one[1]))])
    paths = own.get("paths") or []
    if paths:
        page.heading("Its captures")
        for path in paths:
            page.paragraph(path, note=True)
        page.paragraph("All that single captures show: sixflip report %s --gap" % " ".join(paths),
                       note=True)
    return page.html()
