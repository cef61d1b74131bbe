"""Known effects with a memory: of force (hysteresis, creep) and of nothing but time (drift)."""

import numpy as np

from .effect import Effect, names_of, sized, some_axes
from .noise import one_over_f
from .signals import lagged


def play(x, width):
    """The play (backlash) operator: follows x, `width` behind, from where x starts. (n,)."""
    out = np.empty_like(x)
    state = x[0]
    for i, value in enumerate(x):
        state = min(max(state, value - width), value + width)
        out[i] = state
    return out


def hysteresis(rng, chip, sensor, times):
    """tanh of how far the force is from the state of a play operator that follows the whole
    way; or of how far it is from the placement before, for a memory that every lift resets."""
    axes = some_axes(rng)
    size = sized(rng, np.multiply(chip.typical["hysteresis", "accel"], times), axes)
    width = rng.uniform(0.1, 0.4)
    along_the_way = bool(rng.random() < 0.5)
    steep = rng.choice([1.2, 30.0])     # a share of the way, or hardly more than its sign

    def way(signals, axis):
        smooth = lagged(signals.f[:, axis], signals.t, 0.1)
        behind = np.repeat(play(smooth[::10], width), 10)[:len(smooth)] - smooth
        return np.tanh(1.5 * behind / width)

    def placement(signals, axis):
        out, before = np.zeros(len(signals.t)), None
        for inside, now in _rests(signals, axis):
            if before is not None:
                out[inside] = np.tanh(steep * (before - now))
            before = now
        return out

    return _remembered("hysteresis", axes, size, way if along_the_way else placement,
                       width_g=width, along_the_way=along_the_way, steep=steep)


def _remembered(name, axes, size, form, **parameters):
    """An Effect that adds size * form(signals, axis) to the force."""
    def act(signals, _):
        for axis in axes:
            signals.accel[:, axis] += size[axis] * form(signals, axis)

    return Effect(name, "accel", names_of(axes), "response", act,
                  {"size": size.tolist(), **parameters})


def _rests(signals, axis):
    """(samples, mean force on the axis) of every placement in order."""
    for number in range(signals.placements.max() + 1):
        inside = np.flatnonzero(signals.placements == number)
        if len(inside):
            yield inside, signals.f[inside, axis].mean()


def creep(rng, chip, sensor, times):
    """Relaxes after every turn: by two time constants fed by everything that went before, or
    by a stretched exponential that starts anew at every placement."""
    axes = some_axes(rng)
    size = sized(rng, np.multiply(chip.typical["creep", "accel"], times), axes)
    taus = [rng.uniform(40, 100), rng.uniform(5, 20)]
    share, stretch = rng.uniform(0.7, 1.0), rng.uniform(0.7, 1.0)
    remembers_all = bool(rng.random() < 0.5)

    def fading(signals, axis):
        x = signals.f[:, axis]
        past = share * lagged(x, signals.t, taus[0])
        return past + (1 - share) * lagged(x, signals.t, taus[1]) - x

    def anew(signals, axis):
        out, before = np.zeros(len(signals.t)), None
        for inside, now in _rests(signals, axis):
            if before is not None:
                since = signals.t[inside] - signals.t[inside[0]]
                out[inside] = (before - now) * np.exp(-(since / taus[0]) ** stretch)
            before = now
        return out

    return _remembered("creep", axes, size, fading if remembers_all else anew, tau_s=taus,
                       share=share, stretch=stretch, remembers_all=remembers_all)


def drift(rng, chip, sensor, times):
    """Low-frequency noise of a random colour, between flicker and random walk, on all axes."""
    rms = chip.typical["drift", sensor] * times
    exponent = rng.uniform(1.3, 2.0)

    def act(signals, own):
        for axis in range(3):
            signals.out(sensor)[:, axis] += one_over_f(
                own, len(signals.t), signals.rate, rms, exponent)

    return Effect("drift", sensor, ["x", "y", "z"], "response", act,
                  {"rms": rms, "exponent": exponent})
