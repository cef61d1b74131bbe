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
NAMES = {"accel": "linear_acceleration", "gyro": "angular_velocity"}


def capture_sdf(path, output):
    """Write a <sensor type="imu"> for Gazebo."""
    capture = capture_file.read_samples(path)
    atomic_write.write_text(output, sdf(measure(capture), capture.meta))


def capture_kalibr(path, output):
    """Write an imu.yaml."""
    capture = capture_file.read_samples(path)
    atomic_write.write_text(output, kalibr(measure(capture), capture.meta))


def capture_table(path, output):
    """Write the plain table."""
    capture = capture_file.read_samples(path)
    effects = capture.meta.get("effects", [])
    atomic_write.write_text(output, plain_table(measure(capture), capture.meta, effects))


def sdf(found, meta):
    """Gazebo's GaussianNoiseModel: stddev is per sample, the dynamic bias a Gauss-Markov process
    whose driving noise has the density dynamic_bias_stddev (as in Kalibr's wiki)."""
    lines = ['<?xml version="1.0"?>',
             "<!-- %s at %g Hz. stddev = N sqrt(rate), m/s2 and rad/s a sample; precision = one"
             % (meta["sensor"], meta["rate_hz"]),
             "     count; bias_mean: what is read when nothing acts (Gazebo draws its sign).",
             "     dynamic_bias_stddev = K, unit/s/sqrt(Hz). Scale and misalignment have no place",
             "     in SDF: see the table. -->",
             '<sdf version="1.7">', ' <sensor name="imu" type="imu">',
             "  <update_rate>%g</update_rate>" % meta["rate_hz"], "  <imu>"]
    for kind, triad in found.items():
        lines.append("   <%s>" % NAMES[kind])
        for i, axis in enumerate("xyz"):
            lines += ["    <%s>" % axis, '     <noise type="gaussian_quantized">',
                      "      <mean>0</mean>",
                      "      <stddev>%.6g</stddev>" % (triad.density[i]
                                                       * np.sqrt(meta["rate_hz"])),
                      "      <bias_mean>%.6g</bias_mean>" % abs(triad.bias[i]),
                      "      <bias_stddev>0</bias_stddev>"]
            if triad.walk is None:
                lines.append("      <!-- dynamic bias %s -->" % NOT_MEASURED)
            else:
                lines += ["      <dynamic_bias_stddev>%.6g</dynamic_bias_stddev>"
                          % triad.walk[i],
                          "      <dynamic_bias_correlation_time>%g"
                          "</dynamic_bias_correlation_time>" % CORRELATION_S]
            lines += ["      <precision>%.6g</precision>" % triad.step[i], "     </noise>",
                      "    </%s>" % axis]
        lines.append("   </%s>" % NAMES[kind])
    return "\n".join(lines + ["  </imu>", " </sensor>", "</sdf>", ""])


def kalibr(found, meta):
    """Kalibr's imu.yaml: continuous-time densities, one number for the three axes: the largest."""
    lines = ["# %s. Densities in continuous time; per sample they are N sqrt(rate) and"
             % meta["sensor"],
             "# K / sqrt(rate). One number for three axes: the largest of them.",
             "rostopic: /imu0", "update_rate: %g  # Hz" % meta["rate_hz"]]
    for kind, word, unit in (("accel", "accelerometer", "m/s^2"), ("gyro", "gyroscope", "rad/s")):
        if kind not in found:
            lines.append("# no %s in this capture" % word)
            continue
        triad = found[kind]
        lines.append("%s_noise_density: %.6g  # N = adev(tau) sqrt(tau), %s/sqrt(Hz)"
                     % (word, triad.density.max(), unit))
        if triad.walk is None:
            lines.append("# %s_random_walk %s" % (word, NOT_MEASURED))
        else:
            lines.append("%s_random_walk: %.6g  # K = adev(tau) sqrt(3 / tau), %s/s/sqrt(Hz)"
                         % (word, triad.walk.max(), unit))
    return "\n".join(lines) + "\n"


def plain_table(found, meta, effects=()):
    """One line a quantity: name, three values or nine, unit, formula."""
    lines = ["# %s, %g Hz. measured = M true + bias + noise; tab-separated." % (
        meta["sensor"], meta["rate_hz"]), "quantity\tx\ty\tz\tunit\tformula"]
    for kind, triad in found.items():
        unit = triad.unit
        if triad.matrix is None:
            lines.append("%s M\t\t\t\t1\tnot measured: no flips about all three axes" % kind)
        for row in range(0 if triad.matrix is None else 3):
            lines.append(line("%s M row %s" % (kind, "xyz"[row]), triad.matrix[row], "1",
                              "inverse of the calibration's matrix"))
        lines += [line(kind + " bias", triad.bias, unit, "read when nothing acts: -v"),
                  line(kind + " noise density N", triad.density, unit + "/sqrt(Hz)",
                       "median of adev(tau) sqrt(tau), tau to 1 s"),
                  line(kind + " noise a sample", triad.per_sample, unit,
                       "Allan deviation at 1/rate"),
                  line(kind + " bias instability B", triad.floor, unit, "least adev / 0.664")]
        if triad.walk is None:
            lines.append("%s random walk K\t\t\t\t%s/s/sqrt(Hz)\t%s" % (kind, unit, NOT_MEASURED))
        else:
            lines.append(line(kind + " random walk K", triad.walk, unit + "/s/sqrt(Hz)",
                              "adev(tau) sqrt(3 / tau), white part removed"))
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
