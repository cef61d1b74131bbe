"""Lines in the spectrum of the rests: vibration from outside, or its alias.

Each rest's periodogram over a running median of itself (so that a filter's colour is no line)
is exponential with mean 1 where there is only noise; over R rests the weighted sum is Gamma
distributed. The largest over all frequencies and axes must be improbable (Bonferroni).
Source: Percival & Walden, Spectral Analysis for Physical Applications (1993), section 10.9.
"""
import math

import numpy as np
from scipy import ndimage, special

from .. import odds
from . import line_across_rests, line_frequency, line_wander, rest_parts
from .detection import Finding
from .line_frequency import Line
from .rest_spectra import (
    LOBE,
    LOWEST_HZ,
    STRONG_SHARE,
    log_beyond,
    rests,
    scatter,
    slow_noise,
    spectrum,
    step,
)

LOWEST_MOVING_HZ = 2.0  # a hand or a vehicle moves more slowly than that
# What has no steady frequency is a motion's own up to here, where nothing rests: a hand trembles
# at 4 to 12 Hz [Elble & Koller, Tremor (1990)], steps and swings are slower.
MOTION_HZ = 15.0
LEAST_CYCLES = 1.4  # of a line in a stretch: what settles in a rest has less
BRIEF_S = 1.5  # a shorter stretch is all of its rest, and begins where the box was just put down
CHANCE = 0.001  # six axes together: well below what registers and spectra share, see odds.py
MEDIAN_SHARE = 0.25  # of the band: wider than any line, narrower than a filter's colour
# Of the counts: rounding makes lines as large as that, unless the noise is half a step or more,
# which makes its error noise as well [Widrow & Kollar, Quantization Noise (2008)].
LEAST_STEPS, DITHERED = 0.5, 0.5
# Bins to each side; a line has that share of the power in them in its own lobe. A hand that
# steadies the box, or a motor under load, has a wider bump.
BESIDE, NARROW = 10, 0.6
MULTIPLES = 5  # of a frequency: what a motor's imbalance, blades and bearings shake at
SWEPT, FALLS = 2, 0.5  # the lowest bins hold the straight line taken off; of a line's power
# A bench or a table sways at its own frequencies, by chance: from stretch to stretch the power
# there scatters as much as its mean (noise through a resonance is exponential). Something that
# runs is steadier. Only what is steady, or strong, is named.
STEADY = 0.6
MOST = 0.5  # of what stands out of the noise: of two explanations that which takes more


def findings(sessions, rings=(), tones=()):
    """list of Finding: at most one vibration a sensor; rings: (sensor, axis letter) that are
    louder after each move, whose line has to go on over the rests; tones: (sensor, axis letter)
    that have a tone whose frequency wanders: what stands still for a part of it is no line."""
    vibrations = []
    for sensor in ("accel", "gyro"):
        if any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        lines = line_wander.together([line for line in (
            line_of_axis(sessions, sensor, i) for i in range(3)) if line])
        lines = [line for line in lines if not (
            (sensor, line.letter) in rings
            and rest_parts.fades(sessions, sensor, line.axis, line.hz))]
        lines = [line for line in lines if line.steady or (sensor, line.letter) not in tones
                 or line.power > MOST * line.excess]
        if lines:
            vibrations.append(told(lines, sensor, sessions[0].rate))
    return vibrations


def line_of_axis(sessions, sensor, axis):
    """The Line of an axis by all files together or by one of them, whichever says more, with
    the frequency of every file that shows it; a slow one where nothing faster is there."""
    groups = [sessions, *([s] for s in sessions if len(sessions) > 1)]
    lines = [strongest(some, sensor, axis) for some in groups]
    lines = [line_frequency.refined(line, sessions, sensor) for line in lines if line]
    resting = any(s.runs for s in sessions)
    lines = [line for line in lines if line and (
        resting or line.steady or line.hz > MOTION_HZ)]
    lines = lines if resting else line_wander.without_strides(lines, sessions)
    if lines:
        return max(lines, key=lambda line: line.nats)
    slow = line_frequency.slow(sessions, sensor, axis)
    if slow:
        return slow
    stretches = rests(sessions, sensor)
    fastest = max(LOWEST_HZ, LEAST_CYCLES * sessions[0].rate / len(stretches[0])) \
        if stretches else LOWEST_MOVING_HZ
    across = [line_across_rests.strongest(s, sensor, axis, fastest) for s in sessions if s.runs]
    return max((line for line in across if line), key=lambda line: line.nats, default=None)


