"""One simulated part with known terms: its captures for diagnose, its calibration at 25 °C, and
the world it is used in afterwards. For the test of the whole way and for the benchmark."""

import csv

import numpy as np

from sixflip.record import correction_record
from sixflip_host.capture import capture_file
from sixflip_host.planning import plan_file, protocols
from sixflip_host.simulation import scenario, simulated_session
from tests.worlds.board_session import make_record, run_board

TERMS = [{"effect": "thermal_bias", "sensor": "accel", "z": -1.8},
         {"effect": "thermal_bias", "sensor": "gyro", "y": 0.15},
         {"effect": "g_sensitivity", "sensor": "gyro", "xy": 0.1}]
PART = ("accel_matrix", "accel_bias_mg", "gyro_matrix", "gyro_bias_dps")
WARM_C, CALIBRATED_C = 31.0, 25.0
G = 9.80665


def described(effects, **more):
    return scenario.from_dict(dict(
        {"sensor": "mpu6050", "seed": 9, "effects": effects,
         "world": {"tilt_deg": 1.0, "placement_scatter_deg": 0.05}}, **more))


def captures(folder, effects):
    """Paths of two sessions: warming to WARM_C, and cooling from there."""
    sessions = [protocols.faces_session(protocols.order_of("pairs", 15 + k), 10, True, True, state,
                                        15 + k, rest_s=30.0)
                for k, state in enumerate(("warming", "cooling"))]
    sessions[1].start_c = WARM_C
    plan = folder / "plan.json"
    plan_file.write(str(plan), protocols.Protocol("two states", sessions))
    found = described(effects, plan=str(plan))
    paths = []
    for number in range(len(found.worlds)):
        paths.append(str(folder / ("session%d.csv" % number)))
        capture_file.write(paths[-1], simulated_session.session(found, number))
    return paths


def calibrated(folder, effects):
    """Path of the record that a board makes of the part at CALIBRATED_C."""
    world = {"tilt_deg": 1.0, "move_s": 2.5, "dwell_s": 6.5, "first_rest_s": 8.0,
             "temperature_c": CALIBRATED_C, "warm_c": 0.0}
    capture = simulated_session.session(described(effects, scene="paper", world=world), 0)
    capture.pose[:] = 0
    _, placements, moves = run_board(capture)
    record = make_record(capture, placements, moves=moves)
    record.who_am_i = (0x68, 0x68)
    path = folder / "record_a.bin"
    path.write_bytes(correction_record.encode(record))
    return str(path)


def used_in(effects, **more):
    """The same part, calibrated at 25 °C, switched on at 23 and warming to 31: lying, then on
    three faces exactly."""
    spec = described(effects).worlds[0]
    return dict({"sensor": "mpu6050", "seed": 77, "effects": effects, "tilt_deg": 0.0,
                 "flip_error_deg": 0.0, "first_rest_s": 45.0, "dwell_s": 12.0, "move_s": 2.0,
                 "order": ["Z+a", "Y+a", "X-a", "Z-a"], "temperature_c": WARM_C, "warm_c": 8.0,
                 "warm_tau_s": 30.0}, **{key: spec[key] for key in PART}, **more)


def errors(path, window=100):
    """((k, 3) mg, (k, 3) °/s): what a stream is off in each second at rest on a face."""
    with open(path, newline="") as file:
        rows = np.array([[float(x) for x in row.values()] for row in csv.DictReader(file)])[:, 1:]
    rows = rows[:len(rows) // window * window].reshape(-1, window, 6)
    mean, spread = rows.mean(axis=1), rows.std(axis=1)
    force = mean[:, :3] / G
    true = np.where(np.abs(force) > 0.9, np.sign(force), 0.0)
    rest = (np.abs(true).sum(axis=1) == 1) & (spread[:, 3:].max(axis=1) < np.radians(0.5)) & (
        np.abs(force - true).max(axis=1) < 0.05)
    return 1e3 * (force - true)[rest], np.degrees(mean[rest, 3:])
