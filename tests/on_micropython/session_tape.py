"""Records on CPython what firmware_in_a_small_heap.py plays: the twelve poses, burst by burst."""

import json

from sixflip_sim import tape, worlds

KEYS = ("address", "data_register", "length", "identity", "self_clearing")
SENSORS = ("mpu6050", "gy85", "lsm6dsox")
WORLD = {"tilt_deg": 2.0, "first_rest_s": 8.0, "dwell_s": 6.0, "move_s": 2.5}


def write(folder, sensor, world=WORLD):
    """tape.json and a file of bursts for every chip; the number of samples."""
    names = ["chip%d.tape" % i for i in range(len(tape.described(sensor)))]
    described = []
    for chip, name in zip(tape.described(sensor), names):
        described.append(dict(zip(KEYS, chip), tape=name))
    (folder / "tape.json").write_text(json.dumps(described))
    files = [open(folder / name, "wb") for name in names]  # noqa: SIM115 - closed below
    try:
        return tape.record(worlds.make(dict(world, sensor=sensor)), files)
    finally:
        for file in files:
            file.close()
