"""The record before this session, read again for what is kept of it."""

from ..record.active_record import again


def run(unit):
    again(unit, unit.taken.record)
    return "solving_gyro" if unit.taken.record.gyro_lsb_per_dps else "saving"
