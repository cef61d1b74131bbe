"""Simulated MPU6050 or relative, by the driver's own tables."""

from sixflip import RAIL
from sixflip.chips import mpu6050 as chip
from sixflip_sim.chips.six_axis import SimulatedSixAxis, range_of

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


class SimulatedMPU6050(SimulatedSixAxis):
    """Asleep after a reset. Full, its FIFO loses single bytes: frames are out of step then."""

    driver = chip.MPU6050
    TRAPS = ((chip.CONFIG, 0), (chip.ACCEL_CONFIG, 0x18), (chip.PWR_MGMT_1, chip.SLEEP))
    columns, high_byte = driver.COLUMNS, driver.HIGH
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    self_clearing = (chip.PWR_MGMT_1, chip.RESET)
    # what the model's noise figure holds for: DLPF_CFG 3, what 100 Hz polling gets
    nominal_hz = (44, 44)
    RESET_US = 5000
    cleared_by_data = False
    FIFO_BYTES, FIFO_FRAME = 1024, 14
    no_i2c = (chip.USER_CTRL, chip.I2C_IF_DIS)

    def __init__(self, clock, model, address=0x68, who_am_i=0x68):
        self.accel_offsets = [chip.XA_OFFS_H + 2 * axis if who_am_i == 0x68
                              else chip.XA_OFFSET_H + 3 * axis for axis in range(3)]
        self._shift = None      # g of x y z, °/s of x y z, where an offset is not the factory's
        SimulatedSixAxis.__init__(self, clock, model, address, who_am_i)
        if who_am_i != 0x68:
            self.temperature = chip.TEMPERATURE_RELATIVES
            self.memory.size = 512

    def power_on(self):
        SimulatedSixAxis.power_on(self)
        awake = self.who_am_i in _AWAKE_AFTER_RESET
        self.registers[chip.PWR_MGMT_1] = chip.CLOCK_GYRO_X if awake else chip.SLEEP
        for register, word in zip(self.accel_offsets, TRIM):
            self.registers[register] = word >> 8
            self.registers[register + 1] = word & 0xFF
        self._shift = None

    def fall_asleep(self):
        self.registers[chip.PWR_MGMT_1] |= chip.SLEEP

    def read_only(self, register):
        return register in (chip.INT_STATUS, chip.FIFO_COUNT_H, chip.FIFO_COUNT_H + 1) or \
            SimulatedSixAxis.read_only(self, register)

    def write_register(self, register, value):
        if self.resetting():
            return
        if register == chip.PWR_MGMT_1 and value & chip.RESET:
            self.reset()
            return
        if register == chip.USER_CTRL:
            if value & chip.FIFO_RESET:
                self.memory.clear()
            value &= ~chip.FIFO_RESET & 0xFF
        SimulatedSixAxis.write_register(self, register, value)
        if register < chip.SMPLRT_DIV or register > chip.WHO_AM_I:
            self._shift = self._shifts()

    def read_into(self, buf):
        start = self.pointer
        SimulatedSixAxis.read_into(self, buf)
        if start <= chip.PWR_MGMT_1 < start + len(buf) and self.resetting():
            buf[chip.PWR_MGMT_1 - start] |= chip.RESET

    def refresh(self, register, n):
        SimulatedSixAxis.refresh(self, register, n)
        self.memory.fill()
        if self.memory.lost:
            self.registers[chip.INT_STATUS] |= chip.OVERFLOW
        level = len(self.memory.bytes)
        self.registers[chip.FIFO_COUNT_H] = level >> 8
        self.registers[chip.FIFO_COUNT_H + 1] = level & 0xFF

    def after_read(self, register, n):
        if register <= chip.INT_STATUS < register + n:
            self.memory.lost = False
            self.registers[chip.INT_STATUS] = 0

    def fifo_on(self):
        return (self.registers[chip.USER_CTRL] & chip.FIFO_ON
                and self.registers[chip.FIFO_EN] == chip.ALL_IN_FIFO)

    def output_hz(self):
        if self.registers[chip.PWR_MGMT_1] & chip.SLEEP:
            return 0
        base = 8000 if self.registers[chip.CONFIG] & 7 in (0, 7) else chip.BASE_HZ
        return base / (1 + self.registers[chip.SMPLRT_DIV])

    def _bandwidth(self, register):
        code = self.registers[register] & 7
        return chip.BANDWIDTH_HZ[code if code < 7 else 0]

    def accel(self):
        own = chip.CONFIG if self.who_am_i == 0x68 else chip.ACCEL_CONFIG_2
        return (range_of(chip.ACCEL_RANGES, self.registers[chip.ACCEL_CONFIG] >> 3 & 3),
                self._bandwidth(own))

    def gyro(self):
        return (range_of(chip.GYRO_RANGES, self.registers[chip.GYRO_CONFIG] >> 3 & 3),
                self._bandwidth(chip.CONFIG))

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

    def shift(self, counts, lsb_per_g):
        self._add(counts, 0, lsb_per_g)

    def shift_gyro(self, counts, lsb_per_dps):
        self._add(counts, 3, lsb_per_dps)

    def _add(self, counts, first, lsb):
        if self._shift:
            for i in range(first, first + 3):
                count = counts[i] + int(round(self._shift[i] * lsb))
                counts[i] = max(-RAIL - 1, min(RAIL, count))


SIMULATED = {"mpu6050": SimulatedMPU6050}
