"""The scenario file for `sixflip simulate` that holds the effects found, and its plan."""
import json
import math
from pathlib import Path

import numpy as np

from sixflip.chips.catalogue import SENSORS
from sixflip.poses import faces

from .. import atomic_write
from ..planning import plan_file, protocols
from . import closed_loop


def plan_of(session):
    """SessionPlan of a captured session: its poses, their times and its temperature."""
    rests = []
    for place, (code, first, end) in enumerate(session.runs):
        start = session.runs[place - 1][2] if place else 0
        dwell = max(0.5, round((end - first) / session.rate, 2))
        move = max(0.1, round((first - start) / session.rate, 2))
        name = faces.pose_name(code)
        mean = session.capture.accel[first:end].mean(axis=0)
        up = mean / max(np.linalg.norm(mean), 1e-9)
        timing = {"dwell_s": dwell, "move_s": move}
        rests.append(protocols.face_rest(code, **timing) if code <= 12
                     else protocols.Rest(name, tuple(up.tolist()), **timing))
    end_c, change, tau = closed_loop.cooling(session)
    return protocols.SessionPlan(rests, "measured", round(end_c - change, 2), round(change, 2),
                                 tau)


def plan_beside(path):
    """Where the plan of a scenario file is."""
    return Path(path).with_suffix(".plan.json")


def write(path, diagnosis, effects):
    """Write PATH (TOML) and beside it the plan it names; returns both paths."""
    path = Path(path)
    sessions = next(iter(diagnosis.gaps.values())).sessions
    plan = plan_beside(path)
    plan_file.write(str(plan), protocols.Protocol("measured", [plan_of(s) for s in sessions]))
    first = sessions[0]
    sensor = first.capture.meta["sensor"]
    lines = ["# The nominal simulator with the effects that `sixflip diagnose` found.",
             "sensor = %s" % json.dumps(sensor if sensor in SENSORS else "mpu6050"),
             "plan = %s" % json.dumps(str(plan)), "rate_hz = %g" % first.rate, "", "[world]",
             "accel_noise_mg = %.4g" % (float(first.noise_accel.mean()) * math.sqrt(first.rate))]
    if first.gyro is not None:
        lines.append("gyro_noise_dps = %.4g" % (float(first.noise_gyro.mean())
                                                * math.sqrt(first.rate)))
    for spec in effects:
        lines += ["", "[[effects]]"]
        lines += ["%s = %s" % (key, json.dumps(value)) for key, value in spec.items()]
    atomic_write.write_text(str(path), "\n".join(lines) + "\n")
    return path, plan
