"""What simulators were publicly reported to do wrong, made on the engine's own motion, and the
real sensor beside it. Knows neither the diagnosis nor the simulator of this project.

Each defect: function(Motion at 1 kHz, numpy Generator) to (force, rate) as that simulator gives
them, or a change of the sensor's Parts.
"""
from dataclasses import dataclass, field, replace

import numpy as np

G = 9.80665
ARM = np.array([0.04, -0.015, 0.02])


@dataclass(frozen=True)
class Parts:
    """How true force (m/s2) and rate (rad/s) become counts: matrices, biases, noise densities
    (m/s2 and rad/s per root Hz), steps in counts, ranges (g, deg/s), low-pass (Hz or None),
    delays (s), rows over which each is held, whether noise is new in each of them; what the real
    part drifts with (name of an
    effect, or ""), at so many times its typical size."""

    accel: np.ndarray = field(default_factory=lambda: np.eye(3))
    gyro: np.ndarray = field(default_factory=lambda: np.eye(3))
    accel_bias: np.ndarray = field(default_factory=lambda: np.zeros(3))
    gyro_bias: np.ndarray = field(default_factory=lambda: np.zeros(3))
    accel_noise: float = 0.004
    gyro_noise: float = 1.0e-4
    per_sample: bool = False
    accel_step: int = 1
    accel_range_g: float = 4.0
    low_pass_hz: float = 20.0
    accel_delay_s: float = 0.0
    gyro_delay_s: float = 0.0
    accel_held: int = 1
    gyro_held: int = 1
    fresh_noise: bool = False
    effect: str = ""
    times: float = 1.0


def real_part(rng, effect="", parameters=True):
    """The sensor on the bench, with parameters of its own."""
    if not parameters:
        return Parts(effect=effect)
    return Parts(np.eye(3) + rng.uniform(-0.012, 0.012, (3, 3)),
                 np.eye(3) + rng.uniform(-0.012, 0.012, (3, 3)),
                 rng.uniform(0.1, 0.5, 3) * rng.choice([-1, 1], 3),
                 np.radians(rng.uniform(0.5, 2.0, 3)) * rng.choice([-1, 1], 3), effect=effect)


def with_effect(name, t, force, rate, celsius):
    """(force, rate) of a real part that has an effect, of about typical size."""
    warm = (celsius - 25.0)[:, None]
    if name == "thermal_bias":
        force = force + 0.0008 * G * warm * (1.0, -0.7, 1.2)
        rate = rate + np.radians(0.06) * warm * (1.0, -1.0, 0.5)
    elif name == "quadratic":
        force = force + 0.008 * G * (force / G) ** 2 * (1.0, -1.0, 0.8)
    elif name == "g_sensitivity":
        rate = rate + np.radians(0.15) * (force / G) @ np.array(
            [[1.0, 0.3, 0.0], [-0.4, 0.8, 0.2], [0.0, 0.1, -1.0]])
    elif name == "warm_up":
        force = force + 0.008 * G * np.exp(-t / 40.0)[:, None] * (1.0, 0.6, -1.0)
    elif name == "thermal_scale":
        force = force * (1.0 + 0.0008 * warm * (1.0, -0.8, 1.1))
    elif name == "cubic":
        force = force + 0.008 * G * (force / G) ** 3 * (1.0, -1.0, 0.8)
    elif name == "asymmetry":
        force = force + 0.008 * G * np.abs(force / G) * (1.0, -1.0, 0.8)
    elif name == "vibration":
        force = force + 0.03 * G * np.sin(2 * np.pi * 31.0 * t)[:, None] * (0.4, 0.2, 1.0)
    return force, rate


EFFECTS = ("thermal_bias", "quadratic", "g_sensitivity", "warm_up", "vibration")


