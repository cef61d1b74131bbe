"""Bytes put together wrongly: a sign that is not extended, a low byte with a sign of its own,
bytes in the other order.

Each fault is a rule that takes true counts to those that were read, and has one that takes them
back. What moves goes on from one sample to the next; read wrongly it leaps wherever the rule
does. The likelihood is that of the steps between neighbouring samples after they were taken
back, against the steps as they are, where leaps of any size and share have no name.
"""
import copy
import math

import numpy as np

from ...capture.registers import RAIL
from .damage import Damage
from .detection import present
from .torn_reads import student

FEWEST = 50  # samples
LEAP = 12.0  # times the usual step, and at least LEAST_LEAP counts: what a rule may take back
LEAST_LEAP, FEWEST_LEAPS = 48, 3
LONGEST = 200_000  # samples that are looked at
FREEDOM = (1.0, 3.0, 200.0)  # of Student's t: how heavy the tails of steps are
SHARES = tuple(10.0 ** np.arange(-5.0, -0.29, 0.5))  # tried, of leaps
WIDER = (5.0, 20.0, 100.0, 500.0)  # times the usual step: leaps of a size of their own
WIDTHS = range(8, 16)  # bits of a reading whose sign may be lost
WORDS = {"accel": "accelerometer", "gyro": "gyro"}


def _unsigned(bits):
    """Numbers of so many bits whose sign bit was not carried on: y = x mod 2^bits."""
    def back(y):
        return np.where(y >= 1 << (bits - 1), y - (1 << bits), y)
    return ("sign_extension", "negative readings lost their sign: they are %d too large, as "
            "%d-bit numbers are whose sign is not extended" % (1 << bits, bits), back,
            lambda y: y.min() >= 0 and y.max() < 1 << bits)


def _folded(bits):
    """Numbers cut to so many bits with a sign: they go on at the other end."""
    def back(y):
        return _unfolded(y, 1 << bits)
    half = 1 << (bits - 1)
    return ("sign_extension", "what exceeds %d goes on at %d: readings are cut to %d bits" % (
        half - 1, -half, bits), back, lambda y: y.min() >= -half and y.max() < half)


def _low_added(y):
    """The low byte had a sign when it was added: 256 are missing where it is 128 or more."""
    return np.where(y & 255 >= 128, y + 256, y)


def _low_or(y):
    """The low byte had a sign when the high one was or-ed to it: where it is 128 or more, the
    high one is lost; it is the one that goes on from the nearest sample that has it."""
    known = np.flatnonzero(y & 255 < 128)
    if not len(known):
        return y
    after = np.minimum(np.searchsorted(known, np.arange(len(y))), len(known) - 1)
    before = np.maximum(after - 1, 0)
    far = known[after] - np.arange(len(y)) > np.arange(len(y)) - known[before]
    forward, backward = _carried(y), _carried(y[::-1])[::-1]
    return np.where(far, forward, backward)


def _carried(y):
    """y with the lost high bytes that bring each sample nearest to the one before."""
    out, level = y.tolist(), 0
    for k, lost in enumerate((y & 255 >= 128).tolist()):
        if lost:
            out[k] += 256 * round((level - out[k]) / 256)
        level = out[k]
    return np.array(out, np.int64)


def _or_ed(y):
    lost = y[(y & 255) >= 128]
    return len(lost) > 0 and lost.min() >= -128 and lost.max() < 0 and np.ptp(y) > 256


def _swapped(y):
    """High and low byte exchanged."""
    both = ((y & 255) << 8) | ((y >> 8) & 255)
    return np.where(both >= 1 << 15, both - (1 << 16), both)


def _magnitude(y):
    """A sign bit with a magnitude, read as two's complement."""
    return np.where(y < 0, -(y + (1 << 15)), y)


def _unfolded(y, size):
    step = np.diff(y)
    return y + size * np.concatenate([[0], np.cumsum(-np.rint(step / size))]).astype(np.int64)


