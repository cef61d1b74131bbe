"""Li's heading test (4.3, Table 4) simulated: turns on a floor, read before and after calibrating.

Each calibration is a whole session of six faces and their flips by hand, solved by the board's
code, of another gyro every time. Then the power is switched off and on, which moves the gyro's
bias, and the robot turns on the floor; its rest before each turn refreshes the bias, as the
firmware does at power-up.
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

from ..simulation.simulated_capture import capture

TURNS = (30, 45, 60, 90)
REPETITIONS = 10
SENSOR = "gy85"             # the paper's
HAND_DEG = 0.4              # of each flip, standard deviation
TILT_DEG = 1.5              # of the table the session is done on
SWITCH_ON_DPS = 0.3         # how far a bias is from the last switching-on's, at most
RATE_DPS = 45.0             # the robot's mean rate in a turn
REST_S, MARGIN_S = 3.0, 0.3
_POWER, _HAND = 0x701, 0x702    # streams of noise.py


def calibrated(seed):
    """(Record solved from a simulated session, its gyro's matrix and bias in deg/s)."""
    world = worlds.make({"sensor": SENSOR, "seed": seed, "tilt_deg": TILT_DEG,
                         "flip_error_deg": HAND_DEG})
    session = capture(world)
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
    taken = capture(world)
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
        a = _affine(taken.accel[first:end], correction.accel)
        w = _affine(taken.gyro[first:end], correction.gyro)
        heading = Heading(g=record.g)
        for sample in zip(a.tolist(), w.tolist(), dt[first:end].tolist()):
            yaw = heading.step(*sample)[2]
        angles.append(math.degrees(yaw))
    return angles


def _affine(counts, M):
    """Correction.apply for all rows at once."""
    M = np.array(M)
    return counts @ M[:3] + M[3]


def experiment(calibrations, seed):
    """(before, after): readings (calibrations, turns, repetitions), degrees, left or right
    taken as positive. Directions alternate from turn to turn of the table."""
    before = np.zeros((calibrations, len(TURNS), REPETITIONS))
    after = np.zeros_like(before)
    for number in range(calibrations):
        record, truth = calibrated(seed + number)
        sign = np.repeat([1 if (number + k) % 2 else -1 for k in range(len(TURNS))], REPETITIONS)
        taken, spans = floor(truth, seed + number, (sign * np.repeat(TURNS, REPETITIONS)).tolist())
        for out, used, refresh in ((before, nominal(taken.meta), False), (after, record, True)):
            out[number] = (sign * read(taken, spans, used, refresh)).reshape(len(TURNS), -1)
    return before, after
