"""The chips of a capture: their registers, and its samples in place of a sensor's.

Only what the drivers of sixflip.chips ask for: identification, registers that keep what is
written, and the bursts of the samples.
"""

import errno
import time

import numpy as np

from sixflip.chips import adxl345, itg3205, mpu6050
from sixflip_sim.clock import VirtualClock

from ..errors import BadFile, UsageError

IDLE = 50               # samples that are played over and over while no session runs
WHAT = "an MPU6050 or relative, a GY-85 or an ADXL345 as the firmware sets them up"


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


def settings_of(capture):
    """rate_hz, pose_samples, sensor, g for sixflip.json; UsageError or BadFile where the
    firmware would never have taken this capture."""
    meta = capture.meta
    sensor = meta.get("sensor")
    fits = {"mpu6050": (mpu6050.ACCEL_RANGES[0][1], mpu6050.GYRO_RANGES[1][1]),
            "gy85": (adxl345.LSB_PER_G, itg3205.LSB_PER_DPS), "adxl345": (adxl345.LSB_PER_G, 0)}
    if not len(capture):
        raise BadFile("the board kept only the sums of this capture: no samples to replay")
    if sensor not in fits:
        raise UsageError("the capture is of sensor %r, expected %s" % (sensor, WHAT))
    accel, gyro = fits[sensor]
    if meta["accel_lsb_per_g"] != accel or gyro and (
            capture.gyro is None or capture.temp is None or meta["gyro_lsb_per_dps"] != gyro):
        raise UsageError("the capture has %s counts per g and %s per deg/s, expected %s and %s "
                         "and a temperature: %s" % (meta["accel_lsb_per_g"],
                                                    meta.get("gyro_lsb_per_dps"), accel, gyro,
                                                    WHAT))
    rate = round(meta["rate_hz"])
    if not 10 <= rate <= 500:
        raise UsageError("the capture has %s samples a second, expected 10 to 500" % rate)
    lengths = {one.n for one in capture.board_placements or ()}
    return {"rate_hz": rate, "sensor": sensor, "g": min(9.9, max(9.7, capture.g)),
            "pose_samples": min(5000, max(50, lengths.pop())) if len(lengths) == 1 else 4 * rate,
            "grace_ms": 0}


def bus_of(capture, replay):
    """The bus with the chips that the capture is of."""
    sensor, accel = capture.meta["sensor"], list(capture.accel.T)
    if sensor == "mpu6050":
        who = capture.meta.get("who_am_i")
        who = who[0] if isinstance(who, list) and who and who[0] in mpu6050.RELATIVES else 0x68
        return ReplayI2C([ReplayChip(
            replay, 0x68, mpu6050.ACCEL_XOUT_H, big([*accel, capture.temp, *capture.gyro.T]),
            {mpu6050.WHO_AM_I: who}, {mpu6050.PWR_MGMT_1: mpu6050.RESET}, True)])
    chips = [ReplayChip(replay, 0x53, adxl345.DATAX0, little(accel),
                        {adxl345.DEVID: adxl345.DEVICE_ID}, {}, True)]
    if sensor == "gy85":
        chips.append(ReplayChip(
            replay, 0x68, itg3205.TEMP_OUT_H, big([capture.temp, *capture.gyro.T]),
            {itg3205.WHO_AM_I: itg3205.ID}, {itg3205.PWR_MGM: itg3205.RESET}, False))
    return ReplayI2C(chips)
