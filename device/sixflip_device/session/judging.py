"""Fifth phase: the verdict on the accelerometer, and what of its result is kept."""

from array import array

from sixflip.accelerometer.verdict import judge_result
from sixflip.poses.faces import pose_name


def _rms_g(residual):
    """Root mean square over poses and axes, g."""
    squares = [x * x for pose in residual for x in residual[pose]]
    return (sum(squares) / len(squares)) ** 0.5


def _bias_dps(placements, lsb_per_dps):
    """Mean of the gyro over all rests."""
    n = sum([p.n for p in placements])
    return [sum([p.sums[3 + k] for p in placements]) / n / lsb_per_dps for k in range(3)]


def _facts(r):
    """What the host is told of the result."""
    return {"level": r.level, "tilt_deg": r.tilt_deg, "tilt_spread_deg": r.tilt_spread_deg,
            "residual_mg_rms": 1000 * _rms_g(r.residual),
            "residual_mg": {pose_name(p): array("f", [1000 * x for x in r.residual[p]])
                            for p in r.residual},
            "scale": r.scale, "v": r.v, "noise_mg": 1000 * r.noise_g}


def run(unit):
    taken = unit.taken
    record = taken.record
    r = taken.accel
    taken.verdict, taken.reason = taken.found or judge_result(r, taken.failure)
    taken.facts = {}
    if r is not None:
        taken.facts = _facts(r)
        taken.facts["flips"] = taken.flips
        record.accel = {
            "P": r.P, "sigma_P": r.sigma_P, "tilt_deg": r.tilt_deg,
            "tilt_spread_deg": r.tilt_spread_deg, "residual_rms_g": _rms_g(r.residual),
            "noise_g": r.noise_g, "level": r.level, "verdict": taken.verdict,
            "reason": taken.reason}
    taken.accel = None
    if record.gyro_lsb_per_dps:
        record.gyro_bias = {"bias_dps": _bias_dps(taken.placements, record.gyro_lsb_per_dps),
                            "temp_c": record.temp_c}
    return "remember"
