"""What each target of `sixflip export` makes of a simulator's forces and rates, read back out of
the exported file.

numpy is the exported class itself, and MuJoCo's snippet is compiled by MuJoCo. The engines of the
others are not here: their documented models are written down below, field by field.
"""
import ast
import json
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from types import SimpleNamespace

import mujoco
import numpy as np

MATLAB_C = 25.0  # degC that accelparams and gyroparams have their temperature's effects from


@dataclass(frozen=True)
class Target:
    """arm (3,) m: where the sensor is put in the engine; cutoff: (accelerometer, gyro) of the
    engine's own sensors, 0 for none; read: function(force (n, 3) m/s2, rate (n, 3) rad/s,
    celsius (n,), rate_hz, Generator) to (force, rate)."""

    arm: np.ndarray = None
    cutoff: tuple = (0.0, 0.0)
    read: object = lambda force, rate, celsius, rate_hz, rng: (force, rate)


def numpy_class(text):
    """The exported ImuModel, a step for each row."""
    space = {}
    exec(text, space)

    def read(force, rate, celsius, rate_hz, rng):
        model = space["ImuModel"](int(rng.integers(1 << 31)))
        rows = [model.step(f, w, c, 1.0 / rate_hz) for f, w, c in zip(force, rate, celsius)]
        return tuple(np.array(x) for x in zip(*rows))
    return Target(read=read)


def gz(text):
    """<pose> of the sensor; a sample gets a draw of <mean> and <stddev> and is rounded to
    <precision> where the type is gaussian_quantized (sdformat 1.7, imu.sdf and noise.sdf)."""
    sensor = ElementTree.fromstring(text).find("model/link/sensor")

    def triad(name):
        noises = [sensor.find("imu/%s/%s/noise" % (name, axis)) for axis in "xyz"]
        mean, sigma = ([float(n.find(tag).text) for n in noises] for tag in ("mean", "stddev"))
        step = [float(n.find("precision").text) if n.get("type") == "gaussian_quantized" else 0.0
                for n in noises]
        return np.array(mean), np.array(sigma), np.array(step)
    parts = [triad(name) for name in ("linear_acceleration", "angular_velocity")]

    def read(force, rate, celsius, rate_hz, rng):
        return tuple(rounded(x + mean + sigma * rng.normal(size=x.shape), step)
                     for x, (mean, sigma, step) in zip((force, rate), parts))
    return Target(np.array([float(v) for v in sensor.find("pose").text.split()[:3]]), read=read)


def mjcf(text):
    """Compiled by MuJoCo: the site's place and the sensors' cutoff; it adds no noise."""
    model = mujoco.MjModel.from_xml_string(text)
    return Target(np.array(model.site_pos[0]), tuple(float(x) for x in model.sensor_cutoff))


def genesis(text):
    """Options of gs.sensors.IMU by keyword: cross-axis coupling, a 3 x 3 matrix taken as it is,
    then the delay of both, bias, noise of a sample, resolution (genesis/options/sensors)."""
    space = {"gs": SimpleNamespace(sensors=SimpleNamespace(IMU=lambda **given: given))}
    exec(text.replace("import genesis as gs\n", ""), space)
    given = space["imu"](0)

    def read(force, rate, celsius, rate_hz, rng):
        late = int(round(given["delay"] * rate_hz))
        out = []
        for name, x in (("acc", force), ("gyro", rate)):
            x = x @ np.array(given[name + "_cross_axis_coupling"]).T
            x = np.concatenate([np.repeat(x[:1], late, 0), x[:len(x) - late]])
            x = x + given[name + "_bias"] + np.array(given[name + "_noise"]) * rng.normal(
                size=x.shape)
            out.append(rounded(x, np.array(given[name + "_resolution"])))
        return tuple(out)
    return Target(np.array(given["pos_offset"]), read=read)


def isaaclab(text):
    """ImuCfg.OffsetCfg, and GaussianNoiseCfg of the observations: data + mean + std times a
    normal number (isaaclab.utils.noise)."""
    def numbers(pattern):
        return np.array(ast.literal_eval(re.search(pattern, text).group(1)), float)
    arm = numbers(r"OffsetCfg\(pos=(\(.*?\))\)")
    parts = [[numbers(name + r"_NOISE = (?:.*\n)*?.*?" + field + r"=torch\.tensor\((\[.*?\])\)")
              for field in ("mean", "std")] for name in ("LIN_ACC", "ANG_VEL")]

    def read(force, rate, celsius, rate_hz, rng):
        return tuple(x + mean + std * rng.normal(size=x.shape)
                     for x, (mean, std) in zip((force, rate), parts))
    return Target(arm, read=read)


def matlab(text):
    """accelparams and gyroparams as imuSensor uses them: misalignment, bias, white noise, bias
    by temperature, scale by temperature, range, resolution, in that order (imuSensor,
    Algorithms). Density: a sample has N sqrt(rate) where it is double-sided, and half of that
    power where it is single-sided."""
    given = json.loads(text)["sixflip"]

    def read(force, rate, celsius, rate_hz, rng):
        out, warm = [], (celsius - MATLAB_C)[:, None]
        for name, x in (("Accelerometer", force), ("Gyroscope", rate)):
            p = given[name]
            sides = 2.0 if p["NoiseType"] == "double-sided" else 1.0
            x = x @ (np.array(p["AxesMisalignment"]) / 100.0).T + p["ConstantBias"]
            x = x + np.array(p["NoiseDensity"]) * np.sqrt(rate_hz / 2.0 * sides) * rng.normal(
                size=x.shape) + warm * p["TemperatureBias"]
            x = x * (1.0 + warm / 100.0 * p["TemperatureScaleFactor"])
            limit = p.get("MeasurementRange", np.inf)
            out.append(rounded(np.clip(x, -limit, limit), np.full(3, p["Resolution"])))
        return tuple(out)
    return Target(read=read)


def kalibr(text):
    """Two densities: a sample has N sqrt(rate) (Kalibr's wiki, IMU noise model)."""
    density = [float(re.search("%s_noise_density: (.*?) " % name, text).group(1))
               for name in ("accelerometer", "gyroscope")]

    def read(force, rate, celsius, rate_hz, rng):
        return tuple(x + d * np.sqrt(rate_hz) * rng.normal(size=x.shape)
                     for x, d in zip((force, rate), density))
    return Target(read=read)


def rounded(x, step):
    """x (n, 3) in steps (3,), 0 for none."""
    wide = np.where(step > 0, step, 1.0)
    return np.where(step > 0, np.round(x / wide) * wide, x)


TARGETS = {"numpy": numpy_class, "gz": gz, "mujoco": mjcf, "genesis": genesis,
           "isaaclab": isaaclab, "matlab": matlab, "kalibr": kalibr}


def cannot(text):
    """What the exported file itself says that its target cannot express, [] for nothing."""
    said = re.search(r"this target cannot express: ([^\n\"]*)", text)
    return [name.strip() for name in said.group(1).split(",")] if said else []
