"""A low-pass that one of two logs of one motion has: its form, its time constant, its delay, and
nothing else that it looks like."""
import numpy as np
import pytest

from sixflip_host.diagnosis.simulator import comparison, shaking, traces
from sixflip_host.experiment import low_pass
from tests.worlds.tumbled import RATE_HZ, attitudes, read


def first_order(f, hz):
    return 1.0 / (1.0 + 1j * f / hz)


def butterworth(f, hz):
    return hz ** 2 / (hz ** 2 - f ** 2 + 1j * np.sqrt(2.0) * f * hz)


def window(f, seconds):
    """The mean of what was read in the last so many seconds."""
    return np.sinc(f * seconds) * np.exp(-1j * np.pi * f * seconds)


def shaken_by_hand(seed, seconds=90.0):
    """(t, force g, rate deg/s) of a box that a hand turns and shakes to and fro, up to 5 Hz."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t % 15.0 - 3.0, 14.5 - t % 15.0) / 1.5, 0.0, 1.0)[:, None]
    hz = np.geomspace(0.15, 5.0, 14)
    rate, moved = (way * sum(
        size * f ** -0.5 * np.sin(2.0 * np.pi * f * t[:, None] + rng.uniform(0.0, 6.28, 3))
        for f in hz) for size in (35.0, 0.08))
    return t, attitudes(rate)[:, 2, :] + moved, rate


def behind(values, response, *parameters):
    """values (n, 3) behind a low-pass: rests at both ends, so that the ends meet."""
    spectrum = np.fft.rfft(values - values[0], axis=0)
    hz = np.fft.rfftfreq(len(values), 1.0 / RATE_HZ)
    return values[0] + np.fft.irfft(spectrum * response(hz, *parameters)[:, None], len(values),
                                    axis=0)


def ends_alike(force):
    """force (n, 3), led back to where it began in the last seconds, after a rest."""
    n = int(0.4 * RATE_HZ)
    fade = np.linspace(0.0, 1.0, n)[:, None]
    return np.concatenate([force[:-n], force[-n:] * (1.0 - fade) + force[:1] * fade])


def logs(seed, response, parameters, of, sensors):
    """(real, simulated) Captures; of: which of the two is behind the low-pass."""
    t, force, rate = shaken_by_hand(seed)
    force = ends_alike(force)
    made = [behind(x, response, *parameters) if kind in sensors else x
            for kind, x in (("accel", force), ("gyro", rate))]
    plain, passed = read(t, force, rate, seed + 100), read(t, *made, seed + 200)
    return (plain, passed) if of == "sim" else (passed, plain)


def compared(real, simulated):
    return comparison.compare([("real", real)], "sim", simulated)


@pytest.mark.parametrize("response, hz, form", [
    (first_order, 3.0, "first order"), (first_order, 5.0, "first order"),
    (butterworth, 5.0, "second order (Butterworth)"),
    (butterworth, 9.0, "second order (Butterworth)")])
@pytest.mark.parametrize("of", ["sim", "real"])
def test_a_low_pass_has_its_form_and_its_frequency(response, hz, form, of):
    """Of 5 Hz it was "something that no convention explains", or a scale of 2 %."""
    found = compared(*logs(3, response, (hz,), of, ("accel", "gyro")))
    assert not found.conventions
    assert {(p.name, p.sensor) for p in found.differs} == {
        ("smoothness", "accel"), ("smoothness", "gyro")}
    for parameter in found.differs:
        assert form in parameter.how
        assert parameter.how.startswith("put a low-pass" if of == "real" else "it is smoother")
        tau_ms = np.sqrt(2.0 * abs(parameter.difference))
        assert 1e3 / (2.0 * np.pi * tau_ms) == pytest.approx(hz, rel=0.03)
    before, after, _ = found.gap["gyro"]
    assert before > 0.4 and after < 0.1 * before


@pytest.mark.parametrize("response, hz", [(first_order, 10.0), (butterworth, 5.0)])
def test_a_low_pass_of_one_sensor_is_no_delay_beside(response, hz):
    """"Take out a pole of 15.9 ms" and "output the accelerometer 15 ms later" put it right twice.
    """
    found = compared(*logs(4, response, (hz,), "sim", ("gyro",)))
    assert not found.conventions
    assert [(p.name, p.sensor) for p in found.differs] == [("smoothness", "gyro")]
    delay, = (p for p in found.parameters if p.name == "delay")
    assert delay.difference == pytest.approx(0.0, abs=1.0)


def test_what_is_late_beside_its_low_pass_is_told_as_so_much_later():
    t, force, rate = shaken_by_hand(5)
    late = behind(rate, lambda f: first_order(f, 5.0) * np.exp(-2j * np.pi * f * 0.02))
    found = compared(read(t, force, rate, 1), read(t, force, late, 2))
    told = {p.name: p for p in found.differs}
    assert set(told) == {"smoothness", "delay"}
    assert told["delay"].difference == pytest.approx(-20.0, abs=1.0)


def test_logs_as_smooth_as_each_other_have_none():
    t, force, rate = shaken_by_hand(6)
    for noise in (1, 2):
        found = compared(read(t, force, rate, 10 + noise), read(t, force, rate, 20 + noise))
        assert not found.differs and not found.conventions
        assert all(fit.low_pass is None for fit in found.fits.values())


def test_what_a_low_pass_takes_of_shaking_is_not_told_twice():
    """It "shakes too little between 12 and 40 Hz", of which a pole of 4 Hz leaves a fifth."""
    t, force, rate = shaken_by_hand(7)
    noise = behind(np.random.default_rng(7).standard_normal(rate.shape), lambda f: f > 14.0)
    rate = rate + 2.0 * np.where(rate == 0.0, 0.0, noise)
    real, simulated = read(t, force, rate, 1), read(t, force, behind(rate, first_order, 4.0), 2)
    found = compared(real, simulated)
    assert {p.name for p in found.differs if p.sensor == "gyro"} == {"smoothness"}
    alone = shaking.shaking(*(traces.trace_from_capture("log", x) for x in (real, simulated)),
                            found.alignment)
    assert any(p.differs for p in alone if p.sensor == "gyro")


@pytest.mark.parametrize("form", sorted(low_pass.FORMS))
def test_a_form_is_late_by_what_it_says_and_bends_as_a_pole_of_so_much(form):
    """By the response with its own delay, to second order of a slow frequency."""
    one = low_pass.LowPass(form, 0.02, "sim")
    hz = np.array([0.05, 0.1])
    whole = {"first order": lambda f: first_order(f, 1.0 / (2.0 * np.pi * 0.02)),
             "second order (Butterworth)": lambda f: butterworth(f, 1.0 / (2.0 * np.pi * 0.02)),
             "mean": lambda f: window(f, 0.02)}[form](hz)
    assert np.angle(whole) == pytest.approx(-2.0 * np.pi * hz * one.late_s, rel=1e-3)
    assert np.abs(one.response(hz)) == pytest.approx(np.abs(whole), rel=1e-9)
    back = low_pass.LowPass.of_half_square(one.half_square_s2, form)
    assert back.seconds == pytest.approx(0.02) and back.of == "sim" and back.form == form
    assert one.on("sim") is None and one.on("real") is one
