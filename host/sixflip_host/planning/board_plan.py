"""A plan for the board: which protocol or file, as the request the firmware reads, in words."""

import math

from sixflip.poses import faces

from ..did_you_mean import instead
from ..errors import UsageError
from . import plan_file, protocols

SETTLING_S = 1.0        # of a dwell: until the board has seen that the box is at rest
SHORTEST, LONGEST = 50, 60000   # samples of a pose, as session_request.py on the board says
MOST_POSES, MOST_TEXT = 200, 4096  # poses, and characters of a request, as it says too


def session_of(name, number):
    """The protocols.SessionPlan meant by --plan NAME or FILE and --session NUMBER (from 1)."""
    try:
        protocol = protocols.named(name)
    except ValueError:
        if name in protocols.NAMES:
            raise UsageError("--plan %s is a motion, no placements: expected paper, recommended "
                             "or a plan file" % name) from None
        if not any(c in name for c in "./\\"):
            raise UsageError("no plan named %r, %s, or a plan file" % (
                name, instead(name, protocols.STILL))) from None
        protocol = plan_file.read(name)
    if not 1 <= number <= len(protocol.sessions):
        raise UsageError("--session %d: the plan %s has %d" % (
            number, protocol.name, len(protocol.sessions)))
    return protocol.sessions[number - 1]


def request(session, rate_hz):
    """What goes into calibrate.flag; UsageError where a board cannot hold it."""
    samples = [max(SHORTEST, round((rest.dwell_s - SETTLING_S) * rate_hz))
               for rest in session.rests]
    if len(samples) > MOST_POSES:
        raise UsageError("the plan has %d placements, %d is the most a board takes"
                         % (len(samples), MOST_POSES))
    if max(samples) > LONGEST:
        raise UsageError("the plan rests for %.0f s in one pose, %.0f s is the most a board takes"
                         % (max(r.dwell_s for r in session.rests), LONGEST / rate_hz))
    return {"poses": " ".join(rest.pose for rest in session.rests),
            "samples": samples[0] if len(set(samples)) == 1 else samples,
            "rest_s": round(session.rest_s)}


def leaning(up):
    """"Z+ up, leaning 38 degrees over so that X- rises" of an upward axis in the box."""
    face, off = faces.nearest_face(*up)
    others = sorted(((abs(up[axis]), "XYZ"[axis] + ("+" if up[axis] > 0 else "-"))
                     for axis in range(3) if axis != faces.AXIS[face]), reverse=True)
    rising = others[0][1]
    if others[1][0] > 0.5 * others[0][0]:
        rising += " and " + others[1][1]
    return "%s up, but leaned over by about %.0f degrees so that %s rises" % (
        faces.FACES[face], 5 * math.floor(off / 5 + 0.5), rising)


def step(session, at):
    """What to do for placement number at (from 0) of a session, in words."""
    if at >= len(session.rests):
        if not session.rest_s:
            return "all placements done"
        return "all placements done; leave the box alone for %.0f s" % session.rest_s
    rest = session.rests[at]
    if rest.leaning:
        return "%s: lean the box on something, still: %s" % (rest.pose, leaning(rest.up))
    face = rest.pose[:2]
    before = [r.pose for r in session.rests[:at]]
    if not before:
        return "%s: lay the box down with %s up" % (rest.pose, face)
    if before[-1] == rest.pose:
        return "%s: lift the box and put it back just as it lay" % rest.pose
    if before[-1][:2] == face:
        return "%s: half a turn to the %s (%s from above), %s stays up" % (
            rest.pose, rest.turn,
            "anticlockwise" if rest.turn == "left" else "clockwise", face)
    if rest.pose in before:
        return "%s: %s up, turned as it lay for %s before" % (rest.pose, face, rest.pose)
    other = face + ("b" if rest.pose[2:] == "a" else "a")
    if other in before:
        return "%s: %s up, turned half round against %s" % (rest.pose, face, other)
    return "%s: lay the box down with %s up" % (rest.pose, face)
