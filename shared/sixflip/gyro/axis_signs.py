"""Is a gyro axis inverted or exchanged? Gravity before and after a move tells (METHOD 2).

A flip cannot: turned either way it ends the same. The integral of a move, taken as one turn
about its mean axis, must carry gravity of the face before to that of the face after; so must
every other reading of the axes, and the one that does is the sensor's.
"""

import math

from sixflip.gyro.flips import turn
from sixflip.poses.faces import AXIS, SIGN, face_of_code
from sixflip.poses.placement import has_gap

ORDERS = ((0, 1, 2), (1, 0, 2), (2, 1, 0), (0, 2, 1), (1, 2, 0), (2, 0, 1))
# Squared distances between unit vectors: 45 degrees is 0.6, a right angle 2.
MISSED = 1.0
FITS = 0.3


def wrong_axes(placements, moves, lsb_per_dps, bias):
    """(sentence or "", axes 0..2 whose sign the moves have confirmed)."""
    evidence = _evidence(placements, moves, lsb_per_dps, bias)
    if not evidence:
        return "", []
    own = _misses(evidence, (0, 1, 2), (1, 1, 1))
    best, cost = None, _cost(own)
    # Only a move that is missed as read can contradict how the axes are read.
    for order in ORDERS if max(own) > MISSED else ():
        for code in range(8):
            signs = (1 - 2 * (code & 1), 1 - (code & 2), 1 - ((code & 4) >> 1))
            # Prefer what changes least: every change must pay for itself.
            change = 0.05 * (3 - sum(signs)) + 0.1 * ORDERS.index(order)
            misses = _misses(evidence, order, signs, cost - change)
            if misses and _contradicts(own, misses):
                best, cost = (order, signs), _cost(misses) + change
    if best:
        return _words(best[0], best[1]), []
    sure = []
    for k in range(3):
        signs = [1, 1, 1]
        signs[k] = -1
        if _cost(_misses(evidence, (0, 1, 2), signs)) > _cost(own) + 0.5:
            sure.append(k)
    return "", sure


def _evidence(placements, moves, lsb_per_dps, bias):
    """[(face before, face after, turned [3] rad), ...] of the moves that can be trusted."""
    evidence = []
    for m in moves:
        if m.before < 0 or m.after < 0 or m.saturated or not m.n > 0 or has_gap(m):
            continue
        f = face_of_code(placements[m.before].pose)
        t = face_of_code(placements[m.after].pose)
        if f >= 0 and t >= 0:
            measured, T = turn(m, lsb_per_dps)
            evidence.append((f, t, [measured[k] - bias[k] * T for k in range(3)]))
    return evidence


def _misses(evidence, order, signs, most=None):
    """Squared distance by which each move misses the gravity after it; [] as soon as they cost
    as much as `most`."""
    misses = []
    cost = 0.0
    for f, t, turned in evidence:
        misses.append(_miss(f, t, [signs[k] * turned[order[k]] for k in range(3)]))
        cost += min(misses[-1], 1.0)
        if most is not None and cost >= most:
            return []
    return misses


def _miss(before, after, turned):
    """Gravity in the body turns by minus the body's turn (Rodrigues)."""
    angle = math.sqrt(sum([x * x for x in turned]))
    u = [0.0, 0.0, 0.0]
    u[AXIS[before]] = float(SIGN[before])
    if angle > 1e-6:
        e = [x / angle for x in turned]
        c, s = math.cos(angle), math.sin(angle)
        d = (1.0 - c) * sum([e[k] * u[k] for k in range(3)])
        u = [c * u[k] - s * (e[(k + 1) % 3] * u[(k + 2) % 3] - e[(k + 2) % 3] * u[(k + 1) % 3])
             + d * e[k] for k in range(3)]
    u[AXIS[after]] -= SIGN[after]
    return sum([x * x for x in u])


def _cost(misses):
    """One odd move must not decide: each counts at most 1."""
    return sum([min(x, 1.0) for x in misses])


def _contradicts(own, other):
    """Some move is missed as read and met by the other reading, and none the other way."""
    for_it = [1 for x, y in zip(own, other) if x > MISSED and y < FITS]
    against = [1 for x, y in zip(own, other) if x < FITS and y > MISSED]
    return for_it and not against


def _words(order, signs):
    parts = []
    inverted = ["xyz"[order[k]] for k in range(3) if signs[k] < 0]
    if inverted:
        parts.append("axis %s is inverted" % " and ".join(inverted))
    moved = ["%s shows %s" % ("xyz"[order[k]], "xyz"[k]) for k in range(3) if order[k] != k]
    if moved:
        parts.append("axes are exchanged: " + ", ".join(moved))
    return "gyro " + "; ".join(parts) + " (gravity before and after the moves)"
