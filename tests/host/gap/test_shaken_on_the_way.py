"""How hard two logs of one motion shake while they move: the power of each beyond what it has at
rest."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, lfilter

from sixflip_host.diagnosis.simulator import alignment, parameters, shaking

SAME_CLOCK = alignment.Alignment(True, 1.0, 0.0, 0.0, 0.0, 0.0, 40.0)


def moving(mg, seed, hertz=37.0):
    """Trace of a thing that drives and stops, and shakes by mg (root mean square) as it drives."""
    generator = np.random.default_rng(seed)
    t = np.arange(8000) / 200.0
    drives = (t % 10.0) > 4.0
    force = 0.03 * generator.standard_normal((len(t), 3)) + [0.0, 0.0, 9.81]
    force[:, 0] += drives * np.sin(0.9 * t)
    phase = 2.0 * np.pi * np.cumsum(hertz + 3.0 * np.sin(0.3 * t)) / 200.0
    force[:, 2] += drives * np.sqrt(2.0) * mg / parameters.MG * np.sin(phase)
    rests = tuple((2000 * k + 20, 2000 * k + 780) for k in range(4))
    return SimpleNamespace(rate_hz=200.0, t=t, force=force, rate=None, rests=rests,
                           put_in=np.zeros(len(t), bool),
                           railed=np.zeros(len(t), bool),
                           quantum=(0.0012, 2.7e-4))


@pytest.mark.parametrize("real, simulated, differs", [
    (20.0, 0.0, ["z"]), (20.0, 14.0, []), (0.0, 0.0, []), (0.0, 20.0, ["z"])])
def test_what_motors_shake_on_the_way_is_compared_by_its_power(real, simulated, differs):
    """A line that follows the speed is none of the rests, and was no gap."""
    numbers = shaking.shaking(moving(real, 1), moving(simulated, 2, 31.0), SAME_CLOCK)
    assert [p.axis for p in numbers if p.differs] == differs
    z, = [p for p in numbers if p.axis == "z"]
    assert z.real == pytest.approx(real, rel=0.1, abs=1.0)
    assert z.simulated == pytest.approx(simulated, rel=0.1, abs=1.0)
    assert z.set_to is None and bool(z.how) is bool(differs)


@pytest.mark.parametrize("real, simulated, differs", [
    (70.0, 0.0, ["z"]), (0.0, 70.0, ["z"]), (70.0, 70.0, [])])
def test_what_runs_at_rest_as_well_shakes_one_log_alone(real, simulated, differs):
    """A fan of 31 Hz was as loud at rest as on the way, which it added nothing to: no gap."""
    logs = [moving(0.0, seed) for seed in (7, 8)]
    for log, mg in zip(logs, (real, simulated)):
        log.force[:, 2] += np.sqrt(2.0) * mg / parameters.MG * np.sin(2.0 * np.pi * 31.0 * log.t)
    numbers = shaking.shaking(*logs, SAME_CLOCK)
    assert [p.axis for p in numbers if p.differs] == differs
    if differs:
        z, = [p for p in numbers if p.differs]
        assert z.difference == pytest.approx(real - simulated, rel=0.1)
        assert "at 31 Hz" in z.how


def test_coarse_steps_shake_nothing():
    """At rest it read one code; on its way it "shook too much" by what the steps rounded off."""
    real, coarse = moving(0.0, 9), moving(0.0, 10)
    coarse.force = 0.6 * np.round(coarse.force / 0.6)
    coarse.quantum = 0.6, 2.7e-4
    numbers = shaking.shaking(real, coarse, SAME_CLOCK)
    assert numbers and not [p for p in numbers if p.differs]


@pytest.mark.parametrize("mg, together, differs", [
    (0.0, False, []), (0.0, True, []), (30.0, True, ["z"]), (60.0, False, ["z"])])
def test_a_motor_s_line_under_a_floor_s_rumbling_is_in_one_log_alone(mg, together, differs):
    """The rumbling that both have, as strong as the line in all of the band, hid it."""
    logs = []
    for seed, line in ((5, mg), (6, 0.0)):
        log, generator = moving(0.0, seed), np.random.default_rng(0 if together else seed)
        rumbling = lfilter(*butter(2, [10.0, 70.0], "band", fs=200.0),
                           generator.standard_normal(len(log.t)))
        motor = np.sqrt(2.0) * line * np.sin(2.0 * np.pi * 31.0 * log.t)
        log.force[:, 2] += ((log.t % 10.0) > 4.0) * (
            30.0 * rumbling / rumbling.std() + motor) / parameters.MG
        logs.append(log)
    for one, other, sign in ((0, 1, 1.0), (1, 0, -1.0)):
        numbers = shaking.shaking(logs[one], logs[other], SAME_CLOCK)
        assert [p.axis for p in numbers if p.differs] == differs
        if differs:
            z, = [p for p in numbers if p.differs]
            assert sign * z.difference == pytest.approx(mg, rel=0.35)
            assert "at 31 Hz" in z.how


@pytest.mark.parametrize("soft, differs", [(0.3, []), (1.2, ["x"])])
def test_where_one_log_is_cut_off_neither_tells_how_hard_it_shakes(soft, differs):
    """The seconds in which it shakes most were left out of the one that is cut, and no other."""
    logs = []
    for seed, softly in ((3, 0.3), (4, soft)):
        log = moving(0.0, seed)
        drives, strong = (log.t % 10.0) > 4.0, (log.t % 20.0) > 10.0
        log.force[:, 0] += drives * np.where(strong, 9.0, softly) * np.sin(232.5 * log.t)
        logs.append(log)
    logs[0].force[:, 0] = np.clip(logs[0].force[:, 0], -3.0, 3.0)
    numbers = shaking.shaking(*logs, SAME_CLOCK)
    assert [p.axis for p in numbers if p.differs] == differs
    assert numbers[0].real == pytest.approx(0.3 * np.sqrt(0.5) * parameters.MG, rel=0.2)


@pytest.mark.parametrize("mg, differs", [(15.0, ["z"]), (1.5, []), (0.0, [])])
def test_what_one_log_alone_is_shaken_by_is_told_beside_a_short_rest(mg, differs):
    """Two rests of a second and a half were too short, and shaking of 15 mg beside noise of 2 was
    no gap, though both logs move for most of a minute."""
    logs = []
    for seed, size in ((7, mg), (8, 0.0)):
        log = moving(size, seed)
        log.force[:, 2] += 2.0 / parameters.MG * np.random.default_rng(
            10 + seed).standard_normal(len(log.t))
        log.rests = ((0, 310), (4000, 4310))
        logs.append(log)
    for one, other in ((0, 1), (1, 0)):
        numbers = shaking.shaking(logs[one], logs[other], SAME_CLOCK)
        assert [p.axis for p in numbers if p.differs] == differs


@pytest.mark.parametrize("own, both, differs", [
    (15.0, 0.0, ["z"]), (0.0, 300.0, []), (0.0, 0.0, [])])
def test_a_line_too_slow_for_a_motor_is_told_and_a_gait_of_both_is_none(own, both, differs):
    """Between 6 and 12 Hz a line outside of rests was no gap; there a gait is foretold by the
    other log, up to how it is scaled."""
    logs = []
    for seed, mg, scale in ((1, own, 1.0), (2, 0.0, 0.97)):
        log = moving(0.0, seed)
        wave = np.sin(2.0 * np.pi * 9.0 * log.t)
        log.force[:, 2] += ((log.t % 10.0) > 4.0) * np.sqrt(2.0) * (
            mg + scale * both) * wave / parameters.MG
        logs.append(log)
    for one, other in ((0, 1), (1, 0)):
        numbers = shaking.shaking(logs[one], logs[other], SAME_CLOCK)
        assert [p.axis for p in numbers if p.differs] == differs
        if differs:
            z, = [p for p in numbers if p.differs]
            assert abs(z.difference) == pytest.approx(own, rel=0.25)
            assert "at 9 Hz" in z.how
