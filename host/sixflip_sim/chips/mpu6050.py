"""Simulated MPU6050 or relative, by the driver's own tables."""

import math

from sixflip.chips import mpu6050 as chip
from sixflip_sim.chips.invensense import SLEEP, InvenSense

# The set-up for which a model's noise figure holds: DLPF_CFG 3, what 100 Hz polling gets.
NOMINAL_BANDWIDTH_HZ = 44
_AWAKE_AFTER_RESET = (0x70, 0x71, 0x73)     # their PWR_MGMT_1 is 0x01 after a reset
# What the factory left in the accelerometer's offsets, words of x y z: any part has its own.
TRIM = (0xFC5A, 0x02B0, 0x0534)
# Counts a g of such a word, bit 0 of which is not part of it: the MPU6050's are of ±8 g
# (application note "MPU Hardware Offset Registers" rev. 1.0), those of its relatives have steps of
# 0.98 mg from bit 1 on (MPU-6500 register map rev. 2.1, registers 119 to 126).
_WORDS_PER_G = (4096, 2048)
# °/s of a count of XG_OFFS_USR, in any range (MPU-6500 register map rev. 2.1, registers 19 to 24).
_DPS_PER_COUNT = 4 / 131


def _signed(high, low):
    return ((high << 8 | low) ^ 0x8000) - 0x8000


class SimulatedMPU6050(InvenSense):
    TRAPS = ((chip.CONFIG, 0), (chip.ACCEL_CONFIG, 0x18), (chip.PWR_MGMT_1, SLEEP))
    columns = (0, 1, 2, 6, 3, 4, 5)
    self_clearing = (chip.PWR_MGMT_1, chip.RESET)
    id_register = chip.WHO_AM_I
    power_register = chip.PWR_MGMT_1
    divider_register = chip.SMPLRT_DIV
    filter_register = chip.CONFIG
    status_register = chip.INT_STATUS
    data_register = chip.ACCEL_XOUT_H
    data_length = chip.BURST

    def __init__(self, clock, model, address=0x68, who_am_i=0x68):
        self.who_am_i = who_am_i
        self.temperature = (chip.TEMPERATURE if who_am_i == 0x68
                            else chip.TEMPERATURE_RELATIVES)
        self.accel_offsets = [chip.XA_OFFS_H + 2 * axis if who_am_i == 0x68
                              else chip.XA_OFFSET_H + 3 * axis for axis in range(3)]
        self._shift = None      # g of x y z, °/s of x y z, where an offset is not the factory's
        InvenSense.__init__(self, address, clock, model)

    def power_on(self):
        InvenSense.power_on(self)
        self.registers[chip.WHO_AM_I] = self.who_am_i
        awake = self.who_am_i in _AWAKE_AFTER_RESET
        self.registers[chip.PWR_MGMT_1] = chip.CLOCK_GYRO_X if awake else SLEEP
        for register, word in zip(self.accel_offsets, TRIM):
            self.registers[register] = word >> 8
            self.registers[register + 1] = word & 0xFF
        self._shift = None

    def write_register(self, register, value):
        InvenSense.write_register(self, register, value)
        if register < chip.SMPLRT_DIV or register > chip.WHO_AM_I:
            self._shift = self._shifts()

    def _shifts(self):
        """What the offset registers add, or None: nothing."""
        registers = self.registers
        per_g = _WORDS_PER_G[self.who_am_i != 0x68]
        shift = []
        for register, word in zip(self.accel_offsets, TRIM):
            now = _signed(registers[register], registers[register + 1] & 0xFE)
            shift.append((now - _signed(word >> 8, word & 0xFE)) / per_g)
        for register in range(chip.XG_OFFS_USR_H, chip.XG_OFFS_USR_H + 6, 2):
            shift.append(_signed(registers[register], registers[register + 1]) * _DPS_PER_COUNT)
        return shift if any(shift) else None

    def _louder(self, register):
        """White noise grows with the square root of the filter's bandwidth."""
        code = self.registers[register] & 7
        bandwidth = chip.BANDWIDTH_HZ[code] if code < 7 else chip.BANDWIDTH_HZ[0]
        return math.sqrt(bandwidth / NOMINAL_BANDWIDTH_HZ)

    def sample(self, k, t_us):
        registers = self.registers
        accel = chip.ACCEL_RANGES[registers[chip.ACCEL_CONFIG] >> 3 & 3]
        gyro = chip.GYRO_RANGES[registers[chip.GYRO_CONFIG] >> 3 & 3]
        loud = self._louder(chip.CONFIG)
        accel_loud = loud if self.who_am_i == 0x68 else self._louder(chip.ACCEL_CONFIG_2)
        counts = self.counts
        self.model.accel_counts(k, t_us, accel[1], chip.RAIL, accel_loud, counts)
        self.model.gyro_counts(k, t_us, gyro[1], chip.RAIL, loud, counts)
        if self._shift:
            for i in range(6):
                lsb = accel[1] if i < 3 else gyro[1]
                count = counts[i] + int(round(self._shift[i] * lsb))
                counts[i] = max(-chip.RAIL - 1, min(chip.RAIL, count))
        self.model.temp_counts(k, t_us, self.temperature[0], self.temperature[1], counts)
        self.store(self.columns)


SIMULATED = {"mpu6050": SimulatedMPU6050}
