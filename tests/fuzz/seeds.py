"""Writes the valid part of the corpus: `python -m tests.fuzz.seeds`. Small, and the same always.

What fuzzing found lies beside it under names that say what it was.
"""

import io
import json
import struct
from pathlib import Path

import numpy as np
from scipy.io import savemat

from sixflip.capture import blocks as cb
from sixflip.capture import pieces
from sixflip.record import correction_record
from sixflip.record.term_correction import TERMS
from sixflip_host import record_terms
from sixflip_host.capture import capture_binary, capture_file
from tests.host.capture import test_import_presets
from tests.shared.test_term_correction import fields_of
from tests.worlds import hostile_sessions, simulated_fleet

CORPUS = Path(__file__).resolve().parent / "corpus"


def small_capture(sensor):
    """A session of some hundred rows."""
    session = hostile_sessions.Session(1, sensor)
    for rest in session.rests:
        rest.samples = 12
    hostile_sessions.MOVE = 3
    return session.capture()


def a_record():
    """Every section there is."""
    r = correction_record.Record()
    r.chip, r.who_am_i, r.session, r.sequence = "mpu6050", (0x68, 0x68), 7, 3
    r.accel_range_g, r.gyro_range_dps = 2, 500
    r.accel_lsb_per_g, r.gyro_lsb_per_dps, r.temp_c = 16384.0, 65.5, 25.0
    identity = [[float(i == j) for j in range(4)] for i in range(4)]
    r.accel = {"P": identity, "sigma_P": [[1e-4] * 4 for _ in range(4)], "tilt_deg": 2.0,
               "tilt_spread_deg": 0.05, "residual_rms_g": 1e-4, "noise_g": 3e-3,
               "level": "tilt solved", "verdict": "good", "reason": "fine"}
    r.gyro = {"P": [row[:3] for row in identity], "sigma_P": [[1e-3] * 3 for _ in range(4)],
              "missing": [], "verdict": "good", "reason": ""}
    r.gyro_bias = {"bias_dps": [0.1, -0.2, 0.3], "temp_c": 25.0}
    for _, name in TERMS:
        record_terms.put(r, name, fields_of(name))
    r.mounting = {"roll_deg": 1.0, "pitch_deg": -2.0, "order": "xyz", "axes": "x y z", "frame":
                  "rep103"}
    return correction_record.encode(r)


def pieces_of(capture):
    """A board's file as recorded_pieces takes it, one block lost."""
    data, out = capture_binary.encode(capture), b""
    at, end = 0, struct.calcsize(cb.HEAD) + struct.unpack_from("<H", data, 6)[0] + 4
    samples = 0
    while at < len(data):
        piece = data[at:end]
        if len(out) < 2000 or len(out) > 4000:
            body = struct.pack(pieces.HEAD, 0, samples) + piece
            out += struct.pack("<H", len(body)) + body
        if at and piece[0] == cb.STEPS:
            samples += struct.unpack_from("<H", piece, 12)[0]
        at = end
        end += 8 + struct.unpack_from("<H", data, min(at, len(data) - 4) + 2)[0]
    return out


LINES = b"""{"event": "hello", "board": "pico", "id": "e661", "chip": "MPU6050", "sensor": "auto"}
{"event": "state", "state": "capturing", "pose": "Z+a", "progress": 5, "total": 9, "left_s": 3}
{"event": "state", "state": "moving", "reason": "moving", "value": 1.5, "limit": 1, "unit": "mg"}
{"event": "pose", "pose": "Z+a", "missing": ["Z+b", "X-a", "X-b"]}
{"event": "refused", "pose": "Z+b", "reason": "not a flip", "value": 90, "limit": 40, "unit": "d"}
{"event": "solved", "verdict": "good", "reason": "r", "tilt_deg": 1, "residual_mg_rms": 0.5}
{"event": "saved", "slot": "a", "sequence": 3}
{"event": "error", "what": "x", "expected": "y"}
"""
SETTINGS = b'{"board": "pico", "sensor": "mpu6050", "i2c": 0, "scl": 5, "sda": "X1", "g": 9.8}'
CSV = b"\0time,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n" + b"".join(
    b"%d,0.5,-0.5,9.75,0.25,0,-0.25\n" % k for k in range(12))
