"""The gyro from the same session: its flips and rests (METHOD 2)."""

from sixflip.gyro.solver import solve_matrix


def run(unit):
    """Axes without a flip keep what the record before has for them."""
    taken = unit.taken
    record = taken.record
    old = unit.record.gyro["P"] if unit.record is not None and unit.record.gyro else None
    taken.gyro_kept = old is not None
    try:
        taken.gyro = solve_matrix(taken.placements, taken.moves, record.gyro_lsb_per_dps,
                                  record.accel and record.accel["P"], old)
    except ValueError as e:
        taken.facts["gyro"] = {"verdict": "refused", "reason": str(e)}
        return "saving"
    return "gyro_signs"
