"""Simulated ITG3205, by the driver's own tables."""

import math

from sixflip import RAIL
from sixflip.chips import itg3205 as chip
from sixflip_sim.chips.fifo import words
from sixflip_sim.chips.register_chip import RegisterChip

NOMINAL_BANDWIDTH_HZ = 42       # DLPF_CFG 3, what 100 Hz polling gets
_RESET_US = 5000                # the reset bit stays up that long


class SimulatedITG3205(RegisterChip):
    """Sample k is taken at k times the sample period of the world's clock and held until the
    next; a sleeping chip keeps its last reading, all zeros after a reset."""

    columns = (6, 3, 4, 5)
    self_clearing = (chip.PWR_MGM, chip.RESET)
    id_register = chip.WHO_AM_I
    data_register = chip.TEMP_OUT_H
    data_length = chip.BURST
    clock_off = 0.0             # %, of the oscillator: a sample takes so much less time

    def __init__(self, clock, model, address=0x68, who_am_i=chip.ID):
        self.model = model
        self.who_am_i = who_am_i
        self.counts = [0] * 7
        self._reset_until_us = -1
        RegisterChip.__init__(self, address, clock)

    def power_on(self):
        RegisterChip.power_on(self)
        self._k = -1
        self.registers[chip.WHO_AM_I] = self.who_am_i

    def fall_asleep(self):
        self.registers[chip.PWR_MGM] |= chip.SLEEP

    def period_ns(self):
        """Sample period: 1 kHz behind a filter, 8 kHz without, divided."""
        base = 125000 if self.registers[chip.DLPF_FS] & 7 in (0, 7) else 1000000
        return round(base * (1 + self.registers[chip.SMPLRT_DIV]) / (1 + 0.01 * self.clock_off))

    def _resetting(self):
        return self.clock.now_us() < self._reset_until_us

    def write_register(self, register, value):
        if self._resetting():
            return
        data = chip.TEMP_OUT_H
        if register == chip.PWR_MGM and value & chip.RESET:
            self.power_on()
            self._reset_until_us = self.clock.now_us() + _RESET_US
        elif register not in (chip.WHO_AM_I, chip.INT_STATUS) and not \
                data <= register < data + chip.BURST:
            self.registers[register] = value

    def read_into(self, buf):
        start = self.pointer
        RegisterChip.read_into(self, buf)
        if start <= chip.PWR_MGM < start + len(buf) and self._resetting():
            buf[chip.PWR_MGM - start] |= chip.RESET

    def refresh(self, register, n):
        if (self.frozen or self.registers[chip.PWR_MGM] & chip.SLEEP or self._resetting()
                or register + n <= chip.INT_STATUS
                or register >= chip.TEMP_OUT_H + chip.BURST):
            return
        period = self.period_ns()
        k = self.clock.now_us() * 1000 // period
        if k == self._k:
            return
        self._k = k
        self.measure(k, k * period // 1000)
        self.registers[chip.INT_STATUS] |= 1

    def after_read(self, register, n):
        if register <= chip.INT_STATUS < register + n:
            self.registers[chip.INT_STATUS] &= 0xFE

    def measure(self, k, t_us):
        """Sample k into the data registers."""
        setting = self.registers[chip.DLPF_FS]
        # FS_SEL 0..2 are reserved; read as ±250, 500, 1000 °/s, which a driver that
        # forgets to set it would see at once.
        lsb = chip.LSB_PER_DPS * (8 >> (setting >> 3 & 3))
        code = setting & 7
        bandwidth = chip.BANDWIDTH_HZ[code] if code < 7 else chip.BANDWIDTH_HZ[0]
        louder = math.sqrt(bandwidth / NOMINAL_BANDWIDTH_HZ)
        counts = self.counts
        self.model.gyro_counts(k, t_us, lsb, RAIL, louder, counts)
        self.model.temp_counts(k, t_us, chip.TEMPERATURE[0], chip.TEMPERATURE[1], counts)
        data = words(counts, self.columns, 0)
        self.registers[chip.TEMP_OUT_H:chip.TEMP_OUT_H + len(data)] = data


SIMULATED = {"itg3205": SimulatedITG3205}
