"""What a board leaves behind after a session: capture.bin and a record, by the shared code."""

import json

import numpy as np

from sixflip.accelerometer import solver as accelerometer
from sixflip.accelerometer import verdict
from sixflip.capture.blocks import ACCEL, GYRO, TEMP
from sixflip.capture.writer import BlockWriter
from sixflip.gyro import solver as gyroscope
from sixflip.poses.session import COMPLETE, POSE, REFUSED, Session
from sixflip.record import correction_record
from tests.worlds.hand_session import Sensor, session, six_faces

SESSION = 0x5EED


def unlabelled(seed=1, tilt_deg=2.0, noise_mg=3.0, **scene):
    """A capture of the paper's session with temperature, no labels."""
    scene.setdefault("rest_s", 6.0)
    capture = session(Sensor(seed, noise_mg), six_faces(seed, tilt_deg, **{
        key: scene.pop(key) for key in ("flip_error_deg", "scatter_deg") if key in scene}),
        seed, labels=False, **scene)
    wobble = np.random.default_rng(seed).integers(-4, 5, len(capture))
    capture.temp = (-3700 + wobble).astype(np.int16)
    capture.meta.update(temp_lsb_per_c=340, temp_offset_c=36.53, session=SESSION)
    return capture


def run_board(capture, sums_only=False):
    """Feed a capture to the shared session: bytes of capture.bin, placements and moves."""
    data = bytearray()
    writer = BlockWriter(data.extend, json.dumps(capture.meta).encode(), ACCEL | GYRO | TEMP,
                         sums_only=sums_only)
    machine = Session(capture.meta["accel_lsb_per_g"], capture.meta["gyro_lsb_per_dps"], 32767,
                      32767, capture.meta["rate_hz"])
    rows = np.column_stack([capture.accel, capture.gyro, capture.temp]).tolist()
    for dt_us, row in zip(np.diff(capture.t_us, prepend=0).tolist(), rows):
        event = machine.feed(dt_us, row)
        writer.add(dt_us, row)
        if event in (POSE, COMPLETE):
            writer.pose(machine.placements[-1])
        assert event != REFUSED, machine.reason
        if event == COMPLETE:
            break
    assert not machine.missing()
    writer.end(True)
    return bytes(data), machine.placements, machine.moves


def make_record(capture, placements, float_bits=64, moves=None):
    """The Record a board saves after that session; with moves also its gyro."""
    lsb = capture.meta["accel_lsb_per_g"]
    found = accelerometer.solve(placements, lsb)
    word, reason = verdict.judge_accelerometer(found, placements, lsb)
    record = correction_record.Record()
    record.session, record.sequence, record.float_bits = SESSION, 1, float_bits
    record.chip, record.who_am_i = "mpu6050", (0x68, 0)
    record.accel_range_g, record.gyro_range_dps = 2, 500
    record.accel_lsb_per_g, record.gyro_lsb_per_dps = lsb, capture.meta["gyro_lsb_per_dps"]
    n = sum(one.n for one in placements)
    means = [sum(one.sums[k] for one in placements) / n for k in range(7)]
    record.temp_c = means[6] / 340 + 36.53
    squares = [x * x for left in found.residual.values() for x in left]
    record.accel = {
        "P": found.P, "sigma_P": found.sigma_P, "tilt_deg": found.tilt_deg,
        "tilt_spread_deg": found.tilt_spread_deg, "noise_g": found.noise_g,
        "residual_rms_g": (sum(squares) / len(squares)) ** 0.5,
        "level": found.level, "verdict": word, "reason": reason}
    record.gyro_bias = {"bias_dps": [means[3 + k] / record.gyro_lsb_per_dps for k in range(3)],
                        "temp_c": record.temp_c}
    if moves is not None:
        gyro = gyroscope.solve(placements, moves, record.gyro_lsb_per_dps, found.P)
        record.gyro = {"P": gyro.P, "sigma_P": gyro.sigma, "missing": gyro.missing,
                       "verdict": gyro.verdict, "reason": gyro.reason}
    return record


def leave_files(folder, capture, sums_only=False, gyro=True):
    """capture.bin and record_a.bin in a folder as `sixflip pull` leaves them; the Record."""
    data, placements, moves = run_board(capture, sums_only)
    record = make_record(capture, placements, moves=moves if gyro else None)
    (folder / "capture.bin").write_bytes(data)
    (folder / "record_a.bin").write_bytes(correction_record.encode(record))
    return record
