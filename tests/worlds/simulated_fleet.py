"""Fleets of boards as summaries of their captures, made without samples and without anything that
the population is judged by: a part is drawn, lies in the poses of a protocol on a table that leans
a little, warms up, and each rest gives the means that its noise leaves.

    mean = A f + b + k (T - 25) + slow noise + white / sqrt(n),  f = g up
"""
from dataclasses import dataclass, field

import numpy as np

from sixflip.poses import faces
from sixflip_host.experiment.way_memory import FRICTION, TURNED_S
from sixflip_host.fleet import analysis, parameters, summary, summary_file
from sixflip_host.planning import protocols

ACCEL_LSB, GYRO_LSB, RATE = 16384.0, 65.5, 100.0
TEMP_LSB, TEMP_OFF = 340.0, 36.53
SAMPLE_MG, SAMPLE_DPS = 3.0, 0.05  # white noise of a sample at 100 Hz
SLOW_MG, SLOW_DPS, SLOW_S = 0.05, 0.001, (10.0, 100.0, 1000.0)
PLACED_DEG, HAND_DEG = 0.05, 0.4
SWITCH_ON_MG, SWITCH_ON_DPS = 0.3, 0.02  # from one session to the next


@dataclass
class Part:
    """matrix (3, 3), bias_mg (3,), gyro (3, 3), gyro_bias (3,) deg/s; slope (3,) mg/degC,
    gyro_slope (3,) deg/s/degC, pull (3, 3) deg/s per g; moved_mg (3,): what its bias changes by
    after the first session; loud: factor of its noise."""

    matrix: np.ndarray
    bias_mg: np.ndarray
    gyro: np.ndarray
    gyro_bias: np.ndarray
    slope: np.ndarray = field(default_factory=lambda: np.zeros(3))
    gyro_slope: np.ndarray = field(default_factory=lambda: np.zeros(3))
    pull: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))
    moved_mg: np.ndarray = field(default_factory=lambda: np.zeros(3))
    loud: float = 1.0


def drawn(rng):
    """A Part of a usual batch, without effects."""
    def near(size, spread):
        return np.eye(3) * (1.0 + size) + rng.normal(0.0, spread, (3, 3))
    return Part(near(0.004, 0.006), rng.normal((10.0, -5.0, 20.0), 15.0), near(0.0, 0.008),
                rng.normal(0.0, 0.8, 3))


def summary_of(part, plan, rng, name, number=0, board=None):
    """Summary of a session of a Part; plan: protocols.SessionPlan; number of the session."""
    dwell = np.array([r.dwell_s for r in plan.rests])
    starts = np.concatenate([[0.0], np.cumsum(dwell[:-1] + [r.move_s for r in plan.rests[1:]])])
    codes = np.array([faces.pose_code(r.pose) for r in plan.rests])
    up = _up(plan.rests, rng)
    end = float(starts[-1] + dwell[-1])

    def celsius(t):
        return plan.start_c + plan.change_c * (1.0 - np.exp(-t / plan.tau_s))
    edge, blocks = 0.1, 2
    width = (dwell - 2.0 * edge) / blocks
    t = (starts + edge)[:, None] + width[:, None] * (np.arange(blocks) + 0.5)
    t, seconds = t.ravel(), np.repeat(width, blocks)
    place = np.repeat(np.arange(len(codes)), blocks)
    warmth = celsius(t) - 25.0
    off = rng.normal(0.0, SWITCH_ON_MG, 3) + (part.moved_mg if number else 0.0)
    accel = 1e3 * up[place] @ part.matrix.T + part.bias_mg + off + np.outer(warmth, part.slope)
    gyro = up[place] @ part.pull.T + part.gyro_bias + rng.normal(0.0, SWITCH_ON_DPS, 3) \
        + np.outer(warmth, part.gyro_slope)
    white_mg, white_dps = SAMPLE_MG / np.sqrt(RATE) * part.loud, SAMPLE_DPS / np.sqrt(RATE)
    root, known = np.sqrt(seconds)[:, None], 0.5 * np.sqrt(3.0 / (4.0 * seconds.sum()))
    accel = accel + _slow(t, SLOW_MG, rng) + rng.normal(0.0, white_mg, accel.shape) / root
    gyro = gyro + _slow(t, SLOW_DPS, rng) + rng.normal(0.0, white_dps, gyro.shape) / root
    first = np.round((starts + edge) * RATE).astype(int)
    cut = first[place] + np.round(np.tile(np.arange(blocks), len(codes)) * width[place] * RATE)
    clock = np.arange(0.5, end, 1.0)
    arrays = {
        **_placements(codes, starts, dwell, accel, gyro, celsius, part.loud),
        "move_of": _moves(part, plan.rests, codes, starts, dwell, gyro, rng),
        "halves": (accel[1::2] - accel[::2]) * ACCEL_LSB / 1e3,
        "runs": np.column_stack([codes, starts * RATE, (starts + dwell) * RATE]).astype(np.int64),
        "starts": starts, "thermometer": np.concatenate([clock[:1], celsius(clock)]),
        "friction": np.repeat(np.tanh(rng.normal(0.0, 0.1, (len(t), 1, 3))),
                              len(FRICTION), axis=1),
        "turned": rng.normal(0.0, 1.0, (len(t), len(TURNED_S), 3)),
        "block_placement": place, "block_code": codes[place],
        "block_first": cut.astype(np.int64),
        "block_end": (cut + width[place] * RATE).astype(np.int64),
        "block_face": np.array([faces.face_of_code(int(c)) for c in codes])[place],
        "block_t": t, "block_since": t - starts[place], "block_seconds": seconds,
        "block_accel": accel, "block_gyro": gyro, "block_temperature": celsius(t),
        "block_temperature_rate": plan.change_c / plan.tau_s * np.exp(-t / plan.tau_s),
        "block_loudness": np.full(len(t), SAMPLE_MG * np.sqrt(3.0)),
        "block_noise_accel": white_mg * (1.0 + rng.normal(0.0, known, 3)),
        "block_noise_gyro": white_dps * (1.0 + rng.normal(0.0, known, 3)),
        "block_rounding_accel": np.zeros(3), "block_rounding_gyro": np.zeros(3)}
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": ACCEL_LSB,
            "gyro_lsb_per_dps": GYRO_LSB, "accel_range_g": 2, "gyro_range_dps": 500,
            "temp_lsb_per_c": TEMP_LSB, "temp_offset_c": TEMP_OFF}
    if board:
        meta["device_id"] = board
    return summary.Summary({
        "format": summary_file.FORMAT, "name": name, "labelled": True, "found_labelled": True,
        "gyro": True,
        "meta": meta, "remarks": [], "bounds": [0.0, end], "stamp": None, "hash": name,
        "flips": {"reason": "made without samples", "angles": [], "measured": []},
        "samples": {"findings": [], "nameless": [], "scaled": False, "remarks": []}}, arrays)


