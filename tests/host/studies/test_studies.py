"""The studies in small: each one's counting, and one case of each from file to answer."""

import numpy as np
import pytest

from sixflip_host.planning import next_capture
from tests.studies.robustness import left_out, null_study, real_noise, resolved


def cause(effect, *rivals, sensor="accel"):
    return {"sensor": sensor, "effect": None if rivals else effect, "class": [effect, *rivals],
            "axes": [], "value": {}, "score_nats": 9.0, "unit": ""}


def test_pieces_of_recorded_noise_keep_their_size_and_have_no_seams(recordings):
    cut = real_noise.pieces(recordings)
    assert {name: len(pieces) > 2 for name, pieces in cut.items()} == dict.fromkeys(
        ("suarez", "xsens", "imucal", "tree"), True)
    for pieces in cut.values():
        accel, gyro = real_noise.source(pieces)(np.random.default_rng(3), None, 30000, 100.0)
        made = np.hstack([accel, gyro])
        real = np.sqrt(np.mean([piece.var(axis=0) for piece in pieces], axis=0))
        assert made.shape == (30000, 6)
        assert made.std(axis=0) == pytest.approx(real, rel=0.15)
        assert np.abs(made).max() < 12.0 * made.std(axis=0).max()


def test_nothing_is_named_in_nulls_of_real_noise(recordings):
    jobs = null_study.nulls(recordings, 60)
    paper = {job[1]: job for job in jobs
             if null_study.specification(*job[:2]).protocol == "paper"}
    for name in ("suarez", "imucal"):
        recording, _, seed, verdict, false, alarm = null_study.judged(paper[name])
        assert not alarm, (recording, seed, verdict, false)


def test_a_wrong_name_counts_only_when_it_stands_alone_and_explains():
    def kind(verdict, *causes):
        return left_out.kind({"verdict": verdict, "causes": list(causes)}, "creep",
                             [("vibration", "accel")])
    assert kind("explained", cause("cubic")) == ("wrong", ["accel cubic"])
    assert kind("explained", cause("vibration")) == ("quiet", [])
    assert kind("partly explained", cause("cubic"))[0] == "open"
    assert kind("unexplained") == ("open", [])
    assert kind("cannot tell", cause("cubic", "quadratic")) == ("class", [])
    assert kind("no gap") == ("quiet", [])


@pytest.mark.long
@pytest.mark.parametrize("job", [
    ("g_sensitivity", "gyro", 3.0, 9700),
    ("cubic", "accel", 1.0, 10000)])  # a memory that levels off bends as it does, and was named
def test_an_effect_without_a_name_gets_no_other_name(job):
    row = left_out.asked(job)
    assert row[4] == "open", row


def test_every_capture_that_may_be_recommended_can_be_made_here():
    assert set(next_capture.WORDS.values()) <= set(resolved.RECIPES)


def test_resolved_means_that_the_rivals_are_gone():
    def outcome(*causes):
        return resolved.outcome({"causes": list(causes)}, "creep", "accel", {"hysteresis"})
    assert outcome(cause("creep")) == "resolved"
    assert outcome(cause("creep", "cubic")) == "resolved"
    assert outcome(cause("creep", "hysteresis")) == "right class"
    assert outcome(cause("hysteresis")) == "wrong"
    assert outcome() == outcome(cause("creep", sensor="gyro")) == "lost"


@pytest.mark.long
def test_the_capture_recommended_tells_temperature_from_warm_up():
    _, names, words, outcome = resolved.tried(("warm_up", "accel", 3.0, "one session", 7400))
    assert {"warm_up", "thermal_bias"} <= set(names)
    assert words in resolved.RECIPES
    assert outcome == "resolved"
