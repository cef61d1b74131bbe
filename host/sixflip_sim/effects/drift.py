"""Flicker and random walk as a pure function of time, the same on the board and in numpy.

A recursion would tie every value to all before it. Instead values at the corners of grids of
0.5, 2, 8 ... s (OCTAVES of them) come from the counter-based noise, and each octave is drawn
between its corners with the variance held level; equal octaves make 1/f noise, octaves that
grow with the root of their spacing make a random walk.
"""
from sixflip_sim import noise
from sixflip_sim.effects.effect import AXES, Effect

OCTAVES = 8
SHORTEST_S = 0.5
# Allan deviation of the sum of unit octaves, flat within 8 % from 1 to 1000 s (simulated).
FLOOR_OF_UNIT = 0.96
# Allan floor of the drift whose likeliest level is 1: captures with one of 0.6 mg have 0.65
# (tests/host/gap/test_gap_drifting.py holds it to that). The kernel's own floor is 1.09.
FLOOR_OF_KERNEL = 0.92
TIMES_S = (10.0, 30.0, 100.0, 300.0, 1000.0)  # of the exponentials in the likelihood form


class Drift(Effect):
    """Slow noise of its own on each axis; x y z: its Allan floor (slope 0) or, with slope 0.5,
    its random walk at 1 s."""

    name = "drift"
    units = {"accel": "mg", "gyro": "deg/s"}
    largest = {"accel": 100.0, "gyro": 20.0}
    smallest = 0.0
    shapes = {"slope": (0.0, 0.0, 0.5, ""), "seed": (1, 0, 2 ** 30, "")}
    aliases = ("thermal_bias", "warm_up")

    def add(self, m, out):
        axes = [i for i in range(3) if self.values.get(AXES[i])]
        for i, value in zip(axes, self.unit(m, axes)):
            out[i] = out[i] + self.values[AXES[i]] * value

    def unit(self, m, axes):
        """The drift of the axes at the moment(s) m for unit size, a list."""
        total = [0.0 for _ in axes]
        spacing = SHORTEST_S
        first = (0 if self.sensor == "accel" else 3) + 64 * (m.session + 1)
        for octave in range(OCTAVES):
            place = m.t / spacing
            corner = m.floor(place)
            u = place - corner
            v = 1.0 - u
            level = (v * v + u * u) ** -0.5 * spacing ** self.slope
            for number, axis in enumerate(axes):
                stream = noise.key(int(self.seed), first + axis + 8 * octave)
                left = m.gauss(stream, corner)
                right = m.gauss(stream, corner + 1)
                total[number] = total[number] + (v * left + u * right) * level
            spacing = spacing * 4.0
        return [value / FLOOR_OF_UNIT for value in total]

    def kernel(self, gap, exp):
        """Likelihood form: covariance at a distance of gap seconds for unit level."""
        total = 0.0
        for tau in TIMES_S:
            total = total + exp(-abs(gap) / tau)
        return total
