"""sensor_msgs/Imu from a corrected sample: its stamp, its covariances, its bytes.

REP 145: data without an orientation, m/s² and rad/s, on imu/data_raw. The fields are those of
ROS 2 Humble's sensor_msgs/msg/Imu; later releases have not changed them.
"""

import dataclasses
import math
import struct
import time

from sixflip_sim.effects import typical

TOPIC, FRAME = "/imu/data_raw", "imu_link"
UNKNOWN = (0.0,) * 9                # sensor_msgs/Imu: all zeros, the covariance is unknown
ABSENT = (-1.0,) + (0.0,) * 8       # and -1 first: there is no such measurement
JUMP_S, JUMP_SAMPLES = 0.5, 10      # a gap larger than both is a jump of the clock


@dataclasses.dataclass(frozen=True)
class ImuMessage:
    """stamp_ns since 1970; rate rad/s, or None where the chip has no gyro; force m/s²;
    covariances row by row."""

    stamp_ns: int
    frame_id: str
    rate: tuple
    force: tuple
    rate_covariance: tuple
    force_covariance: tuple

    def cdr(self):
        """The message in CDR, little endian, as ROS 2 has it on the wire."""
        name = self.frame_id.encode() + b"\0"
        head = struct.pack("<iI", *divmod(self.stamp_ns, 10 ** 9))
        head += struct.pack("<I", len(name)) + name
        head += b"\0" * (-len(head) % 8)
        return b"\0\1\0\0" + head + struct.pack(
            "<37d", 0.0, 0.0, 0.0, 1.0, *ABSENT, *(self.rate or (0.0,) * 3),
            *self.rate_covariance, *self.force, *self.force_covariance)


def covariances(record):
    """(of the rate, of the force), nine numbers each, from a Record; zeros, unknown, without.

    Noise of a sample, what the record says of its own matrix at one g, and of its offset: the
    errors that one sample has. That those of matrix and offset are the same in the next sample
    a covariance cannot say.
    """
    if record is None:
        return UNKNOWN, UNKNOWN
    return _rate(record), _force(record)


def _force(record):
    if not record.accel:
        return UNKNOWN
    sigma, noise = record.accel["sigma_P"], record.accel["noise_g"] * record.g
    # P[3] is in m/s²; gravity may point along any axis, a third of its square along each.
    return _diagonal([noise ** 2 + record.g ** 2 / 3.0 * sum(sigma[k][j] ** 2 for k in range(3))
                      + sigma[3][j] ** 2 for j in range(3)])


def _rate(record):
    row = typical.chip_of(record.chip, "gyro")
    if not record.gyro:
        return UNKNOWN
    noise = typical.NOISE[row][0]       # deg/s at 100 Hz, data sheets: a record has none
    return _diagonal([math.radians(noise[j]) ** 2 + record.gyro["sigma_P"][3][j] ** 2
                      for j in range(3)])


def _diagonal(variances):
    """Nine numbers; a variance that the record does not know makes all unknown."""
    if not all(math.isfinite(variance) for variance in variances):
        return UNKNOWN
    return (variances[0], 0.0, 0.0, 0.0, variances[1], 0.0, 0.0, 0.0, variances[2])


class DeviceClock:
    """Stamps from the device's clock: this computer's time at the first sample, and from then
    on only what the device counted. say(text) hears of its jumps."""

    def __init__(self, say, now_ns=time.time_ns):
        self.say, self.now_ns = say, now_ns
        self.offset_ns = self.before = self.step = None
        self.jumps = 0

    def stamp(self, t_us):
        """Nanoseconds since 1970 of a device's time."""
        if self.before is None:
            self.offset_ns = self.now_ns() - 1000 * t_us
        else:
            self._look(t_us - self.before)
        self.before = t_us
        return 1000 * t_us + self.offset_ns

    def _look(self, step):
        wide = step > max(1e6 * JUMP_S, JUMP_SAMPLES * (self.step or 0))
        if step <= 0 or wide:
            self.jumps += 1
            self.say("the board's clock jumped by %+.3g s, expected steps of %.3g s" % (
                1e-6 * step, 1e-6 * (self.step or 0)))
        else:
            self.step = step


class ImuMessages:
    """Messages of one stream: record gives the covariances, None leaves them unknown."""

    def __init__(self, record, frame_id, say, now_ns=time.time_ns):
        self.frame_id, self.clock = frame_id, DeviceClock(say, now_ns)
        self.rate_covariance, self.force_covariance = covariances(record)

    def message(self, t_us, values):
        """The ImuMessage of a corrected sample (ax ay az m/s², gx gy gz rad/s or NaN)."""
        force, rate = tuple(values[:3]), tuple(values[3:6])
        there = all(math.isfinite(x) for x in rate)
        return ImuMessage(self.clock.stamp(t_us), self.frame_id, rate if there else None, force,
                          self.rate_covariance if there else ABSENT, self.force_covariance)
