"""The page of a fleet: worst boards first, a link to each board's page, nothing unescaped."""
import base64
import hashlib
import re
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.fleet import judgement, members
from sixflip_host.present import fleet_page

ODD = "<b>&\u202e"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """(HTML, folder) of 30 boards: one is far off, one drifted, one has a name to be escaped."""
    rng, n = np.random.default_rng(2), 30
    names = members.parameters.BLOCKS["accel_bias"]
    y = rng.normal(0.0, 10.0, (n, 3))
    y[4, 1] += 500.0
    change = rng.normal(0.0, 1.0, (n, 3))
    change[9, 2] = 30.0
    boards = tuple(ODD if k == 7 else "b%02d" % k for k in range(n))
    them = members.Members(
        "mpu6050", 2.0, 500.0, boards, ("lot",) * n,
        [members.Block("accel_bias", names, y, np.tile(np.eye(3), (n, 1, 1)))],
        [members.Change(names, change, np.ones((n, 3)))], {}, ("cubic of the accel",))
    rows = [{"board": b, "batch": "lot", "verdicts": ["good"], "reasons": ["why"], "verified": "",
             "findings": [], "remarks": [], "paths": [], "gap": ""} for b in boards]
    done = SimpleNamespace(rows=lambda columns: iter(rows), remarks=["a remark"],
                           failures=[("x<y", "broken & gone")])
    folder = tmp_path_factory.mktemp("page")
    return fleet_page.html([(them, judgement.batches(them), [])], done, str(folder)), folder


def test_the_worst_boards_are_first_drifted_ones_among_them(page):
    boards = re.findall(r"<tr><td><a href=\"[^\"]*\">([^<]*)</a>", page[0])
    assert len(boards) == 30 and set(boards[:2]) == {"b04", "b09"}
    assert "against its own history" in page[0] and "the batch has" in page[0]


def test_every_board_has_its_page(page):
    text, folder = page
    links = re.findall(r"<a href=\"([^\"]*)\"", text)
    assert len(set(links)) == 30
    assert all("Against its batch" in (folder / link).read_text() for link in links)


def test_only_the_page_s_own_script_runs_and_names_are_escaped(page):
    text, _ = page
    script, = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert "default-src 'none'" in text and "script-src 'sha256-%s'" % digest in text
    assert "<b>" not in text and "\u202e" not in text and "&lt;b&gt;" in text
    assert "x&lt;y" in text and "broken &amp; gone" in text and "a remark" in text
