"""A record that knows its sensor and holds nothing measured yet."""

from sixflip.record.record import Record


def blank_record(unit):
    imu = unit.sensor.imu
    record = Record()
    record.chip = imu.sensor
    record.who_am_i = tuple(imu.who_am_i)
    record.accel_range_g = imu.accel_range_g
    record.gyro_range_dps = imu.gyro_range_dps
    record.accel_lsb_per_g = imu.accel_lsb_per_g
    record.gyro_lsb_per_dps = imu.gyro_lsb_per_dps
    record.g = unit.settings["g"]
    return record
