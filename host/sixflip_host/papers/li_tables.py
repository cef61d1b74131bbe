"""Tables 3 and 4 of Li et al. (Sensors 2019, 19, 4150): what they printed, their sensor made from
it, and both experiments simulated.

Angles and factors of Table 3 are in hundredths as in the paper. v's unit is not stated there;
read as m/s² its Z bias is 58 mg, which an ADXL345 may have (data sheet: 0 g offset to 80 mg).
"""

import math

import numpy as np

from sixflip import STANDARD_G
from sixflip.accelerometer import solver as accelerometer
from sixflip.gyro import solver as gyroscope
from sixflip.gyro.heading import Heading
from sixflip.record.correction import Correction
from sixflip.record.correction_record import Record
from sixflip_sim import noise, worlds

from ..simulation.simulated_session import capture_of

# name, mean, standard deviation, ×10⁻², of ten calibrations
TABLE_3 = (
    ("β_yz", 1.45, 0.21), ("β_zy", -5.59, 0.01), ("β_xz", -4.06, 1.96), ("β_zx", 1.98, 0.04),
    ("β_xy", 1.98, 0.03), ("β_yx", 0.90, 0.06),
    ("Scale x", 98.52, 0.10), ("Scale y", 99.05, 0.16), ("Scale z", 99.17, 0.11),
    ("v x", 0.37, 0.05), ("v y", 2.54, 0.53), ("v z", 57.25, 4.21),
)
# turn, read before and after calibration, degrees, ten repetitions averaged
TABLE_4 = ((30, 27.6, 29.6), (45, 47.2, 45.9), (60, 61.8, 59.2), (90, 88.0, 90.5))

# Where each angle stands in T of Li Eq. 5, [row, column], and its sign.
ANGLES = {"β_yz": (0, 1, -1), "β_zy": (0, 2, 1), "β_xz": (1, 0, 1), "β_zx": (1, 2, -1),
          "β_xy": (2, 0, -1), "β_yx": (2, 1, 1)}

SENSOR = "gy85"             # the paper's
HAND_DEG = 0.4              # of each flip, standard deviation
TILT_DEG = 1.5              # of the table the sessions are done on
# Table 3
CALIBRATIONS = 10
PLACING_DEG = 0.05          # how flush a hand lays a box on a table
# Table 4
TURNS = tuple(row[0] for row in TABLE_4)
REPETITIONS = 10
SWITCH_ON_DPS = 0.3         # how far a bias is from the last switching-on's, at most
RATE_DPS = 45.0             # the robot's mean rate in a turn
REST_S, MARGIN_S = 3.0, 0.3
_POWER = 0x701              # stream of noise.py


def parameters(T, scale, v):
    """The twelve in Table 3's order, ×10⁻², of a_t = T S (a_m + v): T 3 x 3, v in m/s²."""
    angles = [sign * T[i][j] for i, j, sign in ANGLES.values()]
    return [1e2 * x for x in [*angles, *scale, *v]]


def sensor():
    """(A, b) of the paper's accelerometer, measured = A true + b, m/s²: Table 3's means."""
    means = {name: mean / 1e2 for name, mean, _ in TABLE_3}
    T = np.eye(3)
    for name, (i, j, sign) in ANGLES.items():
        T[i, j] = sign * means[name]
    scale = np.diag([means["Scale " + axis] for axis in "xyz"])
    return np.linalg.inv(T @ scale), -np.array([means["v " + axis] for axis in "xyz"])


def repeated_calibrations(seed, placing_deg):
    """Table 3, their repeatability test: one sensor calibrated ten times by hand. The twelve
    parameters of every calibration, (CALIBRATIONS, 12), ×10⁻²."""
    A, b = sensor()
    rows = []
    for number in range(CALIBRATIONS):
        world = worlds.make({
            "sensor": SENSOR, "accel_matrix": A.tolist(),
            "accel_bias_mg": (1e3 / STANDARD_G * b).tolist(), "seed": 1000 * seed + number,
            "tilt_deg": TILT_DEG, "tilt_dir_deg": 36.0 * number, "flip_error_deg": HAND_DEG,
            "placement_scatter_deg": placing_deg})
        session = capture_of(world)
        fit = accelerometer.solve(session.placements(), session.meta["accel_lsb_per_g"])
        rows.append(parameters(fit.T, fit.scale, fit.v))
    return np.array(rows)


