"""Fourth phase: the accelerometer's parameters from the session's placements."""

from sixflip.accelerometer.solver import solve


def run(unit):
    taken = unit.taken
    taken.accel = None
    taken.failure = ""
    try:
        taken.accel = solve(taken.placements, taken.record.accel_lsb_per_g, taken.record.g,
                            angles=taken.angles)
        taken.accel.across = None  # told by the tilts
    except ValueError as e:
        taken.failure = str(e)
    return "judging"
