"""The effect put back as settings of simulators, as far as their own settings reach."""
import json

import numpy as np

from . import put_back

AXES = "xyz"
MATLAB_C = 25.0  # of accelparams and gyroparams, [imuSensor, Algorithms]


def lacking(sensor, expressed):
    """Names of what is found and not among the kinds of things that a target expresses."""
    return [name for name in sensor.holds
            if not any(name.startswith(kind) for kind in expressed)]


def per_sample(sensor, triad):
    """(3,) standard deviation of a sample."""
    return triad.noise * np.sqrt(sensor.rate_hz)


def row(values, form="%.6g", between=" "):
    return between.join(form % x for x in values)


def gz(sensor):
    """<sensor type="imu"> of SDF; the signed bias stands in <mean>, since <bias_mean> has its
    sign drawn. https://sdformat.org/spec, imu.sdf and noise.sdf."""
    cannot = lacking(sensor, ("bias", "noise", "step", "lever arm"))
    lines = ['<?xml version="1.0"?>', "<!--\n%s-->" % put_back.header(sensor, " ", cannot),
             '<sdf version="1.7">', ' <model name="imu">', '  <link name="imu_link">',
             '   <sensor name="imu" type="imu">',
             "    <pose>%s 0 0 0</pose>" % row(sensor.lever),
             "    <update_rate>%.6g</update_rate>" % sensor.rate_hz, "    <imu>"]
    for name, triad in (("angular_velocity", sensor.gyro), ("linear_acceleration", sensor.accel)):
        lines.append("     <%s>" % name)
        for i, axis in enumerate(AXES):
            kind = "gaussian_quantized" if triad.step[i] > 0 else "gaussian"
            lines += ["      <%s>" % axis, '       <noise type="%s">' % kind,
                      "        <mean>%.6g</mean>" % triad.bias[i],
                      "        <stddev>%.6g</stddev>" % per_sample(sensor, triad)[i]]
            if triad.step[i] > 0:
                lines.append("        <precision>%.6g</precision>" % triad.step[i])
            lines += ["       </noise>", "      </%s>" % axis]
        lines.append("     </%s>" % name)
    return "\n".join(lines + ["    </imu>", "   </sensor>", "  </link>", " </model>", "</sdf>",
                              ""])


def mujoco(sensor):
    """MJCF: a site at the lever arm and its two sensors; cutoff is the range. Since 3.1.4 the
    engine adds no noise: the attribute is for whoever reads the model."""
    cannot = lacking(sensor, ("lever arm", "range"))
    lines = ["<mujoco>", "<!--\n%s  the rest: sixflip export with the target numpy, applied to "
             "data.sensordata\n-->" % put_back.header(sensor, " ", cannot),
             " <worldbody>", "  <!-- the site goes into the body that carries the sensor -->",
             '  <body name="imu_body">', '   <site name="imu" pos="%s"/>' % row(sensor.lever),
             "  </body>", " </worldbody>", " <sensor>"]
    for name, triad in (("accelerometer", sensor.accel), ("gyro", sensor.gyro)):
        limit = triad.limit.min()
        lines.append('  <%s name="imu_%s" site="imu"%s noise="%.6g"/>' % (
            name, name, ' cutoff="%.6g"' % limit if np.isfinite(limit) else "",
            per_sample(sensor, triad).max()))
    return "\n".join(lines + [" </sensor>", "</mujoco>", ""])


def genesis(sensor):
    """Options of gs.sensors.IMU; noise a sample, skew as rows of the matrix."""
    cannot = lacking(sensor, ("bias", "noise", "step", "lever arm", "scale", "delay"))
    lines = ["import genesis as gs", "", "", "def imu(entity_idx):",
             '    """The sensor for scene.add_sensor()."""', "    return gs.sensors.IMU(",
             "        entity_idx=entity_idx,",
             "        pos_offset=(%s)," % row(sensor.lever, between=", ")]
    for short, triad in (("acc", sensor.accel), ("gyro", sensor.gyro)):
        lines += ["        %s_bias=(%s)," % (short, row(triad.bias, between=", ")),
                  "        %s_noise=(%s)," % (short, row(per_sample(sensor, triad), between=", ")),
                  "        %s_resolution=(%s)," % (short, row(triad.step, between=", ")),
                  "        %s_cross_axis_coupling=(%s)," % (short, ", ".join(
                      "(%s)" % row(r, between=", ") for r in triad.matrix))]
    delay = max(sensor.accel.delay_s, sensor.gyro.delay_s)
    both = sensor.accel.delay_s == sensor.gyro.delay_s
    if delay and not both:
        cannot = cannot + ["a delay of one sensor alone"]
    lines += ["        delay=%.6g," % (delay if both else 0.0), "    )", ""]
    return put_back.header(sensor, "#", cannot) + "\n".join(lines)


