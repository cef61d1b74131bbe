"""Numbers of two logs side by side: ranges, and intervals that hold what stretches disagree on."""
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.signal import lfilter

from sixflip_host.diagnosis.simulator import (
    alignment,
    evidence_of_logs,
    hypotheses,
    log_noise,
    noise_and_registers,
    own_calibration,
    own_motion,
    pairing,
    parameters,
    simulator_answer,
    timing,
    traces,
)
from sixflip_host.experiment import projection
from sixflip_host.export import put_back
from tests.worlds import tumbled


def swung(limit, size=3.0):
    return np.clip(size * np.sin(np.linspace(0.0, 20.0, 2000)), -limit, limit)


@pytest.mark.parametrize("real,sim,differs,to_set", [
    (2.0, 9.0, True, 2.0), (9.0, 2.0, True, None), (1.0, 2.0, True, 1.0), (2.0, 1.0, True, 2.0),
    (2.0, 2.0, False, None), (9.0, 9.0, False, None)])
def test_a_range_that_is_too_wide_or_too_narrow(real, sim, differs, to_set):
    found = noise_and_registers.ranges("accel", "x", "mg", swung(real), swung(sim))
    assert [p.differs for p in found] == ([True] if differs else [])
    if differs:
        assert found[0].set_to == to_set
        assert np.sign(found[0].difference) == np.sign(min(real, 3.0) - min(sim, 3.0))


def test_a_range_that_nothing_behind_the_simulator_can_widen_is_said_first():
    numbers = {"accel": {"range": {"x": {"real": None, "simulator": 2000.0, "difference": 900.0,
                                         "differs": True, "set": None}}}}
    found = put_back.from_diagnosis({"simulator": {"parameters": numbers, "conventions": []},
                                     "causes": []})
    assert "stops short on x" in found.first[0]
    assert np.isinf(found.accel.limit).all()


def test_a_coefficient_is_as_uncertain_as_stretches_of_the_log_disagree_on_it():
    rng = np.random.default_rng(1)
    slopes = rng.normal(0.0, 0.1, 20)
    x = rng.normal(size=(2000, 1))
    y = np.repeat((x * np.repeat(slopes, 100)[:, None]), 3, 1) + 0.01 * rng.normal(size=(2000, 3))
    result = projection.regression(
        y, x, np.array([10.0]), np.zeros((2000, 3, 0)), np.zeros(0), np.zeros(0), 1.0,
        np.ones(3, bool))
    sigma = result.own_sigma[:, 0]
    assert sigma == pytest.approx(slopes.std() / np.sqrt(20.0), rel=0.4)


def test_columns_that_are_one_share_what_they_explain():
    """Of a gyro with a gate the turn and what turns it were one, and nothing was solved."""
    x = np.rint(4.0 * np.random.default_rng(1).standard_normal((4096, 1)))
    result = projection.regression(
        np.repeat(0.5 * x, 3, 1), np.repeat(x, 3, 1), np.full(3, 1e6), np.zeros((4096, 3, 0)),
        np.zeros(0), np.zeros(0), 1.0, np.ones(3, bool))
    assert result.own.sum(axis=1) == pytest.approx(0.5)


def test_a_coefficient_far_beyond_its_prior_has_the_evidence_of_noise_that_has_settled():
    """A gyro that read half was 57 nats likelier by itself than by the time step that is half:
    its noise had not come down from that of no fit at all."""
    generator = np.random.default_rng(2)
    x = generator.standard_normal((4000, 1))
    y = 0.5 * x + 0.001 * generator.standard_normal((4000, 3))
    prior, alike = 0.04, 25.0  # of so many neighbouring samples one is independent

    def said(log_noise):
        weight = np.exp(-2.0 * log_noise) / alike
        precision = weight * x[:, 0] @ x[:, 0] + prior ** -2
        beta = weight * x[:, 0] @ y[:, 0] / precision
        return beta, precision, y[:, 0] - beta * x[:, 0]
    settled = brentq(lambda s: s - 0.5 * np.log((said(s)[2] ** 2).mean()), -12.0, 0.0)
    beta, precision, left = said(settled)
    wanted = -0.5 * (len(x) / alike * 2.0 * settled + (beta / prior) ** 2
                     + np.log(precision * prior ** 2))
    log = projection.regression(y, x, np.array([prior]), np.zeros((4000, 3, 0)), np.zeros(0),
                                np.zeros(0), alike, np.array([True, False, False])).log
    assert log == pytest.approx(wanted, abs=0.05)


