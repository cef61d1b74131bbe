"""The true motion of the box: attitude, rate and specific force as pure functions of time.

World frame: z up. Attitude R turns body vectors into world vectors. Specific force at rest
is R^T (0, 0, g): the axis that points up reads +g. Rate and force are in the body frame.
A scene is a list of segments; nothing is integrated, so a numpy simulator that evaluates the
same formulas on the same segments sees the same world.
"""

import math

from sixflip import STANDARD_G
from sixflip_sim import rotation

REST = 0
TREMOR_HZ = 9.0  # of a hand that holds something: 8 to 12 Hz (Stiles and Randall 1967)
TURN = 1        # from one attitude to another about one axis, minimum jerk, with a lift
BUMP = 2        # away and back again


class Segment:
    """t0, t1 in µs; start is the attitude at t0; in between it is start·Rot(axis, angle·s)
    with s of tau = (t - t0)/(t1 - t0); axis is a unit vector in the body; lift in metres."""

    def __init__(self, kind, t0, t1, start, axis, angle, lift):
        self.kind = kind
        self.t0 = t0
        self.t1 = t1
        self.start = start
        self.axis = axis
        self.angle = angle
        self.lift = lift
        self.force = None       # of a rest, kept


def turn_profile(tau):
    """Minimum jerk (Flash and Hogan 1985): s, ds/dtau, d2s/dtau2 from 0 to 1."""
    return (tau * tau * tau * (10.0 - 15.0 * tau + 6.0 * tau * tau),
            30.0 * tau * tau * (1.0 - tau) * (1.0 - tau),
            60.0 * tau * (1.0 - tau) * (1.0 - 2.0 * tau))


def bump_profile(tau):
    """64 tau^3 (1 - tau)^3 and its derivatives: from 0 to 1 and back to 0."""
    p = tau * (1.0 - tau)
    return (64.0 * p * p * p, 192.0 * p * p * (1.0 - 2.0 * tau), 384.0 * p * (1.0 - 5.0 * p))


class Scene:
    """Begins at rest in `attitude`; segments are appended; the last attitude lasts for ever.

    g in m/s²; lever_arm: where the sensor sits from the axis of every turn, body frame, m.
    tremor: amplitude of a lifted box's shaking, vertical, m/s².
    Temperature: temperature_c - warm_c·exp(-t/warm_tau_s), °C.
    """

    def __init__(self, attitude=rotation.IDENTITY, g=STANDARD_G, lever_arm=None,
                 temperature_c=25.0, warm_c=0.0, warm_tau_s=300.0, tremor=0.0):
        self.g = g
        self.tremor = tremor
        self.lever_arm = lever_arm
        self.temperature_c = temperature_c
        self.warm_c = warm_c
        self.warm_tau_s = warm_tau_s
        self.segments = [Segment(REST, 0, 0, attitude, None, 0.0, 0.0)]
        self._at = 0

    def end_us(self):
        return self.segments[-1].t1

    def end_attitude(self):
        return self.segments[-1].start

    def rest(self, us):
        """Lie still for a time longer."""
        self.segments[-1].t1 += us

    def turn(self, us, axis, angle, lift=0.0):
        """Turn by angle (rad) about a body axis; lift: how high the box is raised, m."""
        self._append(TURN, us, axis, angle, lift)

    def bump(self, us, axis, angle, lift=0.0):
        """Tilt by angle and fall back."""
        self._append(BUMP, us, axis, angle, lift)

    def _append(self, kind, us, axis, angle, lift):
        """The movement, and a rest of no length yet: a scene always ends in a rest."""
        start = self.end_attitude()
        t0 = self.end_us()
        self.segments.append(Segment(kind, t0, t0 + us, start, axis, angle, lift))
        if kind == TURN:
            start = rotation.times(start, rotation.about(axis, angle))
        self.segments.append(Segment(REST, t0 + us, t0 + us, start, None, 0.0, 0.0))

    def index_at(self, t_us):
        """Index of the segment that holds t_us (any order of times; near the last is fast)."""
        segments = self.segments
        i = self._at
        while i > 0 and t_us < segments[i].t0:
            i -= 1
        while i + 1 < len(segments) and t_us >= segments[i].t1:
            i += 1
        self._at = i
        return i

    def rest_force(self, i):
        """Specific force (m/s², body) of segment i before it moves: a tuple, kept."""
        segment = self.segments[i]
        if segment.force is None:
            r = segment.start
            segment.force = (r[6] * self.g, r[7] * self.g, r[8] * self.g)
        return segment.force

    def previous_force(self, i):
        """Specific force of the rest before segment i; of the first one if there is none."""
        i -= 1
        while i > 0 and (self.segments[i].kind != REST or
                         self.segments[i].t1 == self.segments[i].t0):
            i -= 1
        return self.rest_force(max(i, 0))

    def attitude(self, t_us):
        """R, nine floats."""
        return self.motion(t_us)[0]

    def specific_force(self, t_us):
        """(fx, fy, fz) in m/s², body frame."""
        return self.motion(t_us)[1]

    def rate(self, t_us):
        """(wx, wy, wz) in rad/s, body frame."""
        return self.motion(t_us)[2]

    def temperature(self, t_us):
        """°C"""
        if self.warm_c == 0.0:
            return self.temperature_c
        return self.temperature_c - self.warm_c * math.exp(-t_us * 1e-6 / self.warm_tau_s)

    def temperature_rate(self, t_us):
        """°C/s"""
        if self.warm_c == 0.0:
            return 0.0
        tau = self.warm_tau_s
        return self.warm_c / tau * math.exp(-t_us * 1e-6 / tau)

    def resting(self, i):
        """Whether the box lies still in segment i."""
        return self.segments[i].kind == REST

    def motion(self, t_us):
        """(attitude, specific force, rate, angular acceleration) at t_us, tuples."""
        i = self.index_at(t_us)
        segment = self.segments[i]
        if segment.kind == REST:
            return segment.start, self.rest_force(i), ZERO, ZERO
        seconds = (segment.t1 - segment.t0) * 1e-6
        tau = (t_us - segment.t0) * 1e-6 / seconds
        s, ds, dds = (turn_profile if segment.kind == TURN else bump_profile)(tau)
        axis = segment.axis
        r = rotation.times(segment.start, rotation.about(axis, segment.angle * s))
        speed = segment.angle * ds / seconds
        gain = segment.angle * dds / (seconds * seconds)
        up = self.g
        if segment.lift:
            up += segment.lift * bump_profile(tau)[2] / (seconds * seconds)
            if self.tremor:
                up += self.tremor * math.sin(2.0 * math.pi * TREMOR_HZ * tau * seconds)
        f = (r[6] * up, r[7] * up, r[8] * up)
        w = (axis[0] * speed, axis[1] * speed, axis[2] * speed)
        alpha = (axis[0] * gain, axis[1] * gain, axis[2] * gain)
        if self.lever_arm is not None:
            f = _with_lever(f, w, alpha, self.lever_arm)
        return r, f, w, alpha


ZERO = (0.0, 0.0, 0.0)


def _with_lever(f, w, alpha, r):
    """f + alpha x r + w x (w x r): what a sensor off the axis of turn feels."""
    a = rotation.cross(alpha, r)
    b = rotation.cross(w, rotation.cross(w, r))
    return (f[0] + a[0] + b[0], f[1] + a[1] + b[1], f[2] + a[2] + b[2])