def _up(rests, rng):
    """(n, 3) unit vectors against gravity: the pose, a table that leans by 1 degree, the hand."""
    lean = np.radians(1.0) * np.array([np.cos(0.5), np.sin(0.5)])
    found = []
    for rest in rests:
        axis = np.array(rest.up, float)
        one = np.cross(axis, [0.3, 0.5, 0.8])
        one /= np.linalg.norm(one)
        two = np.cross(axis, one)
        sign = -1.0 if rest.yaw_deg else 1.0
        across = sign * lean + rng.normal(0.0, np.radians(PLACED_DEG), 2)
        v = axis + across[0] * one + across[1] * two
        found.append(v / np.linalg.norm(v))
    return np.array(found)


def _slow(t, level, rng):
    """(n, 3) noise that wanders over SLOW_S seconds."""
    out = np.zeros((len(t), 3))
    for tau in SLOW_S:
        state = rng.normal(0.0, level, 3)
        keep = np.exp(-np.diff(t, prepend=t[0]) / tau)
        for k, share in enumerate(keep):
            state = share * state + rng.normal(0.0, level, 3) * np.sqrt(1.0 - share ** 2)
            out[k] += state
    return out


def _placements(codes, starts, dwell, accel, gyro, celsius, loud):
    n = np.round(dwell * RATE).astype(np.int64)
    means = np.column_stack([
        0.5 * (accel[::2] + accel[1::2]) * ACCEL_LSB / 1e3, 0.5 * (gyro[::2] + gyro[1::2])
        * GYRO_LSB, (celsius(starts + 0.5 * dwell) - TEMP_OFF) * TEMP_LSB])
    noise = np.tile([SAMPLE_MG * loud * ACCEL_LSB / 1e3] * 3 + [SAMPLE_DPS * GYRO_LSB] * 3,
                    (len(codes), 1))
    return {"placement_of": np.column_stack([
        codes, np.round(starts * RATE), n, n * 1e6 / RATE]).astype(np.int64),
        "placement_sums": np.round(means * n[:, None]).astype(np.int64),
        "placement_noise": noise}


def _moves(part, rests, codes, starts, dwell, gyro, rng):
    """Rows as summary._row makes them: a flip is half a turn about the face's axis."""
    rows = []
    for k in range(len(rests) - 1):
        begin = starts[k] + dwell[k]
        seconds = float(starts[k + 1] - begin)
        n = int(round(seconds * RATE))
        face, after = (faces.face_of_code(int(c)) for c in codes[k:k + 2])
        turned = np.zeros(3)
        if face >= 0 and face == after and codes[k] != codes[k + 1]:
            way = 1.0 if rests[k + 1].turn == "left" else -1.0
            turned[faces.AXIS[face]] = way * faces.SIGN[face] * (
                180.0 + rng.normal(0.0, HAND_DEG))
        read = part.gyro @ turned + gyro[2 * k + 1] * seconds
        sums = np.round(read * GYRO_LSB * RATE).astype(int)
        rows.append([k, k + 1, int(round(begin * RATE)), n, *sums, int(n * 1e6 / RATE),
                     0, 0, 0, 0, 0, int(1e6 / RATE), *[0] * summary.PATH])
    return np.array(rows, np.int64)


THERMAL = protocols.named("thermal").sessions


def row_of(part, rng, board, batch="", plans=THERMAL):
    """The row that analysis.row gives of the sessions of a Part."""
    kept = [summary_of(part, plan, rng, "%s-%d" % (board, k), k) for k, plan in enumerate(plans)]
    return {"board": board, "batch": batch, "failure": "", "written": 0.0,
            **analysis._empty(), **analysis._judged(kept, [])}


def truth(part):
    """{parameter: true value} of what parameters.py reports of a Part."""
    A = np.linalg.inv(part.matrix)
    found = {}
    for k, axis in enumerate("xyz"):
        found["accel_scale_" + axis] = A[k, k]
        found["accel_bias_%s_mg" % axis] = part.bias_mg[k]
        found["gyro_bias_%s_dps" % axis] = part.gyro_bias[k]
    assert set(found) <= set(parameters.NAMES)
    return found