def test_a_density_is_one_with_rests_and_without():
    """Without them it was 1.41 times as large, the one-sided one."""
    made = traces.trace_from_capture("made", tumbled.read(*tumbled.tumbled(1), 1))
    assert made.rests
    values = 0.05 * np.random.default_rng(2).standard_normal((len(made.t), 3))
    both = [log_noise.noise(trace, values).density for trace in (made, replace(made, rests=()))]
    for density in both:
        assert density == pytest.approx(0.05 / np.sqrt(tumbled.RATE_HZ), rel=0.15)


def made_of(values, rests):
    trace = traces.trace_from_capture("made", tumbled.read(*tumbled.tumbled(1, 20.0), 1))
    n = len(values)
    return replace(trace, t=trace.t[:n], force=values, rate=0.01 * values, rests=rests,
                   put_in=np.zeros(n, bool), quantum=(1e-4, 1e-6))


def test_a_noise_to_set_is_that_of_the_real_log_however_little_is_known_of_the_other():
    """A density of -0.48 deg/s/rtHz was to be set, by what is nothing but for its error."""
    rng, logs = np.random.default_rng(1), []
    for density in (0.1, 0.9):
        mg = np.full(3, density / parameters.MG)
        level = log_noise.Noise(mg, 0.3, 10.0 * mg, 0.3)
        logs.append(SimpleNamespace(
            force=rng.standard_normal((400, 3)), rate=None, noise={"accel": level, "gyro": None},
            quantum=(1e-6, 1e-6), rate_hz=100.0, put_in=np.zeros(400, bool)))
    numbers, _ = noise_and_registers.noises(*logs)
    assert [p.set_to for p in numbers if p.differs] == [pytest.approx(0.1)] * 3


def test_a_rest_of_a_second_tells_the_noise_and_not_what_shakes_the_way():
    """Its noise was that of all of the log, ten times as large."""
    values = np.random.default_rng(3).standard_normal((1500, 3))
    values[20:110] *= 0.1
    noise = log_noise.noise(made_of(values, ((20, 110),)), values)
    assert noise.density == pytest.approx(0.01, rel=1.0) and not noise.moving


@pytest.mark.parametrize("times", [3.0, 0.1])
def test_a_short_rest_tells_a_noise_that_is_another(times):
    """It was known to a third by means over quarters of a second: of six numbers one differed."""
    rng = np.random.default_rng(5)
    logs = [made_of(size * rng.standard_normal((1500, 3)), ((0, 1500),))
            for size in (0.1, 0.1 * times)]
    numbers, _ = noise_and_registers.noises(*logs)
    assert sum(p.differs for p in numbers) == 6


@pytest.mark.parametrize("louder, told", [
    ((2.0, 2.0, 2.0), "xyz"), ((1.0, 1.0, 1.0), ""), ((4.0, 1.0, 1.0), "x"),
    ((4.0, 4.0, 1.0), "xy"), ((1.5, 1.0, 0.7), "")])
def test_noise_that_is_twice_as_large_on_three_axes_is_told_by_all_of_them(louder, told):
    """None of them alone was 4 standard errors off in rests of 2.5 s, and nothing was said."""
    for seed in range(5):
        rng = np.random.default_rng(seed)
        real, sim = (made_of(size * rng.standard_normal((1500, 3)), ((0, 250),))
                     for size in (0.1 * np.array(louder), 0.1))
        found = noise_and_registers.noises(real, sim)[0]
        assert "".join(p.axis for p in found if p.differs and p.sensor == "accel") == told, seed


