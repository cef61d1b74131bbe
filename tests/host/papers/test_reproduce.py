"""reproduce: both tables come out, and a claim that does not hold is exit 1."""

import json

import numpy as np
import pytest

from sixflip_host import cli
from sixflip_host.papers import li_tables
from sixflip_host.verbs import reproduce


@pytest.fixture(scope="module")
def found():
    """Both tables with ten calibrations."""
    repeated, claims = reproduce.table_3(1)
    turned, more = reproduce.table_4(10, 1)
    return {"format": 1, "sessions": 10, "table_3": repeated, "table_4": turned,
            "claims": claims + more}


def test_the_papers_sensor_gives_the_papers_parameters():
    from sixflip.accelerometer.scale_form import scale_form
    A, b = li_tables.sensor()
    C = np.linalg.inv(A)
    P = np.zeros((4, 4))
    P[:3, :3], P[3, :3], P[3, 3] = C.T, -C @ b, 1
    T, scale, v, _ = scale_form(P.tolist())
    want = [mean for _, mean, _ in li_tables.TABLE_3]
    assert np.allclose(li_tables.parameters(T, scale, v), want, atol=1e-9)


def test_t_is_laid_out_as_in_the_paper():
    # Li Eq. 5: first row 1, -a_yz, a_zy
    T = [[1, 2, 3], [4, 1, 5], [6, 7, 1]]
    names = [name for name, _, _ in li_tables.TABLE_3]
    got = dict(zip(names, li_tables.parameters(T, [1, 1, 1], [0, 0, 0])))
    assert [got[n] for n in ("β_yz", "β_zy", "β_xz", "β_zx", "β_xy", "β_yx")] == [
        -200, 300, 400, -500, -600, 700]


def test_every_claim_holds(found):
    assert [one["claim"] for one in found["claims"] if not one["holds"]] == []
    assert len(found["claims"]) == 9


def test_table_4_has_the_papers_turns_and_repetitions(found):
    assert [(row["turn_deg"], row["repetitions"]) for row in found["table_4"]] == [
        (30, 100), (45, 100), (60, 100), (90, 100)]
    for row in found["table_4"]:
        # a calibration must earn its keep: ten times better than before
        assert row["after_median_error"] < 0.1 * row["before_mean_error"]


def test_the_error_after_is_what_the_hand_leaves(found):
    # scale: two flips an axis of 0.4° each in 180°; |normal| has its median at 0.674 sd
    sd = 0.4 / 180 / np.sqrt(2) * 90
    assert 0.3 * sd < found["table_4"][3]["after_median_error"] < 1.5 * sd


def test_table_3_repeats_better_than_the_paper_where_the_hand_allows(found):
    rows = {row["parameter"]: row for row in found["table_3"]}
    assert list(rows) == [name for name, _, _ in li_tables.TABLE_3]
    for name in ("β_xz", "Scale x", "Scale y", "Scale z", "v z"):
        assert rows[name]["sd"] < 0.2 * rows[name]["paper_sd"]
    assert all(row["sd_flush"] < row["sd"] + 0.005 for row in rows.values())


def test_without_the_bias_refreshed_the_turns_are_worse():
    record, truth = li_tables.calibrated(5)
    taken, spans = li_tables.floor(truth, 5, [90.0, -90.0, 90.0])
    turned = np.array([90.0, -90.0, 90.0])
    fresh = np.abs(li_tables.read(taken, spans, record, True) - turned)
    stale = np.abs(li_tables.read(taken, spans, record, False) - turned)
    assert fresh.max() < stale.max()


def test_a_claim_that_does_not_hold_is_exit_1(monkeypatch, capsys):
    monkeypatch.setattr(reproduce, "P95", 0.01)
    assert cli.main(["reproduce", "--sessions", "10"]) == 1
    assert "does not hold: Table 4: after calibration" in capsys.readouterr().out


def test_json_and_words(monkeypatch, capsys, found):
    monkeypatch.setattr(reproduce, "table_3", lambda seed: (found["table_3"], []))
    monkeypatch.setattr(reproduce, "table_4", lambda n, seed: (found["table_4"], found["claims"]))
    assert cli.main(["reproduce", "--json", "--seed", "7"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["seed"] == 7
    assert answer["table_3"] == found["table_3"]
    assert cli.main(["reproduce"]) == 0
    out = capsys.readouterr().out
    assert "57.25" in out
    assert "holds: Table 3" in out


@pytest.mark.parametrize("words", [["--sessions", "3"], ["--seed", "-1"]])
def test_wrong_numbers(capsys, words):
    assert cli.main(["reproduce", *words]) == 2
    assert "expected" in capsys.readouterr().err