TOML = b"""sensor = "gy85"
scene = "recommended"
seed = 4
[world]
tilt_deg = 1.5
accel_bias_mg = [1, 2.5, -3]
[[effects]]
effect = "thermal_bias"
sensor = "accel"
x = 0.5
"""
PLAN = (b'{"sixflip_plan": 1, "name": "p", "sessions": [{"state": "warming", "start_c": 22, '
        b'"poses": ["Z+a", {"pose": "L1", "up": [0, 1, 1], "dwell_s": 5, "turn": "left"}]}]}')


MANIFEST = (b'board,capture,batch\ne661,a/warming.csv,lot 7\n"e6,62", b.csv ,\n,c.csv,\n'
            b'e663,a/warming.csv,lot 8\ne664,d.csv,lot,more\n')
POPULATION = json.dumps({
    "format": 1, "kind": "sixflip fleet", "groups": [{"chip": "mpu6050", "batches": [{
        "batch": "", "boards": 9, "blocks": [{
            "block": "accel.thermal_bias", "names": ["accel.thermal_bias.z"], "rare": 0.01}],
        "parameters": [{"name": "accel.thermal_bias.z", "mean": -1.0, "error": 0.1,
                        "spread": 0.2}]}]}]}).encode()


def about_a_session():
    """The JSON of a summary."""
    rng = np.random.default_rng(1)
    one = simulated_fleet.summary_of(simulated_fleet.drawn(rng), simulated_fleet.THERMAL[0], rng,
                                     "s")
    return json.dumps(one.about).encode()


def foreign_files():
    """A few rows in each of the formats that import tells by their content."""
    table = np.arange(24.0).reshape(8, 3) % 5
    npz, mat = io.BytesIO(), io.BytesIO()
    np.savez(npz, accel=table, gyro=table, t=np.arange(8) / 100)
    savemat(mat, {"accelReadings": table, "Fs": 100.0})
    betaflight = (b'"acc_1G","2048"\n"loopIteration","time","gyroADC[0]","gyroADC[1]",'
                  b'"gyroADC[2]","accSmooth[0]","accSmooth[1]","accSmooth[2]"\n'
                  + b"".join(b"%d,%d,1,2,3,4,5,2048\n" % (k, 1000 * k) for k in range(30)))
    undated = b"MATLAB 5.0 MAT-file, small".ljust(116) + mat.getvalue()[116:]
    return [test_import_presets.ulog_bytes(8), npz.getvalue(), undated,
            test_import_presets.gazebo_text(3).encode(), betaflight,
            b'Time (s);"Acceleration x (m/s^2)";Acceleration y (m/s^2);Acceleration z (m/s^2)\n'
            + b"".join(b"%d,%02d;0,1;0,2;9,8%d\n" % (k // 100, k % 100, k % 7)
                       for k in range(60))]


def main():
    """Write them all."""
    mpu, adxl = small_capture("mpu6050"), small_capture("adxl345")
    seeds = {"capture_text": [capture_file.text(mpu)[:4000].rpartition(b"\n")[0].replace(
                 b', "samples": %d' % len(mpu), b"") + b"\n", capture_file.text(adxl)],
             "capture_of_a_board": [capture_binary.encode(adxl)],
             "recorded_pieces": [pieces_of(adxl)],
             "record": [a_record()], "lines_of_a_board": [LINES, b"{'main.py': (3, None)}"],
             "settings": [SETTINGS], "host_line": [b'{"cmd": "stream", "hz": 50, "raw": true}'],
             "somebodys_csv": [CSV, b"\3" + b"1 2 3 0.01 4 5 6\n" * 5],
             "foreign_file": foreign_files(),
             "sections": [b'{"x_p": {"start": 5, "end": 90}, "z_a": {"start": 100, "end": 200}}'],
             "scenario_file": [TOML], "plan": [PLAN, b'["Z+a", "Z+b"]'],
             "fleet_manifest": [MANIFEST], "fleet_summary": [about_a_session()],
             "fleet_population": [POPULATION]}
    for name, contents in seeds.items():
        folder = CORPUS / name
        folder.mkdir(parents=True, exist_ok=True)
        for number, data in enumerate(contents, 1):
            (folder / ("valid_%d" % number)).write_bytes(data)


if __name__ == "__main__":
    main()
