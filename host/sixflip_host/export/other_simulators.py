"""A board's noise and bias for other simulators: Gazebo SDF, Kalibr and ROS, a plain table.

Every number is written with its formula and unit; what was not measured is left out and said.
"""
import numpy as np

from sixflip_sim.effects.library import make as make_effect

from .. import atomic_write
from ..capture import capture_file
from .noise_model import measure

CORRELATION_S = 300.0  # of Gazebo's dynamic bias; the walk is the same below it
NOT_MEASURED = "not measured: no rest of a minute in the capture"
NO_BIAS = "not measured: one attitude does not tell bias from tilt"
NAMES = {"accel": "linear_acceleration", "gyro": "angular_velocity"}


def capture_sdf(path, output):
    """Write a <sensor type="imu"> for Gazebo."""
    capture = _read(path)
    atomic_write.write_text(output, sdf(measure(capture), capture.meta))


def capture_kalibr(path, output):
    """Write an imu.yaml."""
    capture = _read(path)
    atomic_write.write_text(output, kalibr(measure(capture), capture.meta))


def capture_table(path, output):
    """Write the plain table."""
    capture = _read(path)
    effects = capture.meta.get("effects", [])
    atomic_write.write_text(output, plain_table(measure(capture), capture.meta, effects))


def _read(path):
    """The capture with all its samples; a gyro alone will do."""
    return capture_file.with_samples(path, capture_file.read(path, gyro_alone=True))


def sdf(triads, meta):
    """Gazebo's GaussianNoiseModel: stddev is per sample, the dynamic bias a Gauss-Markov process
    whose driving noise has the density dynamic_bias_stddev (as in Kalibr's wiki)."""
    lines = ['<?xml version="1.0"?>',
             "<!-- %s at %g Hz. stddev = N sqrt(rate), m/s2 and rad/s a sample; precision = one"
             % (meta["sensor"], meta["rate_hz"]),
             "     count; mean: what is read when nothing acts, with its sign (of a bias_mean",
             "     Gazebo draws the sign). dynamic_bias_stddev = K, unit/s/sqrt(Hz). Scale and",
             "     misalignment have no place in SDF: see the table. -->",
             '<sdf version="1.7">', ' <sensor name="imu" type="imu">',
             "  <update_rate>%g</update_rate>" % meta["rate_hz"], "  <imu>"]
    for kind, triad in triads.items():
        lines.append("   <%s>" % NAMES[kind])
        counted = meta.get(kind + "_values") != "float"  # else counts are the import's own
        for i, axis in enumerate("xyz"):
            lines += ["    <%s>" % axis, '     <noise type="%s">' % (
                          "gaussian_quantized" if counted else "gaussian"),
                      *_mean(triad, i),
                      "      <stddev>%.6g</stddev>" % (triad.density[i]
                                                       * np.sqrt(meta["rate_hz"])),
                      "      <bias_mean>0</bias_mean>", "      <bias_stddev>0</bias_stddev>"]
            if triad.walk is None:
                lines.append("      <!-- dynamic bias %s -->" % NOT_MEASURED)
            else:
                lines += ["      <dynamic_bias_stddev>%.6g</dynamic_bias_stddev>"
                          % triad.walk[i],
                          "      <dynamic_bias_correlation_time>%g"
                          "</dynamic_bias_correlation_time>" % CORRELATION_S]
            if counted:
                lines.append("      <precision>%.6g</precision>" % triad.step[i])
            lines += ["     </noise>", "    </%s>" % axis]
        lines.append("   </%s>" % NAMES[kind])
    return "\n".join(lines + ["  </imu>", " </sensor>", "</sdf>", ""])


def _mean(triad, i):
    """The signed bias of an axis, where the capture tells it."""
    if triad.bias is None:
        return ["      <!-- mean %s -->" % NO_BIAS, "      <mean>0</mean>"]
    return ["      <mean>%.6g</mean>" % triad.bias[i]]


