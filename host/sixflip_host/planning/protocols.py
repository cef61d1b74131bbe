"""The sessions that a person can be asked to capture: which pose, how long, how warm, in which
order; and their moments at which the sensor's answer counts, as arrays.

Their numbers are those that GAP's figures are given for: rests of 5 s, moves of 10 s, a change of
temperature of 8-9 degC with a time constant of 300 s. Nothing is measured here: attitude, time and
temperature are what the plan says.
"""
import math
import random
from dataclasses import dataclass

import numpy as np

from sixflip.poses import faces
from sixflip_sim.effects.moment import Moment

from ..experiment import noise_arrays

NAMES = ("paper", "return", "random", "backward", "recommended", "thermal", "soak",
         "turntable", "drive")
STILL = ("paper", "return", "random", "backward", "thermal", "recommended")  # poses, no motion
DWELL_S, MOVE_S = 5.0, 10.0  # METHOD section 1: a pose has 3-5 s; a move, its prompt included
LONG_DWELL_S = 60.0  # creep of 60 s (session_terms.CREEP_S) goes most of its way in it
SHAKE_MG = 300.0  # mg rms of a motor on the table; where an effect shows does not depend on it
OFF_FACES = math.cos(math.radians(22.0))  # the board takes what leans 15 degrees for a face
STATES = {"warming": (22.0, 9.0, 300.0), "warm": (31.0, 2.0, 200.0),
          "cooling": (31.0, -9.0, 400.0)}  # back from where the warm one stood, somewhere cool
FLIP_DPS = 60.0  # a half turn by hand in 3 s


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


@dataclass(frozen=True, eq=False)
class Rows:
    """n rows; the Moment in `at`, and the arrays (n,) that say where each row comes from.

    placement: number over all sessions; session; leaning, rest (False: a turn): bool;
    seconds: how long the row is averaged.
    """

    placement: np.ndarray
    session: np.ndarray
    leaning: np.ndarray
    rest: np.ndarray
    seconds: np.ndarray
    at: Moment

    @property
    def n(self):
        return len(self.placement)

    @property
    def face(self):
        """(n,) face index, -1 of a pose that leans."""
        return self.at.face


def body_to_table(up, yaw_deg):
    """3x3: takes vectors of the box to the table (x, y, up) for an upward axis and a yaw."""
    up = np.asarray(up, float)
    aside = np.zeros(3)
    aside[np.argmin(np.abs(up))] = 1.0
    x = aside - up * (aside @ up)
    x /= np.linalg.norm(x)
    base = np.stack([x, np.cross(up, x), up])
    c, s = np.cos(np.deg2rad(yaw_deg)), np.sin(np.deg2rad(yaw_deg))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ base


def rows_of(protocol, blocks=1, turns=False):
    """Rows of a Protocol: `blocks` to each rest, and one to each flip when turns is True."""
    columns, placement = [], 0
    for number, session in enumerate(protocol.sessions):
        clock, before = session.rest_s, np.asarray(session.rests[0].up, float)
        previous = None
        for rest in session.rests:
            attitude = body_to_table(rest.up, rest.yaw_deg)
            common = {"session": number, "attitude": attitude, "before": before,
                      "leaning": rest.leaning, "plan": session, "placement": placement,
                      "face": -1 if rest.leaning
                      else faces.face_of_code(faces.pose_code(rest.pose))}
            flip = previous is not None and previous[:2] == rest.pose[:2] and not rest.leaning
            if turns and flip and previous != rest.pose:
                sign = 1.0 if rest.turn == "left" else -1.0
                columns.append(dict(common, t=clock - 0.5 * rest.move_s, since=0.0, rest=False,
                                    seconds=180.0 / FLIP_DPS, rate=sign * FLIP_DPS))
            for block in range(blocks):
                since = (block + 0.5) * rest.dwell_s / blocks
                columns.append(dict(common, t=clock + since, since=since, rest=True, rate=0.0,
                                    seconds=rest.dwell_s / blocks))
            clock += rest.dwell_s + rest.move_s
            before, previous, placement = attitude[2], rest.pose, placement + 1
    fields = {"placement": int, "session": int, "leaning": bool, "rest": bool, "seconds": float}
    return Rows(*(np.array([c[name] for c in columns], dtype=kind)
                  for name, kind in fields.items()), _moment(columns))


def _moment(columns):
    """The Moment of all rows, every field an array (n,)."""
    m = noise_arrays.moment()
    m.t = np.array([c["t"] for c in columns])
    change = np.array([c["plan"].change_c for c in columns])
    tau = np.array([c["plan"].tau_s for c in columns])
    fading = change * np.exp(-m.t / tau)
    m.temperature = np.array([c["plan"].start_c for c in columns]) + change - fading
    m.temperature_rate = fading / tau
    attitude = np.array([c["attitude"] for c in columns])
    m.table_x, m.table_y, m.up = (tuple(attitude[:, k].T) for k in range(3))
    m.f = m.up
    m.before = tuple(np.array([c["before"] for c in columns]).T)
    rate = np.array([c["rate"] for c in columns])
    m.w = tuple(rate * m.up[i] for i in range(3))
    still = np.zeros(len(columns))
    m.w_rate = (still, still, still)
    m.since_move = np.array([c["since"] for c in columns])
    m.face = np.array([c["face"] for c in columns])
    m.vibration_mg = np.array([c["plan"].vibration_mg for c in columns])
    m.session = np.array([c["session"] for c in columns])
    return m
