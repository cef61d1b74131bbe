"""Were the flips half turns? The moves between the faces tell, before the gyro is judged."""

from sixflip.gyro.half_turns import excess


def run(unit):
    taken = unit.taken
    record = taken.record
    if record.accel:
        taken.gyro.excess = excess(taken.placements, taken.moves, record.accel_lsb_per_g,
                                   taken.gyro, record.accel["P"])
    taken.placements = taken.moves = None
    return "judging_gyro"