def kalibr(triads, meta):
    """Kalibr's imu.yaml: continuous-time densities, one number for the three axes: the largest."""
    lines = ["# %s. Densities in continuous time; per sample they are N sqrt(rate) and"
             % meta["sensor"],
             "# K / sqrt(rate). One number for three axes: the largest of them.",
             "rostopic: /imu0", "update_rate: %g  # Hz" % meta["rate_hz"]]
    for kind, word, unit in (("accel", "accelerometer", "m/s^2"), ("gyro", "gyroscope", "rad/s")):
        if kind not in triads:
            lines.append("# no %s in this capture" % word)
            continue
        triad = triads[kind]
        lines.append("%s_noise_density: %.6g  # N, %s/sqrt(Hz); %s"
                     % (word, triad.density.max(), unit, _span(triad, "density")))
        if triad.walk is None:
            lines.append("# %s_random_walk %s" % (word, NOT_MEASURED))
        else:
            lines.append("%s_random_walk: %.6g  # K, %s/s/sqrt(Hz); %s"
                         % (word, triad.walk.max(), unit, _span(triad, "walk")))
        lines.append("# bias instability B (Kalibr has no place for it): %.6g %s; %s"
                     % (triad.floor.max(), unit, _span(triad, "floor")))
    return "\n".join(lines) + "\n"


def _span(triad, name):
    """The 90 % interval of the largest of three axes, in words."""
    axis = int(np.argmax(getattr(triad, name)))
    low, high = triad.intervals[name][:, axis]
    return "90 %%: %.3g to %.3g, from %.0f s at rest" % (low, high, triad.seconds)


def _levels(kind, triad, unit):
    """Lines of N, B and K, each with its interval."""
    for name, words, per in (("density", "noise density N", "/sqrt(Hz)"),
                             ("floor", "bias instability B", ""),
                             ("walk", "random walk K", "/s/sqrt(Hz)")):
        values = getattr(triad, name)
        if values is None:
            yield "%s %s\t\t\t\t%s%s\t%s" % (kind, words, unit, per, NOT_MEASURED)
            continue
        yield line("%s %s" % (kind, words), values, unit + per, FORMULAS[name])
        for end, bound in zip(("low", "high"), triad.intervals[name]):
            yield line("%s %s, %s" % (kind, words, end), bound, unit + per, "of 90 %")


FORMULAS = {"density": "S(f) = N^2 at rest, likeliest in the spectrum",
            "floor": "S(f) = B^2 / (2 pi f); Allan deviation 0.664 B",
            "walk": "S(f) = K^2 / (2 pi f)^2; Allan deviation K sqrt(tau / 3)"}


def plain_table(triads, meta, effects=()):
    """One line a quantity: name, three values or nine, unit, formula."""
    lines = ["# %s, %g Hz. measured = M true + bias + noise; tab-separated." % (
        meta["sensor"], meta["rate_hz"]), "quantity\tx\ty\tz\tunit\tformula"]
    for kind, triad in triads.items():
        unit = triad.unit
        if triad.matrix is None:
            lines.append("%s M\t\t\t\t1\tnot measured: no flips about all three axes" % kind)
        for row in range(0 if triad.matrix is None else 3):
            lines.append(line("%s M row %s" % (kind, "xyz"[row]), triad.matrix[row], "1",
                              "inverse of the calibration's matrix"))
        if triad.bias is None:
            lines.append("%s bias\t\t\t\t%s\t%s" % (kind, unit, NO_BIAS))
        else:
            lines.append(line(kind + " bias", triad.bias, unit, "read when nothing acts: -v"))
        lines.append(line(kind + " noise a sample", triad.per_sample, unit,
                          "Allan deviation at 1/rate"))
        lines += _levels(kind, triad, unit)
        lines.append(line(kind + " step", triad.step, unit, "common divisor of all counts"))
    for spec in effects:
        lines.append(effect_line(spec))
    return "\n".join(lines) + "\n"


def line(name, values, unit, formula):
    return "%s\t%s\t%s\t%s" % (name, "\t".join("%.6g" % v for v in values), unit, formula)


def effect_line(spec):
    """One effect: its sizes by key, unit, and the formula its class states."""
    effect = make_effect(spec)
    formula = (effect.__doc__ or "").split("\n")[0].rstrip(".")
    sizes = ["%s=%.6g" % (key, effect.values[key]) for key in effect.values]
    return "%s %s\t%s\t\t\t%s\t%s" % (effect.sensor, effect.name, " ".join(sizes),
                                      effect.units[effect.sensor], formula)
