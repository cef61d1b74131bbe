"""Layer two of what is in time, of logs of one motion: the delay between the sensors, the low-pass
of each, and the clock. Differences only, each with what to do.
"""
from dataclasses import dataclass, replace
from math import erfc

import numpy as np

from ...experiment.low_pass import FIRST_ORDER, LATE, LowPass
from . import convention_findings, parameters

# An engine whose rates are half a physics step older than its forces (MuJoCo, Featherstone's
# semi-implicit step) differs from itself by as much at two step sizes of 1 and 2 ms.
LEAST_DELAY_MS = 0.5
LEAST_SMOOTH_MS2 = 3.0  # half the square of a time constant of 2.4 ms
# Quartz is within 50 ppm of its frequency (boards' crystals have 10 to 50 in their data sheets),
# and two logs have one each: so much is no simulator's fault, and nothing to set.
QUARTZ = 1e-4
LATE_SIGMA = 4.0  # standard errors from which on a delay is one: by chance in 1 of 16,000 (normal)


@dataclass(frozen=True)
class Smoothness:
    """Of a sensor of the simulator's log, beside the real one: the Parameter told, the LowPass
    that it says, or None, and the standard error of the time constant of such a one."""

    told: parameters.Parameter
    low_pass: LowPass
    sigma_s: float

    @property
    def late_s(self):
        """By how much the low-pass makes the sensor later."""
        return 0.0 if self.low_pass is None else self.low_pass.late_s


def smoothness(fits, freed):
    """{sensor: Smoothness} of SensorFits that have a name; freed {sensor: s2}: half the square of
    the time constant by which the straight lines that stand for repeated rows make the simulator's
    log smoother than the real one."""
    every = {}
    for kind, sensor_fit in fits.items():
        if any(c.name == "unknown" for c in sensor_fit.conventions):
            continue
        fit, low_pass = sensor_fit.fit, sensor_fit.low_pass
        s2, sigma = fit.smooth_s2 - freed.get(kind, 0.0), fit.smooth_sigma_s2
        s2 += 0.0 if low_pass is None else low_pass.half_square_s2
        apart = s2 / np.hypot(sigma, 1e-6 * LEAST_SMOOTH_MS2)
        told = parameters.compared(
            "smoothness", kind, "", "ms²", None, np.inf, None, np.inf, -1e6 * s2, 1e6 * sigma,
            least=LEAST_SMOOTH_MS2,
            apart=np.sqrt(max(apart ** 2 - sensor_fit.smoothing_earns, 0.0)))
        said = None
        if told.differs:
            said = LowPass.of_half_square(s2, low_pass.form if low_pass else FIRST_ORDER)
            told = replace(told, how=smoother(said), form=said.form)
        every[kind] = Smoothness(told, said, 0.5 * said.seconds * sigma / abs(s2) if said else 0.0)
    return every


def compared(late, late_sigma, smoothed, alignment):
    """[Parameter]: delay between the sensors, smoothness {sensor: Smoothness} of each, clock."""
    numbers = []
    if late is not None:
        numbers.append(with_how(parameters.compared(
            "delay", "gyro", "", "ms", None, np.inf, None, np.inf, -1e3 * late, 1e3 * late_sigma,
            least=LEAST_DELAY_MS), later))
    numbers += [x.told for x in smoothed.values()]
    if alignment.same:
        numbers.append(with_how(parameters.compared(
            "clock", "device", "", "%", None, np.inf, None, np.inf, -100.0 * alignment.drift,
            100.0 * alignment.drift_sigma,
            apart=(abs(alignment.drift) - QUARTZ) / alignment.drift_sigma), faster))
    return numbers


def slope(fits):
    """[Parameter]: degrees by which the floor of one log slopes more than the other's."""
    fit = fits["accel"].fit if "accel" in fits else None
    if fit is None or not fit.hypothesis.slopes:
        return []
    size = float(np.hypot(*fit.extra))
    sigma = float(np.hypot(*(fit.extra * fit.extra_sigma))) / max(size, 1e-12)
    return [with_how(parameters.compared(
        "slope", "device", "", "°", None, np.inf, None, np.inf, np.degrees(np.arctan(size)),
        np.degrees(sigma)), "lean its floor, or its gravity, by {:.2f}° otherwise".format)]


def with_how(parameter, how):
    """The Parameter with what to do where it differs."""
    return replace(parameter, how=how(parameter.difference)) if parameter.differs else parameter


def later(ms):
    """What to do about a delay between the sensors: gyro after accelerometer, or the reverse."""
    return "output the %s %.3g ms later" % ("gyro" if ms > 0 else "accelerometer", abs(ms))


def smoother(low_pass):
    """What to do about a LowPass that one of the logs has."""
    return "put a %s behind it" % low_pass.words if low_pass.of == "real" else \
        "it is smoother than the sensor by a %s: take as much out" % low_pass.words


def faster(percent):
    """What to do about a clock that runs this much faster than the real one."""
    return "multiply its times by %.6g" % (1.0 - percent / 100.0)


def delay(sensor_fits, row_s, smoothed):
    """(seconds by which the gyro is later than the accelerometer, more than the real sensor's, and
    than the low-passes told make it, which is not to be put right twice; standard error), and the
    Convention where it is a row or more; smoothed {sensor: Smoothness}."""
    # A fit without a name has the signal's derivatives beside it, which take any delay for theirs.
    if len(sensor_fits) < 2 or any(
            c.name == "unknown" for f in sensor_fits.values() for c in f.conventions):
        return None, None, []
    a, g = sensor_fits["accel"].fit, sensor_fits["gyro"].fit
    whole, own = g.delay_s - a.delay_s, float(np.hypot(a.delay_sigma_s, g.delay_sigma_s))
    beyond = whole - smoothed["gyro"].late_s + smoothed["accel"].late_s
    # Where only one sensor shows a low-pass that both have, they are late together.
    late, sigma = min((whole, own), (beyond, float(np.linalg.norm([own, *(
        LATE[x.low_pass.form] * x.sigma_s for x in smoothed.values() if x.low_pass)]))),
        key=lambda told: abs(told[0]) / told[1])
    findings = [late_one(late, sigma)] if abs(late) > LATE_SIGMA * sigma and (
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
