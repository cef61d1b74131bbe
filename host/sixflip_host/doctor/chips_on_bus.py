"""Who a chip is by its identification registers: known, a clone, one that is not driven, or two
on one address.

ids: {(address, register): bytes, or the error number}.
"""

from sixflip.chips import adxl345, catalogue, itg3205, mpu6050, probe

from .finding import fault, ok, warning

# WHO_AM_I (register 0x75) of InvenSense chips that are not driven by this firmware; their data
# sheets' register maps.
NOT_DRIVEN = {0x12: "ICM-20602", 0x19: "MPU-6886", 0x24: "ICM-20600 or a relative",
              0x67: "ICM-42670-P", 0x6F: "IAM-20380", 0xAC: "ICM-20690", 0xAF: "ICM-20608-G",
              0x6B: "ICM-42607", 0x74: "MPU-6515", 0x75: "MPU-6555 class"}
MPU6050 = catalogue.ids_of("mpu6050")
CLONES = (0x98, 0x72)
QMC5883L, HMC5883L = (0x0D, 0x0D), (0x1E, 0x0A)


def byte(ids, address, register):
    """The answer of an identification register, or None."""
    answer = ids.get((address, register))
    return answer[0] if isinstance(answer, bytes) else None


def shared_address(ids):
    """Two chips on one address pull the same bits: neither can be identified, or both are."""
    for address in (0x68, 0x69):
        motion, other = byte(ids, address, mpu6050.WHO_AM_I), byte(ids, address, itg3205.WHO_AM_I)
        if motion is None:
            continue
        is_itg = other is not None and other & itg3205.ID_MASK == itg3205.ID
        is_mpu = motion in MPU6050
        with_adxl = byte(ids, 0x53, adxl345.DEVID) == adxl345.DEVICE_ID
        if any(at_one.state == "ok" for at_one in at_address(ids, address)
               if "ITG3205" not in at_one.found and not is_mpu):
            continue
        if (is_itg and is_mpu) or (with_adxl and not is_itg and not is_mpu
                                   and motion not in NOT_DRIVEN):
            return [fault("chips", "two chips seem to answer at 0x%02x: an ID of 0x%02x at 0x75 "
                          "and 0x%02x at 0x00, beside %s" % (
                              address, motion, other or 0,
                              "an ADXL345 (of a GY-85, whose ITG3205 is there too)" if with_adxl
                              else "each other"),
                          "a GY-85's ITG3205 and an MPU6050 share that address: tie AD0 of the "
                          "MPU6050 to 3.3 V, which moves it to 0x69, or unplug one of them")]
    return []


def catalogued():
    """Every address at which a chip of the catalogue may answer, in its order."""
    return list(dict.fromkeys(address for row in catalogue.CHIPS for address in row[2]))


def at_address(ids, address):
    """What is at an address of the catalogue: known, a clone, or a chip that is not driven."""
    asked = {}
    for sensor, _, addresses, register, names, _, mask in catalogue.CHIPS:
        if address not in addresses or byte(ids, address, register) is None:
            continue
        who = asked[register] = byte(ids, address, register)
        if who & mask not in names:
            continue
        what = "%s at 0x%02x" % (names[who & mask], address)
        if len(names) > 1:
            what += " (who_am_i 0x%02x)" % who
        if sensor in catalogue.NOT_DRIVEN and sensor != "itg3205":
            return [warning("chips", what, catalogue.NOT_DRIVEN[sensor])]
        if sensor == "mpu6050" and who in CLONES:
            return [warning("chips", "a clone at 0x%02x: who_am_i 0x%02x (%s)" % (
                address, who, names[who]),
                "it is used as the MPU6500 it mostly is (temperature, filter); judge it by the "
                "noise and residuals of its calibration")]
        return [ok("chips", what)]
    if not asked or address in (0x53, 0x1D):
        return []
    who = asked.get(mpu6050.WHO_AM_I, asked[max(asked)])
    name = NOT_DRIVEN.get(who) if mpu6050.WHO_AM_I in asked else None
    return [fault("chips", "0x%02x answers who_am_i 0x%02x: %s" % (
        address, who, name or probe.nearest(address, asked)),
        "this firmware does not drive it, docs/wiring.md lists what it drives; a clone is used "
        "where sixflip.json names its sensor: sixflip provision --sensor …", True)]


def magnetometers(ids):
    """A QMC5883L sold as an HMC5883L: harmless here, but named."""
    if ids.get(QMC5883L) == b"\xff":
        return [warning("chips", "the magnetometer is a QMC5883L (0x0d), not the HMC5883L that "
                        "such boards are sold with", "nothing for sixflip, which does not use "
                        "it; other programs need a driver for the QMC5883L")]
    if ids.get(HMC5883L) == b"H43":
        return [ok("chips", "magnetometer HMC5883L, not used")]
    return []
