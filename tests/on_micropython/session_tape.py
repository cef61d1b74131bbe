"""Records on CPython what firmware_in_a_small_heap.py plays: the twelve poses, burst by burst."""

import json

from sixflip.chips import adxl345, itg3205, mpu6050
from sixflip_sim import tape, worlds

# address, data register, length of a burst, identification, bits that clear themselves
CHIPS = {
    "mpu6050": [(0x68, mpu6050.ACCEL_XOUT_H, mpu6050.BURST, {mpu6050.WHO_AM_I: 0x68},
                 {mpu6050.PWR_MGMT_1: mpu6050.RESET})],
    "gy85": [(0x53, adxl345.DATAX0, adxl345.BURST, {adxl345.DEVID: adxl345.DEVICE_ID}, {}),
             (0x68, itg3205.TEMP_OUT_H, itg3205.BURST, {itg3205.WHO_AM_I: itg3205.ID},
              {itg3205.PWR_MGM: itg3205.RESET})],
}
WORLD = {"tilt_deg": 2.0, "first_rest_s": 8.0, "dwell_s": 6.0, "move_s": 2.5}


def write(folder, sensor, world=WORLD):
    """tape.json and a file of bursts for every chip; the number of samples."""
    names = ["chip%d.tape" % i for i in range(len(CHIPS[sensor]))]
    described = []
    for chip, name in zip(CHIPS[sensor], names):
        keys = ("address", "data_register", "length", "identity", "self_clearing")
        described.append(dict(zip(keys, chip), tape=name))
    (folder / "tape.json").write_text(json.dumps(described))
    files = [open(folder / name, "wb") for name in names]  # noqa: SIM115 - closed below
    try:
        return tape.record(worlds.make(dict(world, sensor=sensor)), files)
    finally:
        for file in files:
            file.close()
