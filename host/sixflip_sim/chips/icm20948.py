"""Simulated ICM-20948, by the driver's own tables."""

from sixflip.chips import icm20948 as chip
from sixflip_sim.chips.banked import SimulatedBanked, signed
from sixflip_sim.chips.mpu6050 import TRIM
from sixflip_sim.chips.six_axis import range_of


class SimulatedICM20948(SimulatedBanked):
    """Asleep after a reset. Ranges, filters and dividers are in bank 2, the accelerometer's
    trim in bank 1: 0.98 mg a step from bit 1 on."""

    driver = chip.ICM20948
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    self_clearing = (chip.PWR_MGMT_1, chip.RESET)
    nominal_hz = (50.4, 51.2)
    TRAPS = ((chip.REG_BANK_SEL, 0x20), (chip.PWR_MGMT_1, chip.SLEEP))
    RESET_US = 5000
    cleared_by_data = False
    defaults = {chip.PWR_MGMT_1: 0x41}
    FIFO_BYTES, FIFO_FRAME = 512, 14
    no_i2c = (chip.USER_CTRL, chip.I2C_IF_DIS)

    def power_on(self):
        SimulatedBanked.power_on(self)
        two = self.bank(2)
        two[chip.GYRO_CONFIG_1 & 0xFF] = 0x01
        two[chip.ACCEL_CONFIG & 0xFF] = 0x01
        for axis in range(3):
            register = (chip.XA_OFFS_H & 0xFF) + 3 * axis
            self.bank(1)[register] = TRIM[axis] >> 8
            self.bank(1)[register + 1] = TRIM[axis] & 0xFF

    def fall_asleep(self):
        self.registers[chip.PWR_MGMT_1] |= chip.SLEEP

    def write_first(self, register, value):
        if register == chip.PWR_MGMT_1 and value & chip.RESET:
            self.reset()
        elif register not in (chip.INT_STATUS_1, chip.INT_STATUS_2):
            SimulatedBanked.write_first(self, register, value)
            if register == chip.FIFO_RST and value:
                self.memory.clear()

    def refresh(self, register, n):
        SimulatedBanked.refresh(self, register, n)
        self.memory.fill()
        level = len(self.memory.bytes)
        self.registers[chip.INT_STATUS_2] = chip.ALL_IN_FIFO if self.memory.lost else 0
        self.registers[chip.FIFO_COUNTH] = level >> 8
        self.registers[chip.FIFO_COUNTH + 1] = level & 0xFF

    def after_read(self, register, n):
        SimulatedBanked.after_read(self, register, n)
        if register <= chip.INT_STATUS_2 < register + n:
            self.memory.lost = False

    def fifo_on(self):
        return (self.registers[chip.USER_CTRL] & chip.FIFO_ON and not self.registers[chip.FIFO_RST]
                and self.registers[chip.FIFO_EN_2] == chip.ALL_IN_FIFO)

    def read_into(self, buf):
        start = self.pointer
        SimulatedBanked.read_into(self, buf)
        if start == chip.PWR_MGMT_1 and not self.selected and self.resetting():
            buf[0] |= chip.RESET

    def output_hz(self):
        two = self.bank(2)
        divider = two[chip.GYRO_SMPLRT_DIV & 0xFF]
        low = two[(chip.ACCEL_SMPLRT_DIV_1 & 0xFF) + 1]
        if (self.registers[chip.PWR_MGMT_1] & chip.SLEEP
                or two[chip.ACCEL_SMPLRT_DIV_1 & 0xFF] << 8 | low != divider):
            return 0            # the driver runs both alike; anything else is not simulated
        return chip.BASE_HZ / (1 + divider)

    def accel(self):
        setting = self.bank(2)[chip.ACCEL_CONFIG & 0xFF]
        widths = dict(chip.ACCEL_FILTERS)
        return (range_of(chip.ACCEL_RANGES, setting >> 1 & 3),
                widths.get(setting >> 3 & 7, widths[1]) if setting & 1 else 1209.0)

    def gyro(self):
        setting = self.bank(2)[chip.GYRO_CONFIG_1 & 0xFF]
        widths = dict(chip.GYRO_FILTERS)
        return (range_of(chip.GYRO_RANGES, setting >> 1 & 3),
                widths.get(setting >> 3 & 7, widths[0]) if setting & 1 else 12106.0)

    def shift(self, counts, lsb_per_g):
        one = self.bank(1)
        for axis in range(3):
            register = (chip.XA_OFFS_H & 0xFF) + 3 * axis
            word = signed(one[register] << 8 | one[register + 1] & 0xFE, 16)
            off = word - signed(TRIM[axis] & 0xFFFE, 16)
            counts[axis] += int(off * lsb_per_g) // 2048


SIMULATED = {"icm20948": SimulatedICM20948}