def told(lines, sensor, rate):
    """Finding of the lines of a sensor."""
    top = max(lines, key=lambda line: line.nats)
    value = {line.letter: line.amplitude for line in lines}
    interval = {line.letter: (line.amplitude * (1 - odds.Z_90 * line.error),
                              line.amplitude * (1 + odds.Z_90 * line.error)) for line in lines}
    steady = [line for line in lines if line.steady]
    if steady:
        strong = max(steady, key=lambda line: line.nats)
        words = "a line at %s Hz (or folded from %s, %s Hz)" % tuple(
            line_wander.digits(hz, strong.low, strong.high) for hz in (
                strong.hz, rate - strong.hz, rate + strong.hz))
    elif top.spread_hz:
        words = "a line at about %s Hz, which moves by %.1g Hz from rest to rest" % (
            line_wander.digits(top.hz, top.low, top.high), top.spread_hz)
    else:
        words = "it is shaken at about %.3g Hz, at no steady frequency" % top.hz
    share = float(np.average([line.power / line.excess for line in lines],
                             weights=[line.amplitude ** 2 for line in lines]))
    if share < odds.CLOSED:
        other = max(lines, key=lambda line: line.excess - line.power)
        words += "; %.0f %% of what stands out of the noise does so elsewhere, most at %.3g Hz" % (
            100.0 * (1.0 - share), other.left_hz)
    return Finding("vibration", sensor, sorted(value), value,
                   "mg" if sensor == "accel" else "deg/s", top.nats, "frequency", words, interval,
                   hz={line.letter: line.hz for line in steady}, lines=lines,
                   share=share, number=max(1, int(0.5 / top.error ** 2)))


def within_the_rate(vibrations, damages, rate):
    """list of Finding without lines above half the rate at which a sensor says something new, by
    the Damages of what repeats its rows: those are of the stairs."""
    fresh = {d.sensor: rate / d.value["times"] for d in damages if d.value.get("times", 0) > 1.0}
    kept = []
    for f in vibrations:
        lines = [line for line in f.lines if line.hz <= 0.5 * fresh.get(f.sensor, np.inf)]
        if len(lines) == len(f.lines):
            kept.append(f)
        elif lines:
            kept.append(told(lines, f.sensor, rate))
    return kept


