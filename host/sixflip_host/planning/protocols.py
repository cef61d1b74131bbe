"""The sessions that a person can be asked to capture: which pose, how long, how warm, in which
order.

Their numbers are those that GAP's figures are given for: rests of 5 s, moves of 10 s, a change of
temperature of 8-9 degC with a time constant of 300 s.
"""
import math
import random
from dataclasses import dataclass

from sixflip.poses import faces

NAMES = ("paper", "return", "random", "backward", "recommended", "thermal", "soak",
         "turntable", "drive")
STILL = ("paper", "return", "random", "backward", "thermal", "recommended")  # poses, no motion
DWELL_S, MOVE_S = 5.0, 10.0  # METHOD section 1: a pose has 3-5 s; a move, its prompt included
LONG_DWELL_S = 60.0  # creep of 60 s (session_terms.CREEP_S) goes most of its way in it
SHAKE_MG = 300.0  # mg rms of a motor on the table; where an effect shows does not depend on it
OFF_FACES = math.cos(math.radians(22.0))  # the board takes what leans 15 degrees for a face
STATES = {"warming": (22.0, 9.0, 300.0), "warm": (31.0, 2.0, 200.0),
          "cooling": (31.0, -9.0, 400.0)}  # back from where the warm one stood, somewhere cool


@dataclass(eq=False)
class Rest:
    """One still pose. up (3,): unit vector against gravity in the box; yaw_deg on the table; turn:
    the way the box is turned (left: anticlockwise from above) when it comes from its flip."""

    pose: str
    up: tuple
    yaw_deg: float = 0.0
    dwell_s: float = DWELL_S
    move_s: float = MOVE_S
    turn: str = "left"

    @property
    def leaning(self):
        return self.pose.startswith("L")


@dataclass(eq=False)
class SessionPlan:
    """A list of Rest in one thermal state: T(t) = start_c + change_c (1 - exp(-t / tau_s));
    rest_s of stillness before the first pose and after the last; vibration_mg: rms of a
    vibration that is switched on for this session."""

    rests: list
    state: str = "warming"
    start_c: float = 25.0
    change_c: float = 8.0
    tau_s: float = 300.0
    rest_s: float = 0.0
    vibration_mg: float = 0.0

    @property
    def minutes(self):
        return (sum(r.dwell_s + r.move_s for r in self.rests) + 2 * self.rest_s) / 60.0


@dataclass(frozen=True, eq=False)
class Protocol:
    """Named sessions (list of SessionPlan), to be captured in this order."""

    name: str
    sessions: list

    @property
    def minutes(self):
        return sum(session.minutes for session in self.sessions)


def face_rest(code, turn="left", **timing):
    """The Rest of pose code 1..12; b is a turned by 180 degrees."""
    face = (code - 1) // 2
    up = [0.0, 0.0, 0.0]
    up[faces.AXIS[face]] = float(faces.SIGN[face])
    return Rest(faces.pose_name(code), tuple(up), 180.0 * faces.is_b(code), turn=turn,
                **timing)


def leaning_rests(count, seed, **timing):
    """Free attitudes, evenly scattered over the sphere by a seeded draw, away from the faces."""
    draw = random.Random(1000 + seed)
    rests = []
    while len(rests) < count:
        v = [draw.gauss(0.0, 1.0) for _ in range(3)]
        length = math.sqrt(sum(c * c for c in v))
        if max(abs(c) for c in v) < OFF_FACES * length:
            rests.append(Rest("L%d" % (len(rests) + 1), tuple(c / length for c in v), **timing))
    return rests


def order_of(name, seed=7):
    """Pose codes of one pass: "fixed"; "random"; or "pairs", the faces in random order, each
    with its flip. Pairs give the gyro its half turns, but a single pass of them lets a box
    that is not square reproduce most of a drift (alias index 0.86 on average, 0.25 for "random"):
    go backward after it."""
    codes = list(range(1, 13))
    draw = random.Random(seed)
    if name == "random":
        draw.shuffle(codes)
    elif name == "pairs":
        pairs = [codes[k:k + 2] for k in range(0, 12, 2)]
        draw.shuffle(pairs)
        codes = [code for pair in pairs for code in (pair if draw.random() < 0.5
                                                     else reversed(pair))]
    return codes


def faces_session(codes, leaning=0, backward=False, both_ways=True, state=None, seed=7,
                  dwell_s=DWELL_S, rest_s=0.0):
    """One session: the codes, then leaning poses, then the codes backward."""
    rests = [face_rest(c, dwell_s=dwell_s) for c in codes]
    rests += leaning_rests(leaning, seed, dwell_s=dwell_s)
    if backward:
        rests += [face_rest(c, dwell_s=dwell_s) for c in reversed(codes)]
    for k, rest in enumerate(rests):
        rest.turn = "right" if both_ways and k // 2 % 2 else "left"
    if state is None:
        return SessionPlan(rests, rest_s=rest_s)
    start, change, tau = STATES[state]
    return SessionPlan(rests, state, start, change, tau, rest_s)


def named(name, seed=7):
    """The Protocol of this name; ValueError names what there is."""
    if name == "paper":
        return Protocol(name, [faces_session(order_of("fixed"), both_ways=False)])
    if name == "return":
        codes = order_of("fixed")
        return Protocol(name, [faces_session(codes + codes[:1], both_ways=False)])
    if name == "random":
        return Protocol(name, [faces_session(order_of("random", seed))])
    if name == "backward":
        return Protocol(name, [faces_session(order_of("fixed"), backward=True)])
    if name == "thermal":
        return Protocol(name, [faces_session(order_of("fixed"), backward=True, state=state)
                               for state in ("warming", "cooling")])
    if name == "recommended":
        return Protocol(name, [
            faces_session(order_of("pairs", seed + k), 15, True, True, state, seed + k,
                          rest_s=30.0)
            for k, state in enumerate(("warming", "cooling"))])
    if name == "soak":
        return Protocol(name, [SessionPlan([Rest("Z+a", (0.0, 0.0, 1.0), 0.0, 1800.0, 0.0)],
                                           "warming", *STATES["warming"])])
    raise ValueError("no protocol named %r, expected one of %s" % (name, " ".join(NAMES)))