def test_what_a_filter_takes_away_is_not_taken_off_the_density():
    """A pole of 5 Hz leaves a tenth of a sample's power, and all of the density at 1 Hz."""
    white = np.random.default_rng(6).standard_normal((1500, 3))
    leak = np.exp(-2.0 * np.pi * 5.0 / 100.0)
    values = lfilter([1.0 - leak], [1.0, -leak], white, axis=0)
    noise = log_noise.noise(made_of(values, ((0, 1500),)), values)
    assert noise.density == pytest.approx(0.1, rel=2.0 * noise.relative_sigma)
    assert noise.relative_sigma < 0.2


def test_the_noise_of_what_moves_is_an_upper_bound():
    rng = np.random.default_rng(4)
    still, shaken = (made_of(size * rng.standard_normal((1500, 3)), rests) for size, rests in (
        (0.1, ((0, 1500),)), (1.0, ())))
    for pair in ((still, shaken), (shaken, still)):
        numbers, findings = noise_and_registers.noises(*pair)
        assert findings == [] and numbers and not any(p.differs for p in numbers)
    quiet = made_of(0.01 * rng.standard_normal((1500, 3)), ())
    assert all(p.differs for p in noise_and_registers.noises(still, quiet)[0])


@pytest.mark.parametrize("axes,both,said", [
    ((1.0, 1.0, 1.0), True, ["device"]), ((1.0, 1.0, 1.0), False, []),
    ((1.35, 1.0, 0.8), True, [])])
def test_a_density_for_a_samples_noise_is_one_number_in_both_sensors(axes, both, said):
    """Another chip that is some ten times as noisy took a density for a sample's noise."""
    rng = np.random.default_rng(6)
    real, sim = (made_of(0.1 * rng.standard_normal((1500, 3)), ((0, 1500),)) for _ in range(2))
    sim = replace(sim, force=10.0 * np.array(axes) * sim.force,
                  rate=(10.0 if both else 1.0) * np.array(axes) * sim.rate)
    assert [c.sensor for c in noise_and_registers.noises(real, sim)[1]] == said


def test_what_has_no_field_to_set_has_words_to_copy():
    """A pole of 20 Hz is half of 63 ms² of smoothness; what does not differ says nothing."""
    tau = 1.0 / (2.0 * np.pi * 20.0)
    fits = {"gyro": SimpleNamespace(conventions=(), smoothing_earns=0.0, low_pass=None,
                                    fit=SimpleNamespace(smooth_s2=-0.5 * tau ** 2,
                                                        smooth_sigma_s2=1e-8))}
    said = {p.name: p.how for p in timing.compared(
        -0.04, 1e-4, timing.smoothness(fits, {"gyro": 0.0}),
        SimpleNamespace(same=True, drift=0.0, drift_sigma=1e-5))}
    assert said == {"delay": "output the gyro 40 ms later", "clock": "",
                    "smoothness": "put a low-pass of first order at 20 Hz (time constant 7.96 ms) "
                                  "behind it"}


@pytest.mark.parametrize("earned, differs", [(0.0, True), (60.0, True), (99.0, False)])
def test_what_noise_alone_earns_is_no_smoothness(earned, differs):
    """A rover's simulator was "smoother than the sensor", whose force was noise beyond 2 Hz."""
    fits = {"accel": SimpleNamespace(conventions=(), smoothing_earns=earned, low_pass=None,
                                     fit=SimpleNamespace(smooth_s2=5e-4, smooth_sigma_s2=5e-5))}
    smoothness = timing.smoothness(fits, {"accel": 0.0})["accel"]
    assert smoothness.told.differs == differs and (smoothness.low_pass is not None) == differs