def calibrated(seed):
    """(Record solved from a simulated session, its gyro's matrix and bias in deg/s)."""
    world = worlds.make({"sensor": SENSOR, "seed": seed, "tilt_deg": TILT_DEG,
                         "flip_error_deg": HAND_DEG})
    session = capture_of(world)
    placements, moves = session.placements(), session.moves()
    record = nominal(session.meta)
    accel = accelerometer.solve(placements, record.accel_lsb_per_g, record.g)
    gyro = gyroscope.solve(placements, moves, record.gyro_lsb_per_dps, accel.P)
    record.accel, record.gyro = {"P": accel.P}, {"P": gyro.P}
    record.gyro_bias = {"bias_dps": gyro.bias_dps}
    return record, world.truth


def nominal(meta):
    """A Record of the data sheet's numbers: what there is before a calibration."""
    record = Record()
    record.g = meta["g"]
    record.accel_lsb_per_g = meta["accel_lsb_per_g"]
    record.gyro_lsb_per_dps = meta["gyro_lsb_per_dps"]
    return record


def floor(truth, seed, turned_deg):
    """(capture, [(first, end)] of each turn) of a robot that makes these turns, left positive."""
    stream = noise.key(seed, _POWER)
    bias = [math.degrees(truth.gyro_bias[k]) + SWITCH_ON_DPS * noise.uniform(stream, k)
            for k in range(3)]
    world = worlds.make({
        "sensor": SENSOR, "seed": seed + 500000, "order": [], "first_rest_s": 0.0,
        "accel_matrix": truth.accel_matrix, "gyro_matrix": truth.gyro_matrix,
        "accel_bias_mg": [1e3 * b / STANDARD_G for b in truth.accel_bias], "gyro_bias_dps": bias})
    spans = []
    for turn in turned_deg:
        world.scene.rest(int(REST_S * 1e6))
        begin = world.scene.end_us()
        world.scene.turn(int(abs(turn) / RATE_DPS * 1e6), (0.0, 0.0, 1.0), math.radians(turn))
        spans.append((begin - int(MARGIN_S * 1e6), world.scene.end_us() + int(MARGIN_S * 1e6)))
    world.scene.rest(int(REST_S * 1e6))
    taken = capture_of(world)
    return taken, [tuple(np.searchsorted(taken.t_us, span)) for span in spans]


def read(taken, spans, record, refresh):
    """Angle of every turn in degrees by Li Eq. 8 on corrected samples; one per span.

    refresh: the bias is taken anew from the rest before each turn.
    """
    correction = Correction(record)
    rest = int((REST_S - 2 * MARGIN_S) * taken.meta["rate_hz"])
    dt = np.diff(taken.t_us, prepend=taken.t_us[:1]) * 1e-6
    angles = []
    for first, end in spans:
        if refresh:
            correction.set_gyro_bias(taken.gyro[first - rest:first].mean(axis=0).tolist())
        a = affine(taken.accel[first:end], correction.accel)
        w = affine(taken.gyro[first:end], correction.gyro)
        heading = Heading(g=record.g)
        for sample in zip(a.tolist(), w.tolist(), dt[first:end].tolist()):
            yaw = heading.step(*sample)[2]
        angles.append(math.degrees(yaw))
    return angles


def affine(counts, M):
    """Correction.apply for all rows at once."""
    M = np.array(M)
    return counts @ M[:3] + M[3]


def heading_turns(calibrations, seed):
    """Table 4, their heading test (4.3): turns on a floor, read before and after calibrating.

    Each calibration is a whole session of six faces and their flips by hand, solved by the
    board's code, of another gyro every time. Then the power is switched off and on, which moves
    the gyro's bias, and the robot turns on the floor; its rest before each turn refreshes the
    bias, as the firmware does at power-up.

    (before, after): readings (calibrations, turns, repetitions), degrees, left or right
    taken as positive. Directions alternate from turn to turn of the table."""
    before = np.zeros((calibrations, len(TURNS), REPETITIONS))
    after = np.zeros_like(before)
    for number in range(calibrations):
        record, truth = calibrated(seed + number)
        sign = np.repeat([1 if (number + k) % 2 else -1 for k in range(len(TURNS))], REPETITIONS)
        taken, spans = floor(truth, seed + number, (sign * np.repeat(TURNS, REPETITIONS)).tolist())
        for turns, used, refresh in ((before, nominal(taken.meta), False), (after, record, True)):
            turns[number] = (sign * read(taken, spans, used, refresh)).reshape(len(TURNS), -1)
    return before, after
