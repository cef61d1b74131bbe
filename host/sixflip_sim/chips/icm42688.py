"""Simulated ICM-42688-P, by the driver's own tables."""

from sixflip.chips import icm42688 as chip
from sixflip_sim.chips.banked import SimulatedBanked, signed
from sixflip_sim.chips.fifo import packet
from sixflip_sim.chips.six_axis import range_of, rate_of

_SAMPLES_BIG = 0x10


class SimulatedICM42688(SimulatedBanked):
    """Both sensors are off after a reset. Bank 4 shifts, bit 4 of INTF_CONFIG0 turns the bytes."""

    driver = chip.ICM42688
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    self_clearing = (chip.DEVICE_CONFIG, chip.RESET)
    nominal_hz = (48.5, 48.5)
    TRAPS = ((chip.REG_BANK_SEL, 4), (chip.INTF_CONFIG0, 0x20), (chip.PWR_MGMT0, 0))
    cleared_by_data = False
    FIFO_BYTES, FIFO_FRAME = chip.FIFO_BYTES, 16
    no_i2c = (chip.INTF_CONFIG0, chip.NO_I2C)
    defaults = {chip.INTF_CONFIG0: 0x30, chip.GYRO_CONFIG0: 0x06, chip.ACCEL_CONFIG0: 0x06,
                chip.GYRO_CONFIG1: 0x16, chip.GYRO_ACCEL_CONFIG0: 0x11, 0x53: 0x0D}

    def fall_asleep(self):
        self.registers[chip.PWR_MGMT0] = 0

    def write_first(self, register, value):
        if register == chip.DEVICE_CONFIG and value & chip.RESET:
            self.reset()
        elif register == chip.SIGNAL_PATH_RESET:
            if value & chip.FLUSH:
                self.memory.clear()
        elif register != chip.INT_STATUS:
            SimulatedBanked.write_first(self, register, value)

    def refresh(self, register, n):
        SimulatedBanked.refresh(self, register, n)
        self.memory.fill()
        if self.memory.lost:
            self.registers[chip.INT_STATUS] |= chip.FULL
        level = len(self.memory.bytes)
        self.registers[chip.FIFO_COUNTH] = level >> 8
        self.registers[chip.FIFO_COUNTH + 1] = level & 0xFF

    def after_read(self, register, n):
        if register <= chip.INT_STATUS < register + n:
            self.memory.lost = False
            self.registers[chip.INT_STATUS] = 0

    def fifo_on(self):
        return (self.registers[chip.FIFO_CONFIG] == chip.STREAM
                and self.registers[chip.FIFO_CONFIG1] == chip.ALL_IN_FIFO)

    def fifo_frame(self, k):
        return packet(self.counts, self.high(), k)

    def read_into(self, buf):
        start = self.pointer
        SimulatedBanked.read_into(self, buf)
        if start == chip.DEVICE_CONFIG and self.resetting():
            buf[0] |= chip.RESET

    def high(self):
        return 0 if self.registers[chip.INTF_CONFIG0] & _SAMPLES_BIG else 1

    def output_hz(self):
        code = self.registers[chip.GYRO_CONFIG0] & 15
        if (self.registers[chip.PWR_MGMT0] != chip.LOW_NOISE
                or self.registers[chip.ACCEL_CONFIG0] & 15 != code):
            return 0
        return rate_of(chip.OUTPUT_RATES, code)

    def _bandwidth(self, bits):
        column = [row[0] for row in chip.OUTPUT_RATES].index(self.output_hz())
        widths = dict(chip.FILTERS)
        return widths.get(bits, widths[1])[column]

    def accel(self):
        return (range_of(chip.ACCEL_RANGES, self.registers[chip.ACCEL_CONFIG0] >> 5),
                self._bandwidth(self.registers[chip.GYRO_ACCEL_CONFIG0] >> 4))

    def gyro(self):
        return (range_of(chip.GYRO_RANGES, self.registers[chip.GYRO_CONFIG0] >> 5),
                self._bandwidth(self.registers[chip.GYRO_ACCEL_CONFIG0] & 15))

    def shift(self, counts, lsb_per_g):
        user = self.bank(4)[0x77:0x80]      # section 17.18: 0.5 mg a count
        words = (user[5] | (user[4] & 0xF0) << 4, user[6] | (user[7] & 0x0F) << 8,
                 user[8] | (user[7] & 0xF0) << 4)
        for axis in range(3):
            counts[axis] += int(signed(words[axis], 12) * lsb_per_g) // 2000


SIMULATED = {"icm42688": SimulatedICM42688}
