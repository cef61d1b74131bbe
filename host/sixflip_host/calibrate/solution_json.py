"""A Solution as the JSON of `sixflip solve --json`."""

import numpy as np

from sixflip.poses.faces import FACES, pose_name


def to_json(solution):
    """The answer of `solve --json`, as the capture format's description says."""
    r = solution.accel
    accel = {"P": None, "T": None, "scale": None, "v": None, "sigma": None, "residual_mg": {},
             "tilt_deg": None, "tilt_spread_deg": None, "level": None}
    if r:
        accel = {
            "P": r.P, "T": r.T, "scale": r.scale, "v": r.v,
            "sigma": {"P": r.sigma_P, "scale": r.sigma_scale, "v": r.sigma_v},
            "residual_mg": {pose_name(pose): [1e3 * x for x in left]
                            for pose, left in sorted(r.residual.items())},
            "tilt_deg": r.tilt_deg, "tilt_spread_deg": r.tilt_spread_deg, "level": r.level}
    accel.update(verdict=solution.verdict, reason=solution.reason)
    return {"format": 1, "sensor": solution.capture.meta["sensor"], "g": solution.g,
            "accel": accel, **_gyro_json(solution), "flips": _flips_json(solution)}


def _flips_json(solution):
    flips = solution.flips
    return {"taken_as": "measured" if flips.angles else "180 degrees", "reason": flips.reason,
            "faces": {FACES[face]: {
                "measured_deg": degrees, "sigma_deg": sigma,
                "used_deg": float(np.degrees(flips.angles.get(face, np.pi)))}
                for face, (degrees, sigma) in flips.measured.items()}}


def _gyro_json(solution):
    gyro = solution.gyro
    if gyro is None:
        return {"gyro": None, "gyro_reason": solution.no_gyro}
    # Standard errors of what was measured: an axis that was not flipped has none.
    sigma = [[None] * 3 if k in gyro.missing else row for k, row in enumerate(gyro.sigma)]
    return {"gyro": {
        "P": gyro.P, "bias_dps": gyro.bias_dps,
        "sigma": {"P": sigma, "bias_dps": gyro.sigma_bias_dps},
        "flips": gyro.flips, "verdict": gyro.verdict, "reason": gyro.reason}}
