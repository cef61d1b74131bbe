"""A person who places, flips and moves a box, as raw counts: small, seeded, plain integers.

Not the simulator of the product: only what the session's tests need, on both interpreters.
"""

import math
from array import array

from sixflip.poses.faces import AXIS, SIGN


class Noise:
    """Roughly Gaussian integers of a 31-bit linear congruential generator."""

    def __init__(self, seed):
        self.x = seed

    def uniform(self, most):
        self.x = (self.x * 1103515245 + 12345) & 0x3FFFFFFF
        return (self.x >> 8) % (2 * most + 1) - most

    def draw(self, sd):
        """Integer of standard deviation about sd: four uniforms of sd * sqrt(3) / 2 each."""
        if sd <= 0:
            return 0
        most = int(sd * 866)
        u = self.uniform(most) + self.uniform(most) + self.uniform(most) + self.uniform(most)
        return (u + 500) // 1000


class Operator:
    """Feeds `sink(dt_us, sample)`; collects the non-zero, non-window answers in `events`.

    up       where gravity's reaction points in the box, unit vector; rate in deg/s, body axes
    """

    def __init__(self, sink, seed=1, lsb=16384, dps=65.5, period_us=10000, accel_sd=30.0,
                 gyro_sd=4.0, step=1, bias=(100, -50, 300), tilt_deg=1.5):
        self.sink = sink
        self.noise = Noise(seed)
        self.lsb = lsb
        self.dps = dps
        self.period_us = period_us
        self.accel_sd = accel_sd
        self.gyro_sd = gyro_sd
        self.step = step
        self.bias = bias
        self.tilt = math.radians(tilt_deg)
        self.sample = array("h", [0] * 7)
        self.sample[6] = -3700
        self.events = []
        self.up = [0.0, 0.0, 1.0]
        self.shake = 0
        self.spin = (0.0, 0.0, 0.0)
        self.accel_stuck = False
        self.before = None  # called with the sample before it is fed, may change it
        self.fed = 0

    def lean(self, face, deg, heading=0):
        """Point up along a face's axis, deg away from it towards the next axis."""
        i = AXIS[face]
        c, s = math.cos(math.radians(deg)), math.sin(math.radians(deg))
        h = math.radians(heading)
        self.up[i] = SIGN[face] * c
        self.up[(i + 1) % 3] = s * math.cos(h)
        self.up[(i + 2) % 3] = s * math.sin(h)

    def samples(self, n):
        for _ in range(n):
            out = self.sample
            for i in range(3):
                a = self.up[i] * self.lsb + self.noise.draw(self.accel_sd)
                if self.shake:
                    a += self.noise.uniform(self.shake)
                a = max(-32768, min(32767, int(a)))
                w = self.bias[i] + self.spin[i] * self.dps + self.noise.draw(self.gyro_sd)
                w = max(-32768, min(32767, int(w)))
                if not self.accel_stuck:
                    out[i] = a // self.step * self.step
                out[3 + i] = w if self.dps else 0
            if self.before:
                self.before(out)
            self.fed += 1
            event = self.sink(self.period_us, out)
            if event > 1:
                self.events.append(event)

    def rest(self, seconds):
        self.spin = (0.0, 0.0, 0.0)
        self.shake = 0
        self.samples(int(seconds * 1000000) // self.period_us)

    def turn(self, axis, deg, seconds=2):
        """Turn about an axis of the box, shaking as hands do, and stop."""
        spin = [0.0, 0.0, 0.0]
        spin[axis] = deg / seconds
        self.spin = spin
        self.shake = 1500 * self.lsb // 16384
        self.samples(int(seconds * 1000000) // self.period_us)

    def place(self, face, heading=0):
        """Carry the box to another face (any turn about an axis of the table)."""
        self.turn((AXIS[face] + 1) % 3, 90)
        self.lean(face, math.degrees(self.tilt), heading)

    def flip(self, face, deg=180):
        self.turn(AXIS[face], deg)
        self.lean(face, math.degrees(self.tilt), deg)

    def six_faces(self, dwell=6, order=(0, 1, 2, 3, 4, 5)):
        for face in order:
            self.place(face)
            self.rest(dwell)
            self.flip(face)
            self.rest(dwell)