def strongest(sessions, sensor, axis):
    """The Line that is strongest in the spectrum of short stretches, or None."""
    stretches = rests(sessions, sensor)
    if not stretches:
        return None
    plain, mean, number = spectrum(stretches, axis)
    resting = any(session.runs for session in sessions)
    if not resting:  # what shakes a sensor in use comes and goes
        mean = plain
    rate, n = sessions[0].rate, len(stretches[0])
    lowest_hz = max(LOWEST_HZ, LEAST_CYCLES * rate / n) if resting else LOWEST_MOVING_HZ
    first = int(lowest_hz * n / rate) + 1
    band = mean[first:-1]
    if len(band) < 20 or not band.any():
        return None
    width = max(9, int(MEDIAN_SHARE * len(band)) | 1)
    median_of_mean = special.gammaincinv(number, 0.5) / number
    floor = ndimage.median_filter(band, size=width, mode="reflect") / median_of_mean
    # Towards lower frequencies a spectrum falls below a line; that of what drifts rises on.
    lowest = min(SWEPT, first - 1)
    below_it = np.minimum.accumulate(mean[lowest:-1])[first - lowest - 1:-1]
    ratio = np.where(below_it < FALLS * band, band / np.maximum(floor, 1e-12), 0.0)
    k = int(ratio.argmax())
    if not ratio[k] > 0.0:
        return None
    # Nor does it stand out of slow noise that falls there by chance and rises again.
    slow = slow_noise(band, np.maximum(floor, 1e-12), k, number)
    known = width if slow[k] < floor[k] else np.count_nonzero(slow > floor)  # bins it is told by
    floor = floor + slow
    ratio[k] = band[k] / max(floor[k], 1e-12)
    doubt = 1.0 + 2.0 * 1.25 / math.sqrt(known * number)  # the floor is a median itself
    nats = -(log_beyond(ratio[k] * number / doubt, number) + math.log(3.0 * len(band)))
    if nats < -math.log(CHANCE):
        return None
    if resting and n < BRIEF_S * rate and rest_parts.fades_within(
            stretches, axis, (first + k) / n):
        return None
    whole = plain[first:-1]
    below = np.median(whole[max(0, k - width // 2):k + width // 2 + 1]) / median_of_mean
    usual = ndimage.median_filter(whole, size=width, mode="reflect") / median_of_mean
    lobe, beside = (slice(max(0, k - w), k + w + 1) for w in (LOBE, BESIDE))
    excess = float((whole - below)[lobe].sum())
    # A sine of amplitude a: sum over the lobe of |X|^2 = a^2 n sum(w^2) / 4.
    amplitude = math.sqrt(max(4.0 * excess / n, 0.0))
    spread = np.mean([s[:, axis].std() for s in stretches])
    counted = step(sessions, sensor, axis)
    noise = math.sqrt(float(np.median(floor)))
    if amplitude < rest_parts.LEAST_SHARE * spread or (
            noise < DITHERED * counted and amplitude < LEAST_STEPS * counted):
        return None
    scattered = scatter(stretches, axis, first + k)
    if resting and amplitude < STRONG_SHARE * spread and scattered > STEADY:
        return None
    error = 1.0 / math.sqrt(max(2.0 * number * ratio[k], 1.0))
    hz = line_frequency.peak(mean, first + k) * rate / n
    heights = band / np.maximum(floor, 1e-12)
    bump = bump_around(k, heights, number)
    power = max(excess, float((whole - usual)[bump].sum()))
    others = standing_out(heights, number, doubt)
    others &= ~bump & ~multiples_of(first + k, n, first, len(band))
    if not resting:  # what it does itself is no more of the sensor there
        others &= (first + np.arange(len(band))) * rate / n > MOTION_HZ
    left = np.where(others, np.maximum(whole - usual, 0.0), 0.0)
    return Line(axis, hz, rate / n, nats, amplitude, error,
                narrow=bool((band - floor)[lobe].sum() > NARROW * (band - floor)[beside].sum()),
                power=power, excess=power + float(left.sum()),
                bump=math.sqrt(4.0 * power / n),
                bump_error=max(error, 0.5 * scattered / math.sqrt(number)),
                left_hz=(first + int(left.argmax())) * rate / n if left.any() else 0.0)


def bump_around(k, ratio, number):
    """(m,) bool: bins around the k-th that stand above the floor as a mean of three of them seldom
    does by chance, without a gap; of a line the lobe, of what wanders or comes and goes more.
    ratio (m,): mean of `number` spectra over their floor."""
    over = ndimage.uniform_filter1d(ratio, 3, mode="nearest") > 1.0 + 2.0 / math.sqrt(3 * number)
    over[max(0, k - LOBE):k + LOBE + 1] = True
    labels = ndimage.label(over)[0]
    return labels == labels[k]


def standing_out(ratio, number, doubt):
    """(m,) bool: bins that are lines themselves, by the chance that `strongest` asks of one."""
    far = np.zeros(len(ratio), bool)
    for j in np.flatnonzero(ratio > 1.0 + 2.0 / math.sqrt(number)):
        far[j] = log_beyond(ratio[j] * number / doubt, number) + math.log(
            3.0 * len(ratio)) < math.log(CHANCE)
    return far


def multiples_of(k, n, first, size):
    """(size,) bool, from bin `first` on: the lobes of multiples of the frequency of bin k of n
    samples, folded at half the rate: what is shaken is seldom a pure sine."""
    known = np.zeros(size, bool)
    for times in range(2, MULTIPLES + 1):
        folded = abs((times * k + n / 2.0) % n - n / 2.0)
        # k is known to half a bin.
        at = int(round(folded)) - first
        wide = LOBE + (times + 1) // 2
        known[max(0, at - wide):max(0, at + wide + 1)] = True
    return known