@pytest.mark.parametrize("drift, differs", [(8e-5, False), (-8e-5, False), (3e-4, True)])
def test_two_quartzes_that_differ_as_quartzes_do_are_no_gap(drift, differs):
    clock, = timing.compared(None, None, {}, SimpleNamespace(
        same=True, drift=drift, drift_sigma=1e-6))
    assert clock.name == "clock" and clock.differs == differs


def test_a_clock_is_as_uncertain_as_a_controllers_phase_wanders():
    rng = np.random.default_rng(3)
    t = np.arange(6000) * 0.01
    found, stated = [], []
    for _ in range(40):
        slope = 3.0 * np.cos(3.0 * t + rng.uniform(0.0, 6.28))
        phase = np.repeat(rng.normal(0.0, 0.02, 12), 500)  # s, another one every five seconds
        columns = np.stack([slope, slope * t], 1)
        y = slope * phase + rng.normal(0.0, 0.001, len(t))
        size = np.linalg.lstsq(columns, y, rcond=None)[0]
        found.append(size[1])
        stated.append(alignment.errors(columns, y - columns @ size)[1])
    assert 0.6 < np.median(stated) / np.std(found) < 1.6


def test_an_effect_that_is_seen_under_two_names_is_not_no_gap():
    logs = [SimpleNamespace(unexplained=False, conventions=(), differs=[], motion_judged=True,
                            shaken=[], alignment=SimpleNamespace(same=True))]
    assert simulator_answer.verdict("cannot tell", logs) == "no gap"
    assert simulator_answer.verdict("cannot tell", logs, named_effects=True) == "cannot tell"


def test_a_step_is_told_so_exactly_that_its_multiples_are_the_chips():
    """64 counts of 8192 a g are 7.8125 mg: at 4 g, 7.812 would be off by two counts."""
    step = parameters.Parameter("step", "accel", "x", "mg", 7.8125, None, 0.1220703125, None,
                                7.6904296875, None, True, 7.8125)
    found = simulator_answer.numbers([step])["accel"]["step"]["x"]
    assert found["real"] == found["set"] == 7.8125


@pytest.mark.parametrize("fits,simulated,otherwise,said", [
    ({}, None, False, "cannot tell"), ({}, "known", False, "no gap"),
    ({"gyro": "a fit"}, None, False, "no gap"), ({}, "known", True, "cannot tell")])
def test_logs_that_were_not_compared_and_have_no_rest_are_not_no_gap(fits, simulated, otherwise,
                                                                     said):
    """Nor are those that read otherwise at rest, by a bias or by how the sensor lies."""
    logs = [SimpleNamespace(unexplained=False, conventions=(), differs=[], motion_judged=False,
                            shaken=[], fits=fits, real="known", simulated=simulated,
                            otherwise=otherwise)]
    assert simulator_answer.verdict("no gap", logs) == said


def test_a_thing_that_turns_about_one_axis_says_nothing_of_the_others():
    """Across it there is noise alone, which the simulator's log has not: it seemed to read
    nothing there, and to be off by as much as the scale itself along every axis."""
    generator = np.random.default_rng(4)
    axis = np.array([0.6, -0.3, 0.74])
    turning = np.sin(np.arange(6000) / 40.0)[:, None] * axis
    sigma = 2e-3 * np.sqrt(2.0 * 6.0)
    real = turning + sigma * generator.standard_normal(turning.shape)
    said = pairing.reliable(real, np.full(3, sigma))
    across = np.cross(axis, [0.0, 0.0, 1.0])
    assert (said @ across).std() < 0.2 * (real @ across).std()
    np.testing.assert_allclose((said @ axis).std(), (turning @ axis).std(), rtol=0.01)


