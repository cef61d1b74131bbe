"""Is every capture what its label says: still, alive, in range, on that face?"""

from sixflip import RAIL
from sixflip.poses.faces import FACES, face_of_code, nearest_face, pose_name

# A pose this much noisier than the middle one was not at rest.
NOISIER = 3.0
LEANS_DEG = 30.0
# An axis with so many counts of noise elsewhere does not repeat itself for a whole pose.
ALIVE = 0.5


def judge_session(placements, lsb_per_g, missing=(), rail=RAIL, halves=None):
    """("refused", sentence) when a face or pose is missing or one is no good, else None."""
    have = {(p.pose - 1) // 2 for p in placements if 1 <= p.pose <= 12}
    absent = [FACES[f] for f in range(6) if f not in have]
    if absent:
        return "refused", "face %s is missing: put the box on it" % " and ".join(absent)
    if missing:
        return "refused", "not finished: %s missing" % ", ".join([pose_name(c) for c in missing])
    return judge_poses(placements, lsb_per_g, rail, halves)


def judge_poses(placements, lsb_per_g, rail=RAIL, halves=None):
    """("refused", sentence) for the first capture that cannot be used, or None."""
    used = [p for p in placements if face_of_code(p.pose) >= 0]
    has_gyro = [1 for p in used if p.sums[3] or p.sums[4] or p.sums[5]]
    middle = [_middle([p.noise[k] for p in used]) for k in range(3)]
    for p in used:
        name = pose_name(p.pose)
        if not p.n >= 10:
            return "refused", "pose %s has %d samples, 10 is the least" % (name, p.n)
        for k in range(3):
            # Three sigma: whatever touches full scale now and then is cut off on one side.
            peak = (abs(p.sums[k]) + 3.0 * p.noise[k] * p.n) / p.n
            if not peak < rail:
                return "refused", ("pose %s is saturated: axis %s reaches %.0f counts of %d"
                                   % (name, "xyz"[k], peak, rail))
        stale = not any(p.noise[:3])
        if stale or (has_gyro and not any(p.noise[3:6])):
            return "refused", ("pose %s is stale: %d identical %s readings, the sensor hangs"
                               % (name, p.n, "accelerometer" if stale else "gyro"))
        for k in range(3):
            if not p.noise[k] and middle[k] > ALIVE:
                return "refused", ("pose %s is stale: %d identical readings of axis %s, the "
                                   "sensor hangs" % (name, p.n, "xyz"[k]))
            limit = NOISIER * middle[k] + 1.0
            if not p.noise[k] <= limit:
                return "refused", ("pose %s moved while it was captured: noise %.1f counts on "
                                   "axis %s, %.1f is the limit"
                                   % (name, p.noise[k], "xyz"[k], limit))
    return _judge_halves(placements, lsb_per_g, halves) or _judge_labels(used)


def _judge_halves(placements, lsb_per_g, halves):
    """A box pushed in mid-capture: the two halves differ by more than noise and 0.2 degrees."""
    for p, half in zip(placements, halves or ()):
        if face_of_code(p.pose) < 0:
            continue
        for k in range(3):
            limit = 5.0 * 2.0 * p.noise[k] / p.n ** 0.5 + 0.0035 * lsb_per_g
            if not abs(half[k]) <= limit:
                return "refused", ("pose %s moved while it was captured: its halves differ by "
                                   "%.1f counts on axis %s, %.1f is the limit"
                                   % (pose_name(p.pose), abs(half[k]), "xyz"[k], limit))
    return None


def _judge_labels(used):
    """Labels against gravity: a wrong one, swapped poses, an inverted or exchanged axis."""
    wrong = []
    seen = {}
    for p in used:
        face, off = nearest_face(p.sums[0], p.sums[1], p.sums[2])
        named = face_of_code(p.pose)
        if face != named:
            wrong.append((p, face))
            seen.setdefault(named, face)
        elif not off <= LEANS_DEG:
            return "refused", ("pose %s leans %.0f degrees off face %s, %.0f is the limit"
                               % (pose_name(p.pose), off, FACES[named], LEANS_DEG))
    if not wrong:
        return None
    flipped = [f for f in seen if seen[f] == f ^ 1]
    if len(wrong) > 2 and len(flipped) == len(seen) and len(seen) % 2 == 0:
        axes = [FACES[f][0].lower() for f in sorted(seen) if not f & 1]
        return "refused", ("negative scale: gravity is upside down on axis %s, the axis is "
                           "inverted or its two faces are exchanged" % " and ".join(axes))
    text = ", ".join(["%s shows %s" % (pose_name(p.pose), FACES[f]) for p, f in wrong[:3]])
    if len(wrong) > 3:
        text += " and %d more" % (len(wrong) - 3)
    return "refused", "gravity contradicts the label: %s up; are poses or axes exchanged?" % text


def _middle(values):
    ordered = sorted(values)
    return ordered[len(ordered) // 2]
