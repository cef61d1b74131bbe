"""How far the flips turned, by a gyro that was calibrated in an earlier session (METHOD 1).

By this session's own gyro it would be circular: its scale is to come from these flips.
"""

import math

from sixflip.gyro.flips import measured_angles, worthwhile
from sixflip.poses.faces import AXIS, FACES

from ..record.active_record import again


def _measure(taken, old):
    """(angles, what the record says of them, why 180 degrees are assumed)"""
    gyro = old.gyro if old is not None else None
    if gyro is None or old.session == taken.record.session:
        return {}, None, "no gyro was calibrated in an earlier session"
    if gyro["verdict"] != "good":
        return {}, None, "the stored gyro is " + gyro["verdict"]
    known = [k for k in range(3) if k not in gyro["missing"]]
    sigma = max([gyro["sigma_P"][k][k] for k in known])
    try:
        found = measured_angles(taken.placements, taken.moves, taken.record.gyro_lsb_per_dps,
                                gyro["P"])
    except ValueError as e:
        return {}, None, str(e)
    angles = worthwhile({f: found[f] for f in found if AXIS[f] in known}, sigma)
    if not angles:
        return {}, None, "the stored gyro saw no flip off by more than its own error"
    return angles, {"excess": [angles.get(f, math.pi) - math.pi for f in range(6)],
                    "scale_sigma": sigma, "sequence": old.sequence}, ""


def run(unit):
    taken = unit.taken
    again(unit, taken.record)
    old = unit.record
    unit.let_go()
    taken.angles, taken.record.flips, reason = _measure(taken, old)
    taken.flips = {"taken_as": "measured" if taken.angles else "180 degrees", "reason": reason,
                   "angles_deg": {FACES[f]: math.degrees(taken.angles[f])
                                  for f in sorted(taken.angles)}}
    return "solving"
