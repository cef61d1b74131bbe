"""Simulated MPU6050 or relative, by the driver's own tables."""

import math

from sixflip.chips import mpu6050 as chip
from sixflip_sim.chips.invensense import SLEEP, InvenSense

# The set-up for which a model's noise figure holds: DLPF_CFG 3, what 100 Hz polling gets.
NOMINAL_BANDWIDTH_HZ = 44
_AWAKE_AFTER_RESET = (0x70, 0x71, 0x73)     # their PWR_MGMT_1 is 0x01 after a reset
_COLUMNS = (0, 1, 2, 6, 3, 4, 5)


class SimulatedMPU6050(InvenSense):
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
        InvenSense.__init__(self, address, clock, model)

    def power_on(self):
        InvenSense.power_on(self)
        self.registers[chip.WHO_AM_I] = self.who_am_i
        awake = self.who_am_i in _AWAKE_AFTER_RESET
        self.registers[chip.PWR_MGMT_1] = chip.CLOCK_GYRO_X if awake else SLEEP

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
        self.model.temp_counts(k, t_us, self.temperature[0], self.temperature[1], counts)
        self.store(_COLUMNS)
