"""Find out which sensor is on the bus, by identification registers.

A scan alone proves nothing (rp2 bit-bangs it, and several chips share an address): what
counts is the answer of the register that holds the identification.
"""

import errno

from sixflip.chips import magnetometers

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

_GYRO_ADDRESSES = (0x68, 0x69)
_ACCEL_ADDRESSES = (0x53, 0x1D)
_ATTEMPTS = const(4)            # a glitch may spoil one answer: two have to be the same
_NOBODY = const(0x7C)           # reserved (10-bit addressing): no chip answers there


class NoChip(OSError):
    """No usable sensor: .report says line by line what was asked and what answered."""

    def __init__(self, report, code=errno.ENODEV):
        super().__init__(code, "; ".join(report))
        self.report = report


class BusStuck(NoChip):
    """The bus itself does not work: a line is held low. Recover it, then look again."""


def _answer(i2c, address, register, n=1):
    """Bytes of an identification register, or None when nobody answers at the address."""
    try:
        return i2c.readfrom_mem(address, register, n)
    except OSError as error:
        if not error.args or error.args[0] != errno.ETIMEDOUT:
            return None
    raise BusStuck(["time-out at 0x%02x: a line of the bus is held low, or there are no "
                    "pull-up resistors" % address], errno.ETIMEDOUT)


def _identify(i2c, address, register, known, mask=0xFF):
    """Answer of the register; asked until one of the known came twice in a row."""
    answer = None
    for _ in range(_ATTEMPTS):
        found = _answer(i2c, address, register)
        if found is not None:
            if found[0] & mask in known and found[0] == answer:
                break
            answer = found[0]
    return answer


def _list(ids):
    return " ".join(["0x%02x" % i for i in sorted(ids)])


def _look_at_gyro_address(i2c, address, report):
    """("mpu6050", id), ("itg3205", id) or None for what answers at 0x68 or 0x69."""
    from sixflip.chips import itg3205, mpu6050
    who_am_i = _identify(i2c, address, mpu6050.WHO_AM_I, mpu6050.RELATIVES)
    if who_am_i is None:
        return None
    if who_am_i in mpu6050.RELATIVES:
        report.append("0x%02x: %s (who_am_i 0x%02x)"
                      % (address, mpu6050.RELATIVES[who_am_i], who_am_i))
        return "mpu6050", who_am_i
    other = _identify(i2c, address, itg3205.WHO_AM_I, (itg3205.ID,), itg3205.ID_MASK)
    if other is not None and other & itg3205.ID_MASK == itg3205.ID:
        report.append("0x%02x: ITG3205 (who_am_i 0x%02x)" % (address, other))
        return "itg3205", other
    report.append("0x%02x answers who_am_i 0x%02x: not an MPU6050 or relative (%s), nor an "
                  "ITG3205 (register 0x00 reads %s, expected 0x68)"
                  % (address, who_am_i, _list(mpu6050.RELATIVES),
                     "nothing" if other is None else "0x%02x" % other))
    return None


def _look_at_accel_address(i2c, address, report):
    """True for an ADXL345. A chip that answers otherwise at 0x1d may be anything."""
    from sixflip.chips import adxl345
    answer = _identify(i2c, address, adxl345.DEVID, (adxl345.DEVICE_ID,))
    if answer is None:
        return False
    if answer == adxl345.DEVICE_ID:
        report.append("0x%02x: ADXL345 (id 0xe5)" % address)
        return True
    report.append("0x%02x answers id 0x%02x: not an ADXL345 (0xe5)" % (address, answer))
    return False


def _look_for_magnetometers(i2c, report):
    for name, address, register, expected in magnetometers.KNOWN:
        answer = _answer(i2c, address, register, len(expected))
        if answer is None:
            continue
        if answer == expected:
            report.append("0x%02x: %s, a magnetometer, not used" % (address, name))
        else:
            report.append("0x%02x answers %s: not the magnetometer %s"
                          % (address, _list(set(answer)), name))


def _look(i2c, report):
    """({"mpu6050" or "itg3205": (address, id)}, address of the ADXL345 or None)."""
    gyros = {}
    for address in _GYRO_ADDRESSES:
        found = _look_at_gyro_address(i2c, address, report)
        if found and found[0] not in gyros:
            gyros[found[0]] = (address, found[1])
        elif found:
            report.append("0x%02x: a second one, not used" % address)
    accel = None
    for address in _ACCEL_ADDRESSES:
        if _look_at_accel_address(i2c, address, report) and accel is None:
            accel = address
    _look_for_magnetometers(i2c, report)
    return gyros, accel


def find(i2c, sleep_ms=None, sensor="auto"):
    """(imu, report) of the sensor on the bus, an MPU6050 before a GY-85 before an ADXL345.

    sensor: "auto" or the one that must be there, "mpu6050", "gy85" or "adxl345".
    Raises NoChip with .report, a list of lines (BusStuck, errno ETIMEDOUT, when the bus
    does not work). The imu is not configured yet.
    """
    if sensor not in ("auto", "mpu6050", "gy85", "adxl345"):
        raise ValueError("sensor is %r, expected auto, mpu6050, gy85 or adxl345" % sensor)
    report = []
    gyros, accel = _look(i2c, report)
    if "mpu6050" in gyros and sensor in ("auto", "mpu6050"):
        from sixflip.chips.mpu6050 import MPU6050
        address, who_am_i = gyros["mpu6050"]
        return MPU6050(i2c, address, who_am_i, sleep_ms), report
    if accel is not None and "itg3205" in gyros and sensor in ("auto", "gy85"):
        from sixflip.chips.gy85 import GY85
        address, who_am_i = gyros["itg3205"]
        return GY85(i2c, accel, address, who_am_i, sleep_ms), report
    if accel is not None and sensor in ("auto", "adxl345"):
        from sixflip.chips.adxl345 import ADXL345
        if sensor == "auto":
            report.append("no gyro: lift the box for a flip, which is taken as 180 degrees")
        return ADXL345(i2c, accel, sleep_ms), report
    if _answer(i2c, _NOBODY, 0) is not None:
        raise BusStuck(["every address answers, the reserved 0x7c too: SDA is held low"],
                       errno.ETIMEDOUT)
    raise NoChip(_complaint(sensor, gyros, accel, report))


def _complaint(sensor, gyros, accel, report):
    if not report:
        report.append("nobody answers at 0x68, 0x69, 0x53 or 0x1d: check power, SDA, SCL and "
                      "pull-ups")
    elif sensor != "auto":
        report.append("the settings ask for %s, which is not there" % sensor)
    elif "itg3205" in gyros and accel is None:
        report.append("a gyro without accelerometer: a GY-85 has an ADXL345 at 0x53")
    else:
        report.append("no accelerometer found")
    return report
