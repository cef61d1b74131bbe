"""Every chip that is known: where it answers, by which register, and whose driver it is.

A row a chip, the better known first: `auto` takes the first that answers. A driver is imported
when its chip has answered, so that a board holds this table and one driver.

sensor, driver, addresses, register, ids    what sixflip.json, captures and records call it; its
        module and class in this folder, "" for a chip that is only recognised; where it may
        answer; the register of its identification, and {answer: name}
bank    None, or the register of the bank in which the identification is: 0 there shows it again
mask    the bits of the answer that count
"""

_SENSOR, _DRIVER, _ADDRESSES, _REGISTER, _IDS, _BANK, _MASK = range(7)
_68, _6A = (0x68, 0x69), (0x6A, 0x6B)

CHIPS = (
    # MPU-6000 register map 4.2, register 117; MPU-6500 2.1; 0x98 and 0x72 were met on boards
    ("mpu6050", "mpu6050.MPU6050", _68, 0x75, {
        0x68: "MPU6050", 0x70: "MPU6500", 0x71: "MPU9250", 0x73: "MPU9255",
        0x98: "ICM20689 or MPU6050 clone", 0x72: "MPU6050 clone"}, None, 0xFF),
    # DS12814 rev. 4, DocID030071 rev. 3 and DS13476 rev. 5, all of WHO_AM_I (0Fh)
    ("lsm6dsox", "lsm6ds.LSM6DSOX", _6A, 0x0F, {0x6C: "LSM6DSOX or LSM6DSO"}, 0x01, 0xFF),
    ("lsm6ds3trc", "lsm6ds.LSM6DS3TRC", _6A, 0x0F, {0x6A: "LSM6DS3TR-C"}, 0x01, 0xFF),
    ("lsm6dsv", "lsm6dsv.LSM6DSV", _6A, 0x0F, {0x70: "LSM6DSV or LSM6DSV16X"}, 0x01, 0xFF),
    # DS-000347 rev. 1.5, 14.58; DS-000577 rev. 1.0, WHO_AM_I (72h); DS-000189 rev. 1.3, 8.1
    ("icm42688", "icm42688.ICM42688", _68, 0x75, {0x47: "ICM-42688-P"}, 0x76, 0xFF),
    ("icm45686", "icm45686.ICM45686", _68, 0x72, {0xE9: "ICM-45686"}, None, 0xFF),
    ("icm20948", "icm20948.ICM20948", _68, 0x00, {0xEA: "ICM-20948"}, 0x7F, 0xFF),
    # 13-52-25 rev. A, table 21; the other way round than ST's: 0x6b is the usual one
    ("qmi8658", "qmi8658.QMI8658", (0x6B, 0x6A), 0x00, {0x05: "QMI8658"}, None, 0xFF),
    # BST-BMI160-DS000-07 rev. 0.8, CHIP_ID (00h)
    ("bmi160", "bmi160.BMI160", _68, 0x00, {0xD1: "BMI160"}, None, 0xFF),
    # two chips, see probe.py
    ("gy85", "gy85.GY85", (), None, {}, None, 0xFF),
    # ITG-3205 rev. 1.0, section 8.1: bits 6:1; the others may read anything
    ("itg3205", "itg3205.ITG3205", _68, 0x00, {0x68: "ITG3205"}, None, 0x7E),
    # ADXL345 rev. E, register 0x00
    ("adxl345", "adxl345.ADXL345", (0x53, 0x1D), 0x00, {0xE5: "ADXL345"}, None, 0xFF),
    # BST-BMI270-DS000, CHIP_ID (00h)
    ("bmi270", "", _68, 0x00, {0x24: "BMI270"}, None, 0xFF),
)
# Why a chip that is recognised is not used.
NOT_DRIVEN = {
    "itg3205": "a gyro without accelerometer: a GY-85 has an ADXL345 at 0x53",
    "bmi270": "it measures nothing before its maker's configuration file is loaded, which this "
              "firmware does not have"}

# Those that are used on SPI as well: it reads their registers as I2C does. (A BMI270 sends a byte
# before them, an ADXL345 wants a bit for more than one; an MPU6050 has none, its relatives have.)
ON_SPI = ("mpu6050", "lsm6dsox", "lsm6ds3trc", "lsm6dsv", "icm42688", "icm45686", "icm20948",
          "qmi8658")

SENSORS = tuple([row[_SENSOR] for row in CHIPS if row[_SENSOR] not in NOT_DRIVEN])


def row_of(sensor):
    """The row of a sensor; ValueError naming the choices."""
    for row in CHIPS:
        if row[_SENSOR] == sensor:
            return row
    raise ValueError("sensor is %r, expected auto or one of %s" % (sensor, " ".join(SENSORS)))


def ids_of(sensor):
    """{answer of the identification register: name}."""
    return row_of(sensor)[_IDS]


def name_of(sensor, who_am_i):
    """Name of the chip behind an answer; of an answer that is nobody's, whom it is taken for."""
    ids = ids_of(sensor)
    return ids[who_am_i] if who_am_i in ids else ids[min(ids)] + " clone"


def driver(sensor):
    """The class of a sensor's driver, imported now."""
    module, name = row_of(sensor)[_DRIVER].split(".")
    return getattr(__import__("sixflip.chips." + module, None, None, [name]), name)
