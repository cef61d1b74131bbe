"""Layer two, what is in time: delay between the sensors, smoothness of each, and clock, of which
two logs of one motion give the differences.
"""
from dataclasses import replace
from math import erfc

import numpy as np

from . import convention_findings, parameters

# An engine whose rates are half a physics step older than its forces (MuJoCo, Featherstone's
# semi-implicit step) differs from itself by as much at two step sizes of 1 and 2 ms.
LEAST_DELAY_MS = 0.5
LEAST_SMOOTH_MS2 = 3.0  # half the square of a time constant of 2.4 ms
# Quartz is within 50 ppm of its frequency (boards' crystals have 10 to 50 in their data sheets),
# and two logs have one each: so much is no simulator's fault, and nothing to set.
QUARTZ = 1e-4
LATE_SIGMA = 4.0  # standard errors from which on a delay is one: by chance in 1 of 16,000 (normal)


def timing(late, late_sigma, fits, alignment, freed=None):
    """Delay between the sensors, smoothness of each, clock: differences only, each with what to
    do; freed {sensor: s2}: half the square of the time constant by which the straight lines that
    stand for repeated rows make the simulator's log smoother than the real one."""
    numbers = []
    if late is not None:
        numbers.append(with_how(parameters.compared(
            "delay", "gyro", "", "ms", None, np.inf, None, np.inf, -1e3 * late, 1e3 * late_sigma,
            least=LEAST_DELAY_MS), later))
    for kind, sensor_fit in fits.items():
        fit = sensor_fit.fit
        if any(c.name == "unknown" for c in sensor_fit.conventions):
            continue
        smooth_s2 = fit.smooth_s2 - (freed or {}).get(kind, 0.0)
        told = smooth_s2 / np.hypot(fit.smooth_sigma_s2, 1e-6 * LEAST_SMOOTH_MS2)
        numbers.append(with_how(parameters.compared(
            "smoothness", kind, "", "ms²", None, np.inf, None, np.inf, -1e6 * smooth_s2,
            1e6 * fit.smooth_sigma_s2, least=LEAST_SMOOTH_MS2,
            apart=np.sqrt(max(told ** 2 - sensor_fit.smoothing_earns, 0.0))), smoother))
    if alignment.same:
        numbers.append(with_how(parameters.compared(
            "clock", "device", "", "%", None, np.inf, None, np.inf, -100.0 * alignment.drift,
            100.0 * alignment.drift_sigma,
            apart=(abs(alignment.drift) - QUARTZ) / alignment.drift_sigma), faster))
    return numbers


def with_how(parameter, how):
    """The Parameter with what to do where it differs."""
    return replace(parameter, how=how(parameter.difference)) if parameter.differs else parameter


def later(ms):
    """What to do about a delay between the sensors: gyro after accelerometer, or the reverse."""
    return "output the %s %.3g ms later" % ("gyro" if ms > 0 else "accelerometer", abs(ms))


def smoother(ms2):
    """Half the square of a time constant; two poles one after the other add theirs."""
    tau_ms = np.sqrt(2.0 * abs(ms2))
    pole = "low-pass of first order at %.3g Hz (time constant %.3g ms)" % (
        1e3 / (2.0 * np.pi * tau_ms), tau_ms)
    return "put a %s behind it" % pole if ms2 > 0 else \
        "it is smoother than the sensor by a %s: take as much out" % pole


def faster(percent):
    """What to do about a clock that runs this much faster than the real one."""
    return "multiply its times by %.6g" % (1.0 - percent / 100.0)


def delay(sensor_fits, row_s):
    """(seconds by which the gyro is later than the accelerometer, more than the real sensor's;
    standard error), and the Convention where it is a row or more."""
    if len(sensor_fits) < 2:
        return None, None, []
    a, g = sensor_fits["accel"].fit, sensor_fits["gyro"].fit
    late = g.delay_s - a.delay_s
    sigma = float(np.hypot(a.delay_sigma_s, g.delay_sigma_s))
    known = not any(c.name == "unknown" for f in sensor_fits.values() for c in f.conventions)
    findings = [late_one(late, sigma)] if known and abs(late) > LATE_SIGMA * sigma and (
        abs(late) >= row_s) else []
    return late, sigma, findings


def late_one(late, sigma):
    """The Convention of a gyro that is late by so many seconds, or an accelerometer (negative)."""
    kind = "gyro" if late > 0 else "accel"
    ms = 1e3 * abs(late)
    return convention_findings.finding(kind + "_delay", kind, 1.0 - 2.0 * _tail(abs(late) / sigma),
                   0.5 * (late / sigma) ** 2, "take %.1f ms of delay out of it" % ms,
                   value={"delay": ms}, unit="ms", interval_90={
                       "delay": (ms - 1645.0 * sigma, ms + 1645.0 * sigma)})


def _tail(z):
    return 0.5 * erfc(z / 2.0 ** 0.5)
