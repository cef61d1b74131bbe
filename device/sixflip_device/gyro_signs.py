"""What the moves between the faces say of the gyro, before it is judged: is an axis inverted or
exchanged, were the flips half turns?"""

from sixflip.flip_turns import mean_rate
from sixflip.gyro_axes import wrong_axes
from sixflip.half_turns import excess


def run(unit):
    taken = unit.taken
    r = taken.gyro
    lsb_per_dps = taken.record.gyro_lsb_per_dps
    r.wrong_axes, r.signs_seen = wrong_axes(taken.placements, taken.moves, lsb_per_dps,
                                            mean_rate(taken.placements, lsb_per_dps))
    if taken.record.accel:
        r.excess = excess(taken.placements, taken.moves, taken.record.accel_lsb_per_g, r,
                          taken.record.accel["P"])
    taken.placements = taken.moves = None
    return "judging_gyro"
