"""The clock of a recording held against the rate that its header states; what is missing.

The clock itself is measured by sixflip_host.capture.clock, which tells losses from pauses of
the recorder, late stamps and jitter. Only losses, and a stated rate that is wrong, are the
device's; the rest is said and is no cause. A rate that was measured from the stamps themselves
cannot contradict them and is not judged.
"""
import math

import numpy as np

from ...capture import clock, clock_words, stamp_envelope
from .axis_order import explained
from .detection import Finding, present

FEWEST = 200  # samples: two seconds at 100 Hz, over which stamps late by 0.5 ms tell 2 % from none
# Standard deviations of a clock that is as it says, alike in all sessions and in each of them. The
# first is what does not matter: half a turn counted by a clock as far off ends 0.05 deg off, which
# no hand turns to (between two logs, neither of which is turned by hand, less does: QUARTZ in
# simulator/own_motion.py); the second is a crystal's and its driver's.
STATED, DRIVER = 3e-4, 2e-4
OSCILLATOR = 0.02  # and of a sensor's own oscillator [ITG-3205 PS rev 1.0, table 3.1: 2 %]
# Share of its error that an oscillator changes by from session to session, as it follows the
# temperature, which differs by some 9 degC between a warming and a cooling session.
WANDERS = 0.15
APART = 3.0  # nats by which sessions may differ and still have one clock, GAP stage 4


def clocks(sessions):
    """[SampleClock, or None where the times do not run], one a session, of all its rows: those
    that nobody read came as well."""
    return [None if session.timeless else clock.sample_clock(session.capture)
            for session in sessions]


def findings(sessions):
    """list of Finding: a rate that is not the one stated, samples that are missing."""
    session_clocks = clocks(sessions)
    return rate(sessions, session_clocks) + drops(session_clocks)


def rate(sessions, clocks):
    """The clock against the header's rate_hz, where every capture states one. With a name: one
    error of the oscillator in all sessions; without: one of each session's own."""
    if any(timing is None or timing.rows < FEWEST or clock.is_measured(session.capture.meta)
           for session, timing in zip(sessions, clocks)):
        return []
    errors = np.array([timing.rate_hz / session.rate - 1.0
                       for session, timing in zip(sessions, clocks)])
    widths = [np.ptp(timing.interval_hz) / 4.0 / session.rate  # 95 %: two standard errors each way
              for session, timing in zip(sessions, clocks)]
    known = np.diag(np.square(widths) + DRIVER ** 2) + STATED ** 2
    alike = OSCILLATOR ** 2 * ((1.0 - WANDERS ** 2) + WANDERS ** 2 * np.eye(len(errors)))
    sound, own, common = (_log_normal(errors, c)
                          for c in (known, known + OSCILLATOR ** 2 * np.eye(len(errors)),
                                    known + alike))
    if common < own - APART or not present(common - sound):
        return []
    percent = 100.0 * float(np.mean(errors))
    # An oscillator is another one by so much from session to session: that is no other cause.
    left = np.maximum(np.abs(errors - np.mean(errors)) - 2.0 * WANDERS * OSCILLATOR, 0.0)
    half = 100.0 * max(float(np.ptp(errors)) / 2, 2.0 * max(widths), 1e-6)
    return [Finding("sample_rate", "device", [], {"rate": round(percent, 4)}, "%",
                    common - sound, "timing", "the samples come at %.2f Hz, not %g" % (
                        sessions[0].rate * (1 + percent / 100.0), sessions[0].rate),
                    {"rate": (percent - half, percent + half)},
                    share=explained(errors, left), number=len(errors))]


def _log_normal(errors, covariance):
    """Log density of errors (n,) that are normal about 0, but for a constant."""
    return -0.5 * float(errors @ np.linalg.solve(covariance, errors)
                        + np.linalg.slogdet(covariance)[1])


def drops(clocks):
    """Samples that are missing under a clock that went on: gaps as long as a whole number of
    samples, which gaps without a name need not be."""
    clocks = [timing for timing in clocks if timing is not None and timing.rows >= FEWEST]
    lost = sum(timing.losses - timing.losses_known for timing in clocks)
    score = sum(stamp_envelope.loss_nats(np.array(timing.loss_periods),
                                          timing.jitter_ms * timing.rate_hz / 1e3)
                for timing in clocks)
    if not lost or not present(score):
        return []
    expected = sum(timing.expected for timing in clocks)
    late = np.concatenate([timing.loss_periods for timing in clocks])
    chance = 100.0 * lost / expected
    half = 100.0 * 1.645 * math.sqrt(lost) / expected
    return [Finding("dropped_samples", "device", [], {"chance": round(chance, 4)}, "%", score,
                    "timing", "%d of %d samples are missing, the longest gap lasts %.0f ms" % (
                        lost, expected, max(timing.longest_loss_ms for timing in clocks)),
                    {"chance": (max(0.0, chance - half), chance + half)},
                    share=explained(late, late - np.rint(late)), number=len(late))]


def remarks(sessions, clocks):
    """Sentences on what is not the sensor's: pauses, the link, bursts, changes of the rate and
    jitter."""
    said = []
    for session, timing in zip(sessions, clocks):
        if timing is None:
            continue
        lines = []
        if timing.losses_known:
            lines.append("%d samples were lost on the way from the board; that is the link's "
                         "doing, not the sensor's" % timing.losses_known)
        if timing.pauses and clock.of_a_board(session.capture):
            lines.append("the board wrote to its flash %d times, the longest took %.0f ms "
                         "without a sample; that is the recorder's doing, not the sensor's" % (
                             timing.pauses, 1e3 * timing.longest_pause_s))
        elif timing.pauses:
            lines.append(clock_words.pause_words(timing))
        lines += [clock_words.burst_words(timing), clock_words.pace_words(timing),
                  clock_words.jitter_words(timing)]
        said += ["%s: %s" % (session.name, line) for line in lines if line]
    return said


def answer(sessions, clocks):
    """For --json: every capture's clock, and whether its header's rate is stated or measured."""
    return [dict(clock_words.as_json(timing), capture=session.name, header_hz=session.rate,
                 header_rate="measured" if clock.is_measured(session.capture.meta) else "stated")
            for session, timing in zip(sessions, clocks) if timing is not None]