@pytest.mark.parametrize("unit", [1.0, 57.3])
@pytest.mark.parametrize("order", [[0, 1, 2], [2, 0, 1]])
def test_what_shakes_each_log_by_itself_is_no_motion_of_the_other(unit, order):
    """A floor's rumble, drawn anew: the simulator's z "never changes", as it was not the real
    one's. In which unit and along which axes the simulator reads is not known by then."""
    generator = np.random.default_rng(10)
    moves = generator.normal(0.0, [0.2, 0.2, 0.0], (9000, 3))
    real, measured = (moves + generator.normal(0.0, 0.01, moves.shape) for _ in range(2))
    read = unit * measured[:, order]
    left = pairing.not_foretold(hypotheses.nameless(real, real[:, :0], 0), read)
    own = pairing.shaken(left, read, real)
    assert own == pytest.approx(0.01, rel=0.1)
    assert pairing.reliable(real, np.full(3, own))[:, 2].std() < 0.002


def test_a_fit_that_is_smoother_takes_noise_away():
    """A rover that pitches was "at the body's centre": a lever arm of a centimetre, which the gyro
    says without noise, gave back what too smooth a force had lost."""
    generator, smooth = np.random.default_rng(8), 1e-3
    noise = alignment.smooth(generator.standard_normal((40000, 3)), pairing.GRID_HZ, 2.5)
    bent = np.gradient(np.gradient(noise, axis=0), axis=0) * pairing.GRID_HZ ** 2
    bends = evidence_of_logs.bends(noise, pairing.GRID_HZ)
    less = (noise + smooth * bent).var() / noise.var()
    assert less < 0.9 and evidence_of_logs.smoothed(smooth, bends) == pytest.approx(less, rel=1e-3)
    assert evidence_of_logs.smoothed(-smooth, bends) == 1.0


def test_which_of_two_logs_is_late_is_not_said_where_the_simulators_own_says_nothing(monkeypatch):
    """A real gyro behind a filter of 22 ms, on a pendulum: the simulator was "late"."""
    asked = SimpleNamespace(rests=(), rate=None)
    assert not own_motion.shown_late(asked, -0.022)
    for delay_s, itself in ((0.022, True), (0.0, False)):
        monkeypatch.setattr(own_calibration, "fitted", lambda sim: "a sensor")
        monkeypatch.setattr(own_motion, "fitted", lambda sim, sensor, d=delay_s:
                            own_motion.OwnMotion(d, 0.001))
        assert own_motion.shown_late(SimpleNamespace(rests=((0, 9),)), -0.022) is itself


def test_a_line_is_no_noise_of_a_log():
    """The plain means of a quarter of a second of a line at 37 Hz were five times as noisy in one
    log as in another that had the same line."""
    generator = np.random.default_rng(5)
    t = np.arange(12000) / 200.0
    values = 0.2 * generator.standard_normal((len(t), 3))
    trace = SimpleNamespace(rate_hz=200.0, rests=((0, 6000), (6000, 12000)))
    alone = log_noise.noise(trace, values).density
    shaken = log_noise.noise(trace, values + 6.0 * np.sin(
        2.0 * np.pi * 37.0 * t + 0.4)[:, None]).density
    np.testing.assert_allclose(alone, 0.2 / np.sqrt(200.0), rtol=0.2)
    np.testing.assert_allclose(shaken, alone, rtol=0.2)


@pytest.mark.parametrize("hertz", [1.0, 4.0, 5.5])
def test_what_is_compared_is_as_smooth_of_a_slow_log_as_of_a_fast_one(hertz):
    """A robot's 200 rows a second against a simulator's 50 were "a low-pass is missing"."""
    left = [np.std(alignment.smooth(np.sin(2.0 * np.pi * hertz * np.arange(0, 30, 1.0 / rate)),
                                    rate)[2 * rate:-2 * rate]) for rate in (50, 200)]
    assert left[0] == pytest.approx(left[1], rel=1e-6)
    assert left[0] == pytest.approx(np.sqrt(0.5) / (1.0 + (hertz / alignment.BAND_HZ) ** 4),
                                    rel=1e-3)