def counts(parts, motion, force, rate, rng, rate_hz, start_s=0.0, celsius_all=None):
    """The text of a capture: what these Parts make of force and rate, from start_s on;
    celsius_all: temperature at every time of the Motion, None: of one that warms up."""
    dt = motion.t[1] - motion.t[0]
    t = np.arange(start_s, motion.t[-1], 1.0 / rate_hz)
    if celsius_all is None:
        celsius_all = 24.0 + 9.0 * (1.0 - np.exp(-motion.t / 60.0))
    changed = with_effect(parts.effect, motion.t, force, rate, celsius_all)
    force, rate = (x + parts.times * (y - x) for x, y in zip((force, rate), changed))
    force = force @ parts.accel.T + parts.accel_bias
    rate = rate @ parts.gyro.T + parts.gyro_bias
    if parts.low_pass_hz:
        force, rate = (smooth(x, parts.low_pass_hz, dt) for x in (force, rate))
    rows = []
    for values, delay, held, noise, lsb, step, limit in (
            (force, parts.accel_delay_s, parts.accel_held, parts.accel_noise, 8192.0 / G,
             parts.accel_step, parts.accel_range_g * 8192.0),
            (rate, parts.gyro_delay_s, parts.gyro_held, parts.gyro_noise,
             65.5 * 180.0 / np.pi, 1, 32767.0)):
        at = t[(np.arange(len(t)) // held) * held] - delay
        x = np.stack([np.interp(at, motion.t, values[:, i]) for i in range(3)], 1)
        sigma = noise if parts.per_sample else noise * np.sqrt(rate_hz / held)
        drawn = rng.normal(size=x.shape)
        if not parts.fresh_noise:
            drawn = drawn[(np.arange(len(t)) // held) * held]
        x = x + sigma * drawn
        c = np.round(np.clip(x * lsb, -limit, limit) / step) * step
        rows.append(np.clip(c, -32768, 32767).astype(int))
    celsius = np.interp(t, motion.t, celsius_all)
    head = ('# sixflip-capture 1\n# {"sensor": "mpu6050", "rate_hz": %g, "g": 9.80665, '
            '"accel_lsb_per_g": 8192, "accel_range_g": 4, "gyro_lsb_per_dps": 65.5, '
            '"gyro_range_dps": 500, "temp_lsb_per_c": 340, "temp_offset_c": 36.53}\n'
            't_us,ax,ay,az,gx,gy,gz,temp,pose\n' % rate_hz)
    names = np.full(len(t), "", dtype=object)
    for name, first, end in motion.labels:
        names[(t >= motion.t[first]) & (t < motion.t[end - 1])] = name
    us = np.round((t - t[0]) * 1e6).astype(int)
    raw = np.round((celsius - 36.53) * 340).astype(int)
    table = np.column_stack([us, rows[0], rows[1], raw])
    if not motion.labels:
        return head.replace(",pose", "") + "".join(
            ",".join(map(str, r)) + "\n" for r in table.tolist())
    return head + "".join("%s,%s\n" % (",".join(map(str, r)), n)
                          for r, n in zip(table.tolist(), names))


def smooth(x, hz, dt):
    """A single pole, the state at the first value."""
    from scipy.signal import lfilter
    a = np.exp(-2.0 * np.pi * hz * dt)
    return lfilter([1.0 - a], [1.0, -a], x, axis=0, zi=a * x[:1])[0]


def gravity(motion):
    """(n, 3): what gravity adds to the specific force, in the body."""
    return G * motion.turn[:, 2, :]


def cross(a, b):
    return np.cross(a, np.broadcast_to(b, a.shape))


SWAP = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]])
MIRROR = np.diag([1.0, -1, 1])
# name: (function of a Motion to (force, rate), change of the Parts, names that are right,
#        layer, whether a different motion can show it)
DEFECTS = {
    "healthy": (lambda m: (m.force, m.rate), {}, (), "", True),
    "no_gravity": (lambda m: (m.force - gravity(m), m.rate), {}, ("no_gravity",), "conventions",
                   True),
    "gravity_sign": (lambda m: (m.force - 2.0 * gravity(m), m.rate), {}, ("gravity_sign",),
                     "conventions", True),
    "force_sign": (lambda m: (-m.force, m.rate), {}, ("force_sign", "gravity_sign"),
                   "conventions", True),
    "world_rates": (lambda m: (m.force, np.einsum("nij,nj->ni", m.turn, m.rate)), {},
                    ("world_frame_rates",), "conventions", True),
    "gravity_after_rotation": (lambda m: (m.force - gravity(m) + (0, 0, G), m.rate), {},
                               ("gravity_after_rotation",), "conventions", True),
    "motion_times_4": (lambda m: (gravity(m) + 4.0 * (m.force - gravity(m)), m.rate), {},
                       ("time_step",), "conventions", False),
    "rates_half": (lambda m: (m.force, 0.5 * m.rate), {}, ("time_step",), "conventions", True),
    "transport": (lambda m: (m.force - np.cross(m.rate, np.einsum(
        "nji,nj->ni", m.turn, m.velocity)), m.rate), {}, ("no_centripetal_term",),
        "conventions", False),
    "no_lever_arm": (lambda m: (m.centre_force, m.rate), {}, ("lever_arm_missing",),
                     "conventions", False),
    "degrees": (lambda m: (m.force, m.rate / np.degrees(1.0)),
                {"gyro_noise": 1.0e-4 / 57.3}, ("gyro_unit",),
                "conventions", True),
    "in_g": (lambda m: (m.force / G, m.rate), {"accel_noise": 0.004 / G}, ("accel_unit",),
             "conventions", True),
    "gyro_swapped": (lambda m: (m.force, m.rate @ SWAP), {}, ("gyro_axes",), "conventions", True),
    "gyro_mirrored": (lambda m: (m.force, m.rate @ MIRROR), {}, ("gyro_axes",), "conventions",
                      True),
    "accel_mirrored": (lambda m: (m.force @ MIRROR, m.rate), {}, ("accel_axes",), "conventions",
                       True),
    "both_swapped": (lambda m: (m.force @ SWAP, m.rate @ SWAP), {}, ("both_axes",),
                     "conventions", True),
    "gyro_late": (lambda m: (m.force, m.rate), {"gyro_delay_s": 0.04}, ("gyro_delay",),
                  "conventions", True),
    "accel_late": (lambda m: (m.force, m.rate), {"accel_delay_s": 0.04}, ("accel_delay",),
                   "conventions", True),
    "held": (lambda m: (m.force, m.rate), {"gyro_held": 5}, ("gyro_rate_held",), "conventions",
             True),
    "held_under_noise": (lambda m: (m.force, m.rate), {"gyro_held": 5, "fresh_noise": True},
                         ("gyro_rate_held",), "conventions", True),
    "per_sample": (lambda m: (m.force, m.rate), {"per_sample": True}, ("noise_per_sample",),
                   "conventions", True),
    "no_noise": (lambda m: (m.force, m.rate), {"accel_noise": 0.0, "gyro_noise": 0.0},
                 ("noise",), "parameters", True),
    "constant": (lambda m: (m.force * (1, 0, 1), m.rate), {}, ("constant_channel",),
                 "conventions", True),
    "bias_sign": (lambda m: (m.force, m.rate), {"accel_bias": -1.0}, ("bias_sign",),
                  "conventions", True),
    "no_range": (lambda m: (m.force, m.rate), {}, ("range",), "parameters", True),
    "no_low_pass": (lambda m: (m.force, m.rate), {"low_pass_hz": 0.0}, ("bandwidth",),
                    "parameters", True),
    "no_step": (lambda m: (m.force, m.rate), {}, ("step",), "parameters", True),
}
REAL = {"no_range": {"accel_range_g": 1.15}, "no_step": {"accel_step": 64}}


def pair(name, real_motion, sim_motion, seed, effect="", own=True, rate_hz=100.0, sim_hz=None):
    """(text of the real capture, text of the simulator's)."""
    rng = np.random.default_rng(seed)
    part = replace(real_part(rng, effect, own), **REAL.get(name, {}))
    make, change, *_ = DEFECTS[name]
    sim = replace(Parts() if own and name != "bias_sign" else replace(part, effect=""),
                  accel_step=1, accel_range_g=4.0)
    if name == "bias_sign":
        sim = replace(part, accel_bias=-part.accel_bias, effect="", accel_step=1)
    else:
        sim = replace(sim, **change)
    real = counts(part, real_motion, real_motion.force, real_motion.rate, rng, rate_hz)
    force, rate = make(sim_motion)
    return real, counts(sim, sim_motion, force, rate, rng, sim_hz or rate_hz,
                        start_s=rng.uniform(0.2, 1.0))
