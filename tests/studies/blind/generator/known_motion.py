"""Known effects of vibration and motion: lines, rectification, lever arm, lag, axes, box."""

import numpy as np
from scipy.signal import lfilter, lfiltic
from scipy.spatial.transform import Rotation

from .effect import Effect, names_of, sized, some_axes
from .hand import FACES, Rest, unit_of
from .signals import lagged


def _tone(own, t, frequency):
    """(n,) of amplitude about one: frequency wanders by 1 %, amplitude by a third."""
    steps = own.normal(0, 1, int(t[-1]) + 3)
    wander = np.convolve(steps, np.ones(20) / np.sqrt(20), "same") * 0.003 * frequency
    drift = np.interp(t, np.arange(len(steps)), wander)
    phase = 2 * np.pi * (frequency * t + np.cumsum(drift) * np.mean(np.diff(t)))
    swell = 1 + 0.3 * np.sin(2 * np.pi * t / own.uniform(7, 40) + own.uniform(0, 6))
    return swell * np.sin(phase + own.uniform(0, 6))


def vibration(rng, chip, sensor, times):
    """A line and its weak second harmonic: a motor's, below or above the Nyquist frequency, or a
    slow ripple of a table or a supply."""
    axes = some_axes(rng)
    size = sized(rng, np.multiply(chip.typical["vibration", sensor], times), axes)
    frequency = rng.choice([rng.uniform(6, 46), rng.uniform(54, 140), rng.uniform(0.8, 3.0)])

    def act(signals, own):
        tone = _tone(own, signals.t, frequency) + 0.2 * _tone(own, signals.t, 2 * frequency)
        signals.out(sensor)[:] += tone[:, None] * size

    return Effect("vibration", sensor, names_of(axes), "world", act,
                  {"amplitude": size.tolist(), "hz": frequency})


def vibration_rectification(rng, chip, sensor, times):
    """A motor that is on for some stretches of the session, and K2 times its mean square."""
    axes = some_axes(rng)
    shift = sized(rng, np.multiply(chip.typical["vibration_rectification", "accel"], times), axes)
    frequency, strength = rng.uniform(8, 45), rng.uniform(0.02, 0.05)

    def act(signals, own):
        switches = np.cumsum(own.uniform(20, 70, int(signals.t[-1] / 20) + 4))
        on = lagged((np.searchsorted(switches, signals.t) % 2).astype(float), signals.t, 1.0)
        tone = _tone(own, signals.t, frequency) * on * strength
        signals.accel[:, axes] += tone[:, None]
        level = on ** 2
        signals.accel += level[:, None] * shift

    return Effect("vibration_rectification", "accel", names_of(axes), "world", act,
                  {"shift_g": shift.tolist(), "hz": frequency, "amplitude_g": strength},
                  also=[("vibration", "accel")])


def lever_arm(rng, chip, sensor, times):
    """The chip sits off the middle of the box (or of the robot) by r."""
    r = rng.normal(0, 1, 3)
    r *= chip.typical["lever_arm", "accel"] * times / np.linalg.norm(r)

    def act(signals, _):
        w = np.radians(signals.w)
        alpha = np.gradient(w, signals.t, axis=0)
        extra = (np.cross(w, np.cross(w, r)) + np.cross(alpha, r)) / 9.80665
        signals.f = signals.f + extra
        signals.accel += extra

    return Effect("lever_arm", "accel", [], "world", act, {"r_m": r.tolist()})


def _behind(x, t, tau):
    """x (n, k) behind a first-order lag, the input a straight line from sample to sample: the
    delay of a ramp is tau however short that is beside the sampling."""
    step = np.mean(np.diff(t))
    fade = np.exp(-step / tau)
    held = tau / step * (1 - fade)
    start = lfiltic([1 - held, held - fade], [1, -fade], [1.0], [1.0])
    return np.stack([lfilter([1 - held, held - fade], [1, -fade], column,
                             zi=start * column[0])[0] for column in x.T], axis=1)


def filter_lag(rng, chip, sensor, times):
    """Two first-order lags in a row, together tau; or (gyro, every other part) a buffer that
    hands its samples on some milliseconds later, up to five times as late."""
    tau = chip.typical["filter_lag", sensor] * times
    buffered = sensor == "gyro" and rng.random() < 0.5
    if buffered:
        tau *= rng.uniform(2.0, 5.0)

    def act(signals, _):
        out = signals.out(sensor)
        if buffered:
            out[:] = np.stack([np.interp(signals.t - tau, signals.t, x) for x in out.T], axis=1)
        else:
            out[:] = _behind(_behind(out, signals.t, tau / 2), signals.t, tau / 2)

    return Effect("filter_lag", sensor, [], "analogue", act,
                  {"tau_s": tau, "buffered": bool(buffered)})


def axis_swap(rng, chip, sensor, times):
    """Two axes exchanged, or two inverted (a turned chip)."""
    order, signs = [0, 1, 2], np.ones(3)
    pair = rng.permutation(3)[:2]
    if rng.random() < 0.5:
        order[pair[0]], order[pair[1]] = order[pair[1]], order[pair[0]]
        signs[pair[0]] = -1
    else:
        signs[pair] = -1

    def act(signals, _):
        out = signals.out(sensor)
        out[:] = out[:, order] * signs

    return Effect("axis_swap", sensor, names_of(sorted(pair.tolist())), "analogue", act,
                  {"order": order, "signs": signs.tolist()})


def box_tilt(rng, chip, sensor, times):
    """Faces that are not square; the scene takes the angles from `parameters`."""
    size = chip.typical["box_tilt", "accel"] * times
    angles = {}
    for face in FACES:
        angle = rng.normal(0, 1, 3)
        angle -= unit_of(face) * (angle @ unit_of(face))
        angles[face] = (angle / np.linalg.norm(angle) * rng.uniform(0.6, 1.4) * size).tolist()

    def act(signals, _):
        signals.f = signals.f.copy()
        for part, piece in signals.path.pieces(signals.t):
            if isinstance(part, Rest) and part.label[:2] in angles:
                tilt = Rotation.from_rotvec(np.radians(angles[part.label[:2]]))
                turned = tilt.inv().apply(signals.f[piece])
                signals.accel[piece] += turned - signals.f[piece]
                signals.f[piece] = turned

    return Effect("box_tilt", "accel", [], "world", act, {"deg": angles})
