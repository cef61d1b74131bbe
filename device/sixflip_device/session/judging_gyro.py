"""The verdict on the gyro. A matrix nobody should use is not kept."""

from sixflip.gyro.verdict import judge_gyroscope


def _section(r):
    return {"P": r.P, "sigma_P": r.sigma, "missing": r.missing, "verdict": r.verdict,
            "reason": r.reason}


def _facts(r):
    """What the host is told of the result."""
    return {"verdict": r.verdict, "reason": r.reason, "bias_dps": r.bias_dps,
            "missing": ["xyz"[k] for k in r.missing], "scale": [r.P[k][k] for k in range(3)],
            "flips": {face: {"angle_deg": r.flips[face]["angle_deg"],
                             "used": r.flips[face]["used"]} for face in r.flips}}


def run(unit):
    taken = unit.taken
    r = taken.gyro
    r.verdict, r.reason = judge_gyroscope(r)
    taken.facts["gyro"] = _facts(r)
    if r.verdict != "refused" or (
            taken.gyro_kept and len(r.missing) == 3 and not r.wrong_axes):
        taken.record.gyro = _section(r)
    return "judging_flips"
