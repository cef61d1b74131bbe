"""Third phase: are the captured poses fit to solve from? And the record is begun."""

from sixflip.poses.pose_check import judge_session

from ..record.blank_record import blank_record


def _temperature(imu, placements):
    """Mean over the poses, degrees C, or None."""
    n = sum([p.n for p in placements])
    if not imu.has_temp or not n:
        return None
    return sum([p.sums[6] for p in placements]) / n / imu.temp_lsb_per_c + imu.temp_offset_c


def _begin_record(unit, taken):
    """The record knows its sensor; from here on nobody needs the driver in the heap."""
    imu = unit.sensor.imu
    taken.record = record = blank_record(unit)
    record.session = taken.session
    taken.gyro_tolerance = imu.gyro_tolerance
    record.temp_c = _temperature(imu, taken.placements)
    unit.sensor = None


def run(unit):
    taken = unit.taken
    rail = unit.sensor.imu.accel_rail
    _begin_record(unit, taken)
    taken.found = judge_session(taken.placements, taken.record.accel_lsb_per_g, rail=rail)
    taken.angles = None
    taken.flips = {"taken_as": "180 degrees",
                   "reason": "no gyro was calibrated in an earlier session"}
    earlier = unit.record is not None or unit.slot is not None
    return "flips_turned" if earlier and taken.record.gyro_lsb_per_dps else "solving"
