"""The statistics of the gap on small made-up problems whose answer is known."""
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis import adequacy, gap_figures, holdout_gain, localisation
from sixflip_host.diagnosis.elimination import Columns
from sixflip_host.experiment import thermometer


def test_fieller_covers_the_true_share_and_owns_up_to_too_small_a_gap():
    generator = np.random.default_rng(3)
    covered = number = 0
    for _ in range(600):
        mean = generator.standard_normal(200)
        predicted = 0.8 * mean + 0.1 * generator.standard_normal(200)
        z = mean + generator.standard_normal(200)
        true = (2 * predicted @ mean - predicted @ predicted) / (mean @ mean)
        share, interval = gap_figures.fieller(
            z @ z - 200, 2 * predicted @ z - predicted @ predicted,
            2 * 200 + 4 * (z @ z - 200), 4 * predicted @ predicted, 4 * predicted @ z)
        if interval:
            number += 1
            covered += interval[0] <= true <= interval[1]
    assert number > 550
    assert 0.84 <= covered / number <= 0.97
    assert gap_figures.fieller(3.0, 2.0, 412.0, 4.0, 6.0) == (None, None)


@pytest.mark.parametrize("closed, further", [(-20.0, True), (-3.0, False), (20.0, False)])
def test_what_lies_surely_further_off_than_nothing_is_known(closed, further):
    sums = gap_figures.Sums(40.0, 40.0 - closed, 10.0, 10.0, (4.0, 9.0, 0.0))
    found = sums.shrinkage(True)
    assert found.further is further and (found.share is None) is (closed < 0.0)
    assert not sums.shrinkage(False).further


@pytest.mark.parametrize("named, nothing", [(1.0, False), (-1.0, True)])
def test_what_a_session_has_of_its_own_is_no_witness_against_a_name(named, nothing):
    """A course in time that one session has, the other way of what a name foretells there, took
    what was held out further off; so does a name that is wrong, beside the course as well."""
    t = np.linspace(-1.0, 1.0, 40)
    columns = np.stack([t + 0.3 * t ** 3, t], 1)
    course = Columns(np.array([1]), np.array([30.0]))

    def unit(size, own):
        z = columns @ np.array([size, own])
        return SimpleNamespace(between="", columns=columns, z=z,
                               products=lambda x, metric: 1e4 * x.T @ x)
    units = [unit(1.0, 0.0), unit(named, -4.0)]
    shared = Columns(np.array([0]), np.array([10.0]))
    gram = 1e4 * (columns[:, 0] @ columns[:, 0])
    fits = [gap_figures.Fit(np.zeros(1, int), np.zeros((1, 1)), np.full((1, 1), gram * size),
                            np.full((1, 1, 1), gram)) for size in (1.0, named)]
    assert columns[:, 0] @ units[1].z < 0.0  # it closes nothing, were the course not there
    assert holdout_gain._nothing_closed(
        units, fits, [0, 0], shared, [course, course], 1e6) is nothing
    assert not holdout_gain._nothing_closed(units, fits, [0, 0], shared, [course, course], 1e-3)


def test_false_discoveries_are_held_down():
    generator = np.random.default_rng(4)
    named = 0
    for _ in range(300):
        tested = [localisation.Place("accel", "x", "time", 0.1, p)
                  for p in generator.uniform(size=20)]
        named += bool(localisation.controlled(tested))
    assert named <= 12


def test_a_lag_is_a_lag_and_a_lead_undoes_it_to_first_order():
    t = np.arange(0.0, 900.0)
    felt = 22.0 + 9.0 * (1.0 - np.exp(-t / 300.0))
    meter = thermometer.of_course(t, felt)
    late = meter.lagged(t, 20.0)
    true = felt - 9.0 * np.exp(-t / 300.0) * 20.0 / 300.0
    assert np.abs(late - true)[150:].max() < 0.05
    again = thermometer.of_course(t, late).lagged(t, -20.0)
    assert np.abs(again - felt)[150:].max() < 0.08


def test_an_axis_that_always_reads_the_same_is_no_noise_and_no_warning():
    """Its spread once was a divisor of 0."""
    noise = np.random.default_rng(5).standard_normal((200, 3))
    frozen = noise.copy()
    frozen[:, 1] = 0.3
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert adequacy.oddity(frozen) == ("", 1.0)
    assert adequacy.oddity(noise) == ("", 1.0)
    noise[:, 1] = noise[:, 0] + 0.1 * noise[:, 1]
    how, p = adequacy.oddity(noise)
    assert how == "axes move together" and p < 1e-6
