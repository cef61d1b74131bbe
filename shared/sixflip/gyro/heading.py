"""Angles over time from corrected samples: Li Eq. 8 (METHOD 5).

Angle = integral of Gyro(k) + A (Gyro(k-1) - Accel(k-1)) dt, A the drift gain, Accel the rate
seen by the accelerometer. With this sign a positive A multiplies the gyro's bias by 1 + A;
it corrects for -1 < A < 0. Roll and pitch take Accel from gravity's direction. About the
vertical gravity says nothing: yaw is the corrected, bias-removed gyro, unless a lever arm is
configured, whose tangential acceleration then is Accel.
"""

import math

from sixflip import STANDARD_G


class DriftIntegrator:
    """Li Eq. 8 for one angle, rad."""

    def __init__(self, gain=0.0, angle=0.0):
        if not -1.0 < gain <= 0.0:
            raise ValueError("drift gain %s: corrects only between -1 and 0" % gain)
        self.gain = gain
        self.angle = angle
        self._before = 0.0

    def step(self, gyro, dt, accel_rate=None):
        """gyro and accel_rate in rad/s, dt in s; accel_rate None: nothing to correct by.

        Returns the angle, not wrapped.
        """
        self.angle += (gyro + self.gain * self._before) * dt
        self._before = 0.0 if accel_rate is None else gyro - accel_rate
        return self.angle


class Heading:
    """Roll, pitch and yaw of a vehicle from corrected, compensated samples (REP-103 axes).

    gain        drift gain A of Eq. 8
    lever_arm   metres from the turning point forward to the sensor, None: not configured
    """

    def __init__(self, gain=-0.02, lever_arm=None, g=STANDARD_G):
        self.g = g
        self.roll = DriftIntegrator(gain)
        self.pitch = DriftIntegrator(gain)
        self.yaw = DriftIntegrator(gain if lever_arm else 0.0)
        self.lever_arm = lever_arm
        self._started = False
        self._rate = 0.0

    def step(self, a, w, dt):
        """a m/s2, w rad/s, dt s since the sample before; returns (roll, pitch, yaw) rad."""
        roll = math.atan2(a[1], a[2])
        pitch = math.atan2(-a[0], math.sqrt(a[1] * a[1] + a[2] * a[2]))
        if not self._started:
            self.roll.angle, self.pitch.angle = roll, pitch
            self._started = True
            return roll, pitch, self.yaw.angle
        # Euler rates from body rates (z-y-x): the gyro's part of Eq. 8.
        s, c = math.sin(self.roll.angle), math.cos(self.roll.angle)
        level = math.cos(self.pitch.angle)
        if abs(level) < 0.02:
            level = 0.02 if level >= 0 else -0.02
        about_z = (s * w[1] + c * w[2]) / level
        roll_rate = w[0] + about_z * math.sin(self.pitch.angle)
        pitch_rate = c * w[1] - s * w[2]
        # Accel of Eq. 8: the rate that brings the angle to where gravity is; a vehicle that
        # speeds up or brakes does not show gravity.
        size = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
        seen = abs(size / self.g - 1.0) < 0.05 and dt > 0.0
        self.roll.step(roll_rate, dt, _rate(self.roll.angle, roll, dt) if seen else None)
        self.pitch.step(pitch_rate, dt, _rate(self.pitch.angle, pitch, dt) if seen else None)
        self.yaw.step(about_z, dt, self._tangential(a, dt))
        return self.roll.angle, self.pitch.angle, self.yaw.angle

    def _tangential(self, a, dt):
        if not self.lever_arm:
            return None
        self._rate += a[1] / self.lever_arm * dt
        return self._rate


def _rate(angle, seen, dt):
    """Rate that would take the angle held to the one gravity shows, the short way round."""
    return ((seen - angle + math.pi) % (2.0 * math.pi) - math.pi) / dt
