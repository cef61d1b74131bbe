"""Is a gyro axis inverted or exchanged? Asked of the moves, before the gyro is judged."""

from sixflip.gyro.axis_signs import wrong_axes
from sixflip.gyro.flips import mean_rate


def run(unit):
    taken = unit.taken
    r = taken.gyro
    lsb_per_dps = taken.record.gyro_lsb_per_dps
    r.wrong_axes, r.signs_seen = wrong_axes(taken.placements, taken.moves, lsb_per_dps,
                                            mean_rate(taken.placements, lsb_per_dps))
    return "holding_flips"