def isaaclab(sensor):
    """ImuCfg and the noise of the observation terms that read it."""
    cannot = lacking(sensor, ("bias", "noise", "lever arm"))
    lines = ["from isaaclab.sensors import ImuCfg", "from isaaclab.utils.noise import (",
             "    GaussianNoiseCfg,", ")", "import torch", "",
             "IMU = ImuCfg(", '    prim_path="{ENV_REGEX_NS}/Robot/imu_link",',
             "    update_period=%.6g," % (1.0 / sensor.rate_hz),
             "    offset=ImuCfg.OffsetCfg(pos=(%s))," % row(sensor.lever, between=", "), ")", ""]
    for name, triad in (("LIN_ACC_NOISE", sensor.accel), ("ANG_VEL_NOISE", sensor.gyro)):
        lines += ["# noise= of the ObsTerm of imu_%s" % ("lin_acc" if "LIN" in name else
                                                        "ang_vel"),
                  "%s = GaussianNoiseCfg(" % name,
                  "    mean=torch.tensor([%s])," % row(triad.bias, between=", "),
                  "    std=torch.tensor([%s])," % row(per_sample(sensor, triad), between=", "),
                  '    operation="add",', ")", ""]
    return put_back.header(sensor, "#", cannot) + "\n".join(lines)


def matlab(sensor):
    """JSON for loadparams(imuSensor, file, "sixflip"): fields of accelparams and gyroparams.

    Their temperature's effects count from 25 degC. A density N whose samples have N sqrt(rate) is
    a double-sided one. AccelerationBias acts by the linear acceleration, without gravity.
    """
    cannot = lacking(sensor, ("bias", "noise", "step", "range", "scale", "thermal_bias",
                              "thermal_scale"))
    parts = {}
    for name, triad in (("Accelerometer", sensor.accel), ("Gyroscope", sensor.gyro)):
        limit = triad.limit.min()
        bias, scale = (triad.effects.get(effect, put_back.Added({})).vector() for effect in (
            "thermal_bias", "thermal_scale"))
        cooler = MATLAB_C - sensor.reference_c
        part = {"ConstantBias": (triad.bias + cooler * bias).tolist(),
                "AxesMisalignment": (100.0 * triad.matrix * (
                    1.0 + cooler * scale)[:, None]).tolist(),
                "NoiseDensity": triad.noise.tolist(), "NoiseType": "double-sided",
                "Resolution": float(triad.step.max()), "TemperatureBias": bias.tolist(),
                "TemperatureScaleFactor": (100.0 * scale).tolist()}
        if np.isfinite(limit):
            part["MeasurementRange"] = float(limit)
        parts[name] = part
    about = put_back.header(sensor, "", cannot).strip().split("\n")
    return json.dumps({"about": [line.strip() for line in about], "sixflip": parts},
                      indent=1) + "\n"


def kalibr(sensor):
    """imu.yaml: two densities of the noise to add, one number for three axes."""
    cannot = lacking(sensor, ("noise",))
    return put_back.header(sensor, "#", cannot) + (
        "rostopic: /imu0\nupdate_rate: %.6g  # Hz\n"
        "accelerometer_noise_density: %.6g  # m/s^2/sqrt(Hz)\n"
        "accelerometer_random_walk: 0.0  # not measured\n"
        "gyroscope_noise_density: %.6g  # rad/s/sqrt(Hz)\n"
        "gyroscope_random_walk: 0.0  # not measured\n") % (
            sensor.rate_hz, sensor.accel.noise.max(), sensor.gyro.noise.max())
