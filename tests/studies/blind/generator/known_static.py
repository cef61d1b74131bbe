"""Known effects that depend on force or rate alone, or on temperature."""

import numpy as np

from .effect import Effect, names_of, sized, some_axes
from .signals import lagged


def _per_axis(name, rng, chip, sensor, times, shape, **more):
    """An Effect that adds size * shape(signals, axis) on one to three axes."""
    axes = some_axes(rng)
    size = sized(rng, np.multiply(chip.typical[name, sensor], times), axes)

    def act(signals, _):
        for axis in axes:
            signals.out(sensor)[:, axis] += size[axis] * shape(signals, axis)

    return Effect(name, sensor, names_of(axes), "response", act,
                  {"size": size.tolist(), **more})


def _temperature(signals, sensor):
    return signals.temp_accel if sensor == "accel" else signals.temp


def thermal_bias(rng, chip, sensor, times):
    """k (T' - 25) (1 + q (T' - 25)): T' trails the thermometer, q bends it."""
    lag = rng.uniform(2, 15)
    bend = rng.choice([0.0, rng.uniform(-0.025, 0.025)])

    def shape(signals, axis):
        warm = lagged(_temperature(signals, sensor), signals.t, lag) - 25
        return warm * (1 + bend * warm)

    return _per_axis("thermal_bias", rng, chip, sensor, times, shape, lag_s=lag, bend=bend)


def thermal_scale(rng, chip, sensor, times):
    lag = rng.uniform(2, 15)

    def shape(signals, axis):
        true = (signals.f if sensor == "accel" else signals.w)[:, axis]
        return true * (lagged(_temperature(signals, sensor), signals.t, lag) - 25)

    return _per_axis("thermal_scale", rng, chip, sensor, times, shape, lag_s=lag)


def warm_up(rng, chip, sensor, times):
    """Two exponentials of random time constants since power came on."""
    slow, quick = rng.uniform(60, 300), rng.uniform(10, 40)
    share = rng.uniform(0.75, 1.0)

    def shape(signals, axis):
        return share * np.exp(-signals.t / slow) + (1 - share) * np.exp(-signals.t / quick)

    return _per_axis("warm_up", rng, chip, sensor, times, shape, tau_s=[slow, quick], share=share)


def thermal_rate(rng, chip, sensor, times):
    lag = rng.uniform(2, 10)

    def shape(signals, axis):
        return np.gradient(lagged(_temperature(signals, sensor), signals.t, lag), signals.t)

    return _per_axis("thermal_rate", rng, chip, sensor, times, shape, lag_s=lag)


def quadratic(rng, chip, sensor, times):
    fourth = rng.uniform(0, 0.3)

    def shape(signals, axis):
        x = signals.f[:, axis]
        return (1 - fourth) * x ** 2 + fourth * x ** 4

    return _per_axis("quadratic", rng, chip, sensor, times, shape, fourth=fourth)


def cross_quadratic(rng, chip, sensor, times):
    others = rng.permutation(3)[:2].tolist()

    def shape(signals, axis):
        return signals.f[:, others[0]] * signals.f[:, others[1]]

    return _per_axis("cross_quadratic", rng, chip, sensor, times, shape, factors=names_of(others))


def cubic(rng, chip, sensor, times):
    """Odd powers up to the seventh, or what a soft limit leaves of a straight line."""
    fifth, seventh = rng.uniform(0, 0.3), rng.uniform(0, 0.15)
    soft = bool(rng.random() < 0.4)

    def shape(signals, axis):
        x = signals.f[:, axis]
        if soft:
            return (1.5 * x - np.tanh(1.5 * x)) / (1.5 - np.tanh(1.5))
        return (1 - fifth - seventh) * x ** 3 + fifth * x ** 5 + seventh * x ** 7

    return _per_axis("cubic", rng, chip, sensor, times, shape, fifth=fifth, seventh=seventh,
                     soft=soft)


def asymmetry(rng, chip, sensor, times):
    """A smooth |x|: the corner is a few hundredths of g, or a few deg/s, wide."""
    corner = rng.uniform(0.01, 0.04) * (1.0 if sensor == "accel" else 50.0)

    def shape(signals, axis):
        x = (signals.f if sensor == "accel" else signals.w)[:, axis]
        return np.sqrt(x ** 2 + corner ** 2) - corner

    return _per_axis("asymmetry", rng, chip, sensor, times, shape, corner=corner)


def g_sensitivity(rng, chip, sensor, times):
    """A full or a sparse 3x3 with a little of the square of the force in it."""
    size = chip.typical["g_sensitivity", "gyro"] * times
    matrix = rng.choice([-1, 1], (3, 3)) * rng.uniform(0.5, 1.25, (3, 3)) * size
    if rng.random() < 0.5:
        keep = np.zeros((3, 3), bool)
        keep[rng.permutation(3)[:2], rng.integers(0, 3, 2)] = True
        matrix = np.where(keep, matrix, 0)
    bend = rng.uniform(-0.1, 0.1) * (rng.random() < 0.5)

    def act(signals, _):
        signals.gyro += (signals.f * (1 + bend * np.abs(signals.f))) @ matrix.T

    axes = [a for a in range(3) if np.any(matrix[a])]
    return Effect("g_sensitivity", "gyro", names_of(axes), "response", act,
                  {"matrix": matrix.tolist(), "bend": bend})


def supply(rng, chip, sensor, times):
    """A battery that sags and a load that comes and goes; nobody writes the voltage down."""
    axes = some_axes(rng)
    beta = sized(rng, np.multiply(chip.typical["supply", "gyro"], times), axes)
    sag, load = rng.uniform(0.02, 0.06), rng.uniform(0.04, 0.1)
    period = rng.uniform(50, 120)

    def act(signals, own):
        t = signals.t
        switches = np.cumsum(own.uniform(0.3, 1.7, int(t[-1] / period * 4) + 4) * period / 2)
        on = np.searchsorted(switches, t) % 2
        volts = -sag * t / 400 - lagged(load * on, t, 0.5)
        signals.gyro += volts[:, None] * beta

    return Effect("supply", "gyro", names_of(axes), "response", act,
                  {"beta": beta.tolist(), "load_v": load, "sag_v": sag})


def local_gravity(rng, chip, sensor, times):
    part = rng.choice([-1, 1]) * chip.typical["local_gravity", "accel"] * times

    def act(signals, _):
        up = signals.at.inv().apply([0, 0, part])
        signals.f = signals.f + up
        signals.accel += up

    return Effect("local_gravity", "accel", [], "world", act, {"relative": part})