RULES = [
    ("sign_extension", "the low byte has a sign of its own: readings are 256 too small where it "
     "is 128 or more", _low_added, lambda y: True),
    ("sign_extension", "the low byte has a sign of its own and wipes the high one out where it "
     "is 128 or more", _low_or, _or_ed),
    ("byte_order", "high and low byte are exchanged", _swapped, lambda y: True),
    ("sign_extension", "negative readings are a sign and a magnitude, and were read as two's "
     "complement", _magnitude, lambda y: y.min() < 0),
    *[_unsigned(bits) for bits in WIDTHS], *[_folded(bits) for bits in WIDTHS]]


def repaired(captures):
    """([(name, Capture)] with the bytes put right, [Damage]): a recording is looked at further as
    it was meant. The captures given are not changed."""
    out, found = [], {}
    for name, capture in captures:
        mended = copy.copy(capture)
        for sensor in ("accel", "gyro"):
            counts = getattr(capture, sensor)
            if counts is None:
                continue
            for axis in range(3):
                fault = of_column(counts[:, axis].astype(np.int64))
                if fault is None:
                    continue
                kind, words, back, nats = fault
                found.setdefault((kind, sensor, words), []).append(("xyz"[axis], nats))
                values = np.array(getattr(mended, sensor))
                values[:, axis] = np.clip(back(counts[:, axis].astype(np.int64)), -RAIL - 1, RAIL)
                setattr(mended, sensor, values)
        out.append((name, mended))
    return out, [Damage(kind, sensor, axes, "amplitude", "the %s of the %s: %s" % (
        ", ".join(axes) + (" axes" if len(axes) > 1 else " axis"), WORDS[sensor], words),
        sum(nats for _, nats in seen))
        for (kind, sensor, words), seen in found.items()
        for axes in [tuple(sorted({letter for letter, _ in seen}))]]


def of_column(counts):
    """(kind, words, rule that takes counts back, nats) of the fault of a column (n,) of int64, or
    None."""
    y = counts[:LONGEST]
    if len(y) < FEWEST:
        return None
    rails = np.abs(y) >= RAIL - 3
    open_ = ~(rails[1:] & rails[:-1])  # from one rail to the other is no rule of bytes
    steps = np.diff(y)[open_]
    before, usual, best = _leaps(steps), _usual(steps), None
    for kind, words, back, possible in RULES:
        if not possible(y):
            continue
        again = np.diff(back(y))[open_]
        fewer = before >= FEWEST_LEAPS and _leaps(again, usual) <= 0.5 * before
        if not fewer and _usual(again) > 0.5 * usual:
            continue
        nats = likelihood(again)
        if best is None or nats > best[3]:
            best = kind, words, back, nats
    if best is None:
        return None
    score = best[3] - max(likelihood(steps), _levels(y)) - math.log(len(RULES))
    return (*best[:3], score) if present(score) else None


def _usual(steps):
    return max(float(np.median(np.abs(steps))) / 0.6745, 0.7) if len(steps) else 0.7


def _leaps(steps, usual=None):
    """Number of steps far larger than is usual."""
    usual = _usual(steps) if usual is None else usual
    return int((np.abs(steps) > max(LEAP * min(usual, 1e4), LEAST_LEAP)).sum())


def likelihood(steps):
    """Largest log likelihood of steps (n,): Student's t of their own width, and a share of leaps
    that are evenly spread, or of another t far wider."""
    width, best = _usual(steps), -math.inf
    for freedom in FREEDOM:
        sound = student(steps / width, freedom) / width
        others = [np.full(len(steps), 1.0 / 131072.0)]
        others += [student(steps / (times * width), 5.0) / (times * width)
                   for times in WIDER]
        for other in others:
            best = max(best, *(float(np.log((1.0 - share) * sound + share * other).sum())
                               for share in SHARES))
    return best


def _levels(y):
    """Log likelihood of readings that are no course in time: about one level, or anywhere."""
    anywhere = -len(y) * math.log(float(np.ptp(y)) + 1.0)
    width = max(float(np.std(y)), 0.5)
    about = -0.5 * float((((y - np.mean(y)) / width) ** 2).sum()) - len(y) * math.log(
        width * math.sqrt(2.0 * math.pi))
    return max(anywhere, about, likelihood(y - np.median(y)))
