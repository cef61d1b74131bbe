"""The moments of a planned session at which the sensor's answer counts, as arrays.

A rest is cut into blocks (effects that fade within it show between them); each flip between
two poses of one face adds one row for the gyro. Nothing is measured here: attitude, time and
temperature are what the plan says.
"""
from dataclasses import dataclass

import numpy as np

from sixflip.poses import faces
from sixflip_sim.effects.moment import Moment

from . import noise_arrays

FLIP_DPS = 60.0  # a half turn by hand in 3 s


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
