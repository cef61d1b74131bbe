"""Which pose each rest of a recording is that nobody labelled: its face, a or b, or leaning."""
from dataclasses import dataclass, replace

import numpy as np

from sixflip.poses.faces import AXIS, FACES, LEANING, SIGN, pose_name
from sixflip.poses.noise_floor import NoiseFloor
from sixflip.poses.pose_label import CROOKED_DEG, HALF_TURN_DEG, SAME_DEG

from . import rests, shaken_rests
from .attitude import heading_change

POSES, FOUND = "poses", "found"  # key and value of a capture's header: no person named its poses
NO_GRAVITY = 0.05   # g: no part reads so little of it at rest: it has been taken out
# Degrees, without a gyro, between gravity in two rests on a face: as likely of a box that was put
# back where it was, to 0.1 degrees, as of one that was turned by half on a table which leans by a
# degree or so (the odds of two such normal distances in a plane are even there).
PUT_BACK_DEG = 0.46
HALF_TURN_S = 0.5   # of a box by hand, at least: what is shorter was a touch
HELD_BY_HAND = "held_by_hand"   # key of a capture's header: names of poses that were not at rest


@dataclass(frozen=True)
class FoundPoses:
    """pose: int16 (n,) codes; rests: tuple of rests.Rest; noise: NoiseFloor of the quietest
    second, or None where there is no rest."""

    pose: np.ndarray
    rests: tuple
    noise: NoiseFloor | None

    def label(self, capture):
        """Write the poses into the capture, and into its header that they were found and which
        were held by hand."""
        capture.pose = self.pose
        capture.meta[POSES] = FOUND
        by_hand = [pose_name(rest.code) for rest in self.rests if rest.by_hand]
        if by_hand:
            capture.meta[HELD_BY_HAND] = by_hand

    def remarks(self):
        """Lines for a person: what was found and what each rest was taken for."""
        if self.noise is None:
            return ["no rest found: nowhere a second without motion"]
        lines = ["%d rests found; noise %.2f mg" % (
            len(self.rests), np.mean(self.noise.sd[:3]) / self.noise.lsb[0])]
        for rest in self.rests:
            lines.append("%-4s samples %d to %d, %.1f deg off %s%s" % (
                pose_name(rest.code), rest.first, rest.end - 1, rest.off_deg, FACES[rest.face],
                "".join("; " + why for why in (rest.why, rest.by_hand and "held by hand") if why)))
        return lines


def by_a_person(capture):
    """Whether the poses of a Capture were named by who made it: of those that were found, the
    first of a face is called a whichever way the box lay."""
    return (capture.pose is not None and bool((capture.pose > 0).any())
            and capture.meta.get(POSES) != FOUND)


def find_poses(capture):
    """Label every sample of a Capture; returns FoundPoses. Nothing is changed in the capture."""
    still = shaken_rests.or_rippled(capture, rests.find(capture, rests.POSES))
    if all(np.linalg.norm(rest.mean) < NO_GRAVITY * capture.meta["accel_lsb_per_g"]
           for rest in still.rests):
        still = replace(still, rests=())
    named = _named(capture, still.rests, still.noise)
    pose = np.zeros(len(capture), np.int16)
    for rest in named:
        pose[rest.first:rest.end] = rest.code
    return FoundPoses(pose, tuple(named), still.noise)


def _named(capture, still_rests, noise):
    """Every rest with its pose: face from gravity, a or b from the gyro, leaning otherwise."""
    leaning, named = 0, []
    # Who sets it on all six faces calibrates it, and turns it on each as he is asked to.
    asked = len({rest.face for rest in still_rests if rest.off_deg <= CROOKED_DEG}) == len(FACES)
    for rest in still_rests:
        code, why = 0, "leaning"
        if rest.off_deg <= CROOKED_DEG:
            code, why = _letter(capture, named, rest, noise, asked)
        if not code:
            leaning += 1
            code = LEANING + leaning
        named.append(replace(rest, code=code, why=why))
    return named


def _letter(capture, before, rest, noise, asked):
    """a or b of a rest on a face, and why; code 0 when the gyro cannot say. asked: without a gyro
    half a turn is likely, though it lies as it did before."""
    a = 1 + 2 * rest.face
    seen = [one for one in before if one.code in (a, a + 1)]
    if not seen:
        return a, ""
    last = seen[-1]
    if capture.gyro is None:
        nearest = min(seen, key=lambda one: _apart_deg(one, rest))
        if not asked and _apart_deg(nearest, rest) < PUT_BACK_DEG:
            return nearest.code, "it lies as %s did, no gyro to tell" % pose_name(nearest.code)
        if before[-1] is last and rest.first - last.end <= HALF_TURN_S * capture.meta["rate_hz"]:
            return last.code, ""
        if before[-1] is last or len({one.code for one in seen}) == 1:
            return 2 * a + 1 - last.code, "moved since %s, no gyro to tell" % pose_name(last.code)
        return 0, "on its face again, no gyro to tell a from b"
    turned = heading_change(capture, before[before.index(last):] + [rest], noise.bias,
                            AXIS[rest.face], SIGN[rest.face])
    if turned is None:
        return 0, "on its face again, but the gyro was saturated or samples are missing"
    why = "turned by %.0f deg since %s" % (turned, pose_name(last.code))
    if abs(turned) <= SAME_DEG:
        return last.code, why
    if abs(turned) >= HALF_TURN_DEG:
        return 2 * a + 1 - last.code, why
    return 0, why + ", neither a half turn nor none"


def _apart_deg(one, other):
    """Degrees between gravity in two Rests."""
    a, b = (np.array(rest.mean) / np.linalg.norm(rest.mean) for rest in (one, other))
    return float(np.degrees(2.0 * np.arcsin(0.5 * np.linalg.norm(a - b))))
