"""The chips of a capture: their registers, and its samples in place of a sensor's.

Only what the drivers of sixflip.chips ask for: identification, registers that keep what is
written, and the bursts of the samples.
"""

import errno
import time

import numpy as np

from sixflip.chips import catalogue
from sixflip_sim import worlds
from sixflip_sim.clock import VirtualClock

from ..errors import BadFile, UsageError

IDLE = 50               # samples that are played over and over while no session runs
WHAT = "a chip of sixflip as the firmware sets it up"


class Replay:
    """The samples of a capture one after the other; its times move the clock.

    speed  seconds of the capture a second, None: as fast as it goes
    """

    def __init__(self, capture, speed=None):
        self.t_us = (capture.t_us - capture.t_us[0]).tolist()
        self.clock = VirtualClock()
        self.speed = speed
        self.at = 0         # the sample that comes next,
        self.index = 0      # and the one last read
        self.running = False
        self.idle_from = 0
        self.base_us = 0
        self.real = 0.0

    def begin(self):
        """The session's first sample comes next."""
        self.at, self.running = 0, True
        self.base_us = self.clock.now_us()
        self.real = time.monotonic()

    @property
    def ended(self):
        return self.running and self.at >= len(self.t_us)

    def stop(self):
        """From now on its last samples over and over."""
        self.running = False
        self.idle_from = max(0, len(self.t_us) - IDLE)

    def next(self):
        """Go on to the next sample; the clock stands at its time."""
        if not self.running or self.ended:
            end = min(len(self.t_us), self.idle_from + IDLE)
            self.index = self.index + 1 if self.idle_from <= self.index < end - 1 \
                else self.idle_from
            return self.wait(self.clock.now_us() - self.base_us)
        self.index = self.at
        self.at += 1
        at_us = self.t_us[self.index]
        self.clock.sleep_us(self.base_us + at_us - self.clock.now_us())
        return self.wait(at_us)

    def wait(self, us):
        """Until so many microseconds of the capture are due in the real world."""
        if self.speed:
            left = self.real + us * 1e-6 / self.speed - time.monotonic()
            if 0 < left < 10:
                time.sleep(left)


class ReplayChip:
    """One address: bursts (n, length) uint8 at data_register; leads: it moves the replay on."""

    def __init__(self, replay, address, data_register, bursts, identity, self_clearing, leads):
        self.replay = replay
        self.address = address
        self.data_register = data_register
        self.bursts = bursts
        self.registers = bytearray(128)
        for register, value in identity.items():
            self.registers[register] = value
        self.self_clearing = self_clearing
        self.leads = leads

    def read_into(self, register, buf):
        if register == self.data_register and len(buf) == self.bursts.shape[1]:
            if self.leads:
                self.replay.next()
            buf[:] = self.bursts[self.replay.index].tobytes()
        else:
            buf[:] = self.registers[register:register + len(buf)]

    def write(self, register, data):
        for k, value in enumerate(data):
            clearing = self.self_clearing.get(register + k, 0)
            self.registers[register + k] = value & ~clearing & 0xFF


class ReplayI2C:
    """machine.I2C's methods over the chips."""

    def __init__(self, chips):
        self.chips = {chip.address: chip for chip in chips}

    def chip(self, address):
        if address not in self.chips:
            raise OSError(errno.ENODEV, "nobody answers")
        return self.chips[address]

    def readfrom_mem_into(self, address, register, buf):
        self.chip(address).read_into(register, buf)

    def readfrom_mem(self, address, register, n):
        buf = bytearray(n)
        self.readfrom_mem_into(address, register, buf)
        return bytes(buf)

    def writeto_mem(self, address, register, data):
        self.chip(address).write(register, data)


def big(columns):
    """(n, 2k) bytes of k columns of int16, high byte first."""
    return np.ascontiguousarray(np.stack(columns, axis=1).astype(">i2")).view(np.uint8)


def little(columns):
    return np.ascontiguousarray(np.stack(columns, axis=1).astype("<i2")).view(np.uint8)


def scale_of(ranges, counts_per_unit, full_scale):
    """The chip's full scale with these counts per unit, the largest of several, or None."""
    for scale, counts, _ in sorted(ranges, reverse=True):
        if counts_per_unit and abs(counts / counts_per_unit - 1) < 1e-6 \
                and full_scale in (None, scale):
            return scale
    return None


def counts_of(ranges):
    return " or ".join("%g" % count for count in sorted({row[1] for row in ranges}))


def settings_of(capture):
    """rate_hz, pose_samples, sensor, g for sixflip.json; UsageError or BadFile where the
    firmware would never have taken this capture."""
    meta = capture.meta
    sensor = meta.get("sensor")
    if not len(capture):
        raise BadFile("the board kept only the sums of this capture: no samples to replay")
    if sensor not in catalogue.SENSORS:
        raise UsageError("the capture is of sensor %r, expected %s" % (sensor, WHAT))
    driver = catalogue.driver(sensor)
    ranges = [scale_of(driver.ACCEL_RANGES, meta["accel_lsb_per_g"], meta.get("accel_range_g")),
              scale_of(driver.GYRO_RANGES, meta.get("gyro_lsb_per_dps"),
                       meta.get("gyro_range_dps"))]
    if ranges[0] is None or driver.has_gyro and (
            capture.gyro is None or capture.temp is None or ranges[1] is None):
        raise UsageError("the capture has %s counts per g and %s per deg/s, expected %s and %s "
                         "and a temperature: %s" % (
                             meta["accel_lsb_per_g"], meta.get("gyro_lsb_per_dps"),
                             counts_of(driver.ACCEL_RANGES), counts_of(driver.GYRO_RANGES), WHAT))
    rate = round(meta["rate_hz"])
    if not 10 <= rate <= 500:
        raise UsageError("the capture has %s samples a second, expected 10 to 500" % rate)
    lengths = {placement.n for placement in capture.board_placements or ()}
    return {"accel_range_g": ranges[0], "gyro_range_dps": ranges[1],
            "rate_hz": rate, "sensor": sensor, "g": min(9.9, max(9.7, capture.g)),
            "pose_samples": min(5000, max(50, lengths.pop())) if len(lengths) == 1 else 4 * rate,
            "grace_ms": 0}


def bus_of(capture, replay):
    """The bus with the chips that the capture is of."""
    columns = [*capture.accel.T] + [np.zeros(len(capture), np.int16)] * 4
    if capture.gyro is not None:
        columns[3:6] = capture.gyro.T
    if capture.temp is not None:
        columns[6] = capture.temp
    who = capture.meta.get("who_am_i")
    chips = []
    for name in worlds.parts_of(capture.meta["sensor"]):
        chip, row = worlds.simulated(name), catalogue.row_of(name)
        answer = who[0] if isinstance(who, list) and who and who[0] in row[4] else min(row[4])
        words = big if chip.high_byte == 0 else little
        chips.append(ReplayChip(
            replay, row[2][0], chip.data_register, words([columns[c] for c in chip.columns]),
            {chip.id_register: answer},
            dict([chip.self_clearing]) if chip.self_clearing else {}, not chips))
    return ReplayI2C(chips)
