"""What is done today without a model of the sensor, put to the same pairs of logs.

Each takes (force, rate) of the real log and of the simulator's on one grid (m/s2, rad/s, already
aligned in time by the diagnosis' own offset, which is a present to them) and says one name of the
zoo, or "" for nothing. None of them can say that something is there which it has no name for.
"""
import contextlib
import io
from dataclasses import dataclass

import numpy as np

RATE_HZ = 100.0
SLOW_S = 1.0            # a moving average over so long is taken for gravity
# Beyond which a fitted number is said to be wrong. The zero level of a part and its scale are not:
# MPU-6050 PS rev 3.4, tables 6.1 and 6.2 (3 % scale, 80 mg and 20 deg/s).
GAIN, BIAS_FORCE, BIAS_RATE, DELAY_S = 0.09, 2.4, 1.05, 0.015


@dataclass(frozen=True)
class Pair:
    """t (n,) s; of the real log and of the simulator's: force (n, 3) m/s2, rate (n, 3) rad/s."""

    t: np.ndarray
    force: np.ndarray
    rate: np.ndarray
    sim_force: np.ndarray
    sim_rate: np.ndarray


def paired(real, sim, aligned):
    """The Pair of two Traces of one motion."""
    at = aligned.of_simulator(sim.t)
    t = np.arange(max(real.t[0], at[0]), min(real.t[-1], at[-1]), 1.0 / RATE_HZ)

    def on(times, values):
        return np.column_stack([np.interp(t, times, x) for x in values.T])
    return Pair(t, on(real.t, real.force), on(real.t, real.rate), on(at, sim.force),
                on(at, sim.rate))


def residual_rms(pair):
    """The channel that is off the most for its own size; a channel is no name."""
    left = np.hstack([pair.sim_force - pair.force, pair.sim_rate - pair.rate])
    size = np.hstack([pair.force, pair.rate]).std(axis=0)
    return "channel " + ("fx", "fy", "fz", "wx", "wy", "wz")[
        int((left.std(axis=0) / np.maximum(size, 1e-9)).argmax())]


def largest_correlation(pair, least=0.5):
    """The signal that any channel of the difference goes along with the most."""
    wide = int(SLOW_S * RATE_HZ) | 1
    up = np.column_stack([np.convolve(np.pad(x, wide // 2, mode="edge"), np.ones(wide) / wide,
                                      "valid") for x in pair.force.T])
    slope = [np.gradient(x, 1.0 / RATE_HZ, axis=0) for x in (pair.force, pair.rate)]
    spin = pair.rate * np.linalg.norm(pair.rate, axis=1)[:, None]
    signals = {
        "accel": {"no_gravity": (up, True), "time_step": (pair.force - up, True),
                  "accel_unit": (pair.force, True), "accel_axes": (pair.force, False),
                  "accel_delay": (slope[0], True), "lever_arm_missing": (slope[1], False),
                  "no_centripetal_term": (spin, False)},
        "gyro": {"gyro_unit": (pair.rate, True), "gyro_axes": (pair.rate, False),
                 "gyro_delay": (slope[1], True)}}
    best, said = least, ""
    for kind, left in (("accel", pair.sim_force - pair.force),
                       ("gyro", pair.sim_rate - pair.rate)):
        for name, (signal, own) in signals[kind].items():
            for i in range(3):
                for j in range(3):
                    if (i == j) != own and name not in ("lever_arm_missing",
                                                        "no_centripetal_term"):
                        continue
                    size = abs(correlation(left[:, i], signal[:, j]))
                    if size > best:
                        best, said = size, name
    return said


def correlation(a, b):
    a, b = a - a.mean(), b - b.mean()
    scale = np.sqrt((a @ a) * (b @ b))
    return a @ b / scale if scale > 0 else 0.0


def mujoco_sysid(pair):
    """mujoco.sysid with what it has for a sensor: gain, bias and delay of each, fitted by its own
    optimizer; what lies beyond any part's tolerance is said. None where it is not installed
    (pip install 'mujoco[sysid]')."""
    try:
        import mujoco
        from mujoco import sysid
        sysid.SignalTransform  # noqa: B018  its imports fail silently
    except (ImportError, AttributeError):
        return None
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><freejoint/><geom size="1"/><site name="s"/></body></worldbody>'
        '<sensor><accelerometer name="accel" site="s"/><gyro name="gyro" site="s"/></sensor>'
        '</mujoco>')
    sensors = sysid.TimeSeries.compute_all_sensor_mapping(model)
    t = pair.t - pair.t[0]
    simulated = sysid.TimeSeries(t, np.hstack([pair.sim_force, pair.sim_rate]), sensors)
    real = sysid.TimeSeries(t, np.hstack([pair.force, pair.rate]), sensors)
    parameters, transform = sysid.ParameterDict(), sysid.SignalTransform()
    for kind, bias in (("accel", 30.0), ("gyro", 10.0)):
        for what, nominal, low, high in (("gain", [1.0] * 3, -80.0, 80.0),
                                         ("bias", [0.0] * 3, -bias, bias),
                                         ("delay", [0.0], -0.1, 0.1)):
            size = len(nominal)
            parameters.add(sysid.Parameter("%s_%s" % (kind, what), nominal, [low] * size,
                                           [high] * size))
        transform.delay(kind, parameters[kind + "_delay"])
        transform.gain(kind, parameters[kind + "_gain"], target="predicted")
        transform.bias(kind, parameters[kind + "_bias"], target="predicted")

    def residual(x, given):
        given.update_from_vector(x)
        left, *more = transform.apply(given, simulated, real, model, False)
        return [left.ravel()], *more

    # Its numbers are of sizes far apart (gains to 57, delays of ms): scaled by the Jacobian.
    with contextlib.redirect_stdout(io.StringIO()):     # its solver's own table
        found, _ = sysid.optimize(parameters, residual, optimizer="scipy", verbose=False,
                                  max_iters=30, x_scale="jac")
    return beyond({name: p.value for name, p in found.items()})


def beyond(value):
    """The name of the fitted number that is farthest beyond what parts differ by, or ""."""
    sizes = {}
    for kind, bias in (("accel", BIAS_FORCE), ("gyro", BIAS_RATE)):
        gain = value[kind + "_gain"]
        turned = (gain < 0).any() and not (gain < 0).all()
        name = "force_sign" if kind == "accel" and (gain < 0).all() else \
            kind + ("_axes" if turned else "_unit")
        sizes[name] = float(np.abs(gain - 1.0).max()) / GAIN
        sizes["bias_sign" if kind == "accel" else "gyro_bias"] = float(
            np.abs(value[kind + "_bias"]).max()) / bias
    # What it moves is the simulator's log: moved later, the sensor is the late one.
    late = float(value["gyro_delay"][0] - value["accel_delay"][0])
    sizes["accel_delay" if late > 0 else "gyro_delay"] = abs(late) / DELAY_S
    name = max(sizes, key=sizes.get)
    return name if sizes[name] > 1.0 else ""


METHODS = {"largest residual RMS": residual_rms, "largest correlation": largest_correlation,
           "mujoco.sysid": mujoco_sysid}
