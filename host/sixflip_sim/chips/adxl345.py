"""Simulated ADXL345, by the driver's own tables."""

import math

from sixflip.chips import adxl345 as chip
from sixflip_sim.chips.register_chip import RegisterChip

# The set-up for which a model's noise figure holds: 200 Hz output, what 100 Hz polling gets.
NOMINAL_RATE_HZ = 200
_WRITABLE = 0x1D            # registers below are read-only or reserved


class SimulatedADXL345(RegisterChip):
    """Standby after power-up; sample k at k / output rate, held until the next."""

    columns = (0, 1, 2)
    id_register = chip.DEVID
    data_register = chip.DATAX0
    data_length = chip.BURST
    high_byte = 1

    def __init__(self, clock, model, address=0x53, who_am_i=chip.DEVICE_ID):
        self.model = model
        self.who_am_i = who_am_i
        self.counts = [0] * 7
        RegisterChip.__init__(self, address, clock, 64)

    def power_on(self):
        RegisterChip.power_on(self)
        self._k = -1
        self.registers[chip.DEVID] = self.who_am_i
        self.registers[chip.BW_RATE] = 0x0A

    def fall_asleep(self):
        self.registers[chip.POWER_CTL] = 0

    def write_register(self, register, value):
        data = chip.DATAX0
        if register < _WRITABLE or register == chip.INT_SOURCE or data <= register < data + 6:
            return
        self.registers[register] = value

    def period_ns(self):
        """3200 Hz for code 15, half as much for every code below."""
        return 312500 << (15 - (self.registers[chip.BW_RATE] & 0x0F))

    def refresh(self, register, n):
        if (self.frozen or not self.registers[chip.POWER_CTL] & chip.MEASURE
                or register + n <= chip.INT_SOURCE or register >= chip.DATAX0 + chip.BURST):
            return
        period = self.period_ns()
        k = self.clock.now_us() * 1000 // period
        if k == self._k:
            return
        self._k = k
        self.measure(k, k * period // 1000)
        self.registers[chip.INT_SOURCE] |= 0x80

    def measure(self, k, t_us):
        """Sample k into the data registers."""
        registers = self.registers
        setting = registers[chip.DATA_FORMAT]
        full_scale = chip.RANGES_G[setting & 3]
        # 256 per g with FULL_RES, otherwise ten bits whatever the range (table 1).
        lsb = chip.LSB_PER_G if setting & 8 else 512 // full_scale
        rail = lsb * full_scale - 1
        counts = self.counts
        louder = math.sqrt(1e9 / self.period_ns() / NOMINAL_RATE_HZ)
        self.model.accel_counts(k, t_us, lsb, rail, louder, counts)
        i = chip.DATAX0
        for axis in range(3):
            offset = registers[chip.OFSX + axis]        # 15.6 mg a count, signed (table 19)
            count = counts[axis] + (((offset ^ 0x80) - 0x80) * lsb // 64 if offset else 0)
            registers[i] = count & 0xFF
            registers[i + 1] = count >> 8 & 0xFF
            i += 2

    def after_read(self, register, n):
        if register < chip.DATAX0 + chip.BURST and register + n > chip.DATAX0:
            self.registers[chip.INT_SOURCE] &= 0x7F


SIMULATED = {"adxl345": SimulatedADXL345}
