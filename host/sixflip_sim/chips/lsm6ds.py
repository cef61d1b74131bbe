"""Simulated LSM6DSOX and LSM6DS3TR-C, by the driver's own tables."""

from sixflip.chips import lsm6ds as chip
from sixflip_sim.chips.six_axis import SimulatedSixAxis, range_of

_HIDDEN = 0x80              # FUNC_CFG_ACCESS: the embedded functions' registers are shown


class SimulatedLSM6(SimulatedSixAxis):
    """Powered down after a reset: the output rates are 0. With IF_INC off a burst reads one
    register over and over, with BLE on the bytes are the other way round, and behind
    FUNC_CFG_ACCESS stand other registers, the identification not among them."""

    ready = (chip.STATUS_REG, 0x03)
    self_clearing = (chip.CTRL3_C, chip.SW_RESET)
    OFFSETS_BIT = None          # register and bit that let X_OFS_USR count; None: always

    def power_on(self):
        SimulatedSixAxis.power_on(self)
        self._hidden = bytearray(len(self.registers))

    def fall_asleep(self):
        self.registers[chip.CTRL1_XL] &= 0x0F
        self.registers[chip.CTRL2_G] &= 0x0F

    def write(self, data):
        start = self.pointer
        for value in data:
            self.write_register(self.pointer, value)
            if self.registers[chip.CTRL3_C] & chip.IF_INC:
                self.pointer = (self.pointer + 1) % len(self.registers)
        if not self.registers[chip.CTRL3_C] & chip.IF_INC:
            self.pointer = start

    def write_register(self, register, value):
        if self._is_hidden(register):
            self._hidden[register] = value
        elif register == chip.CTRL3_C and value & chip.SW_RESET and not self.resetting():
            self.reset()
        elif register != chip.STATUS_REG:
            SimulatedSixAxis.write_register(self, register, value)

    def _is_hidden(self, register):
        return (self.registers[chip.FUNC_CFG_ACCESS] & _HIDDEN
                and register != chip.FUNC_CFG_ACCESS)

    def read_into(self, buf):
        start = self.pointer
        if self._is_hidden(start):
            for i in range(len(buf)):
                buf[i] = self._hidden[(start + i) % len(self._hidden)]
        elif self.registers[chip.CTRL3_C] & chip.IF_INC or len(buf) == 1:
            SimulatedSixAxis.read_into(self, buf)
        else:
            self.refresh(start, 1)
            for i in range(len(buf)):
                buf[i] = self.registers[start]
        if start == chip.CTRL3_C and self.resetting():
            buf[0] |= chip.SW_RESET

    def output_hz(self):
        code = self.registers[chip.CTRL2_G] >> 4
        if code != self.registers[chip.CTRL1_XL] >> 4:
            return 0            # the driver runs both alike; anything else is not simulated
        return {row[1]: row[0] for row in chip.OUTPUT_RATES}.get(code, 0)

    def accel(self):
        return (range_of(chip.ACCEL_RANGES, self.registers[chip.CTRL1_XL] >> 2 & 3),
                self.accel_bandwidth(self.output_hz()))

    def gyro(self):
        return (range_of(chip.GYRO_RANGES, self.registers[chip.CTRL2_G] >> 1 & 7),
                self.gyro_bandwidth(self.output_hz()))

    def shift(self, counts, lsb_per_g):
        if self.OFFSETS_BIT and not self.registers[self.OFFSETS_BIT[0]] & self.OFFSETS_BIT[1]:
            return
        for axis in range(3):   # 2^-10 g a count, signed, subtracted
            offset = (self.registers[chip.X_OFS_USR + axis] ^ 0x80) - 0x80
            counts[axis] -= int(offset * lsb_per_g) >> 10


class SimulatedLSM6DSOX(SimulatedLSM6):
    driver = chip.LSM6DSOX
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    TRAPS = ((chip.CTRL3_C, 0), (chip.FUNC_CFG_ACCESS, _HIDDEN), (chip.CTRL1_XL, 0x4C))
    nominal_hz = (41.6, 48)
    defaults = {chip.CTRL3_C: chip.IF_INC, 0x18: 0xE0}
    OFFSETS_BIT = (0x16, 0x02)  # CTRL7_G, USR_OFF_ON_OUT

    def accel_bandwidth(self, hz):
        if not self.registers[chip.CTRL1_XL] & 0x02:
            return hz / 2
        return hz / (4, 10, 20, 45, 100, 200, 400, 800)[self.registers[chip.CTRL8_XL] >> 5]

    def gyro_bandwidth(self, hz):
        column = [row[0] for row in chip.OUTPUT_RATES].index(hz)
        on = self.registers[chip.CTRL4_C] & chip.LPF1_SEL_G
        widths = dict(self.driver.GYRO_LPF1)
        return widths.get(self.registers[chip.CTRL6_C] & 7 if on else 0, widths[0])[column]


class SimulatedLSM6DS3TRC(SimulatedLSM6):
    driver = chip.LSM6DS3TRC
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    TRAPS = SimulatedLSM6DSOX.TRAPS + ((chip.CTRL3_C, chip.BLE | chip.IF_INC),)
    nominal_hz = (416 / 9, 133)
    defaults = {chip.CTRL3_C: chip.IF_INC, 0x18: 0xE0}

    def high(self):
        return 0 if self.registers[chip.CTRL3_C] & chip.BLE else 1

    def accel_bandwidth(self, hz):
        setting = self.registers[chip.CTRL8_XL]
        if not setting & 0x80:
            return hz / (4 if self.registers[chip.CTRL1_XL] & 0x02 else 2)
        return hz / (50, 100, 9, 400)[setting >> 5 & 3]

    def gyro_bandwidth(self, hz):
        for rate, bandwidth in self.driver.GYRO_LPF2:
            if rate == hz:
                return bandwidth
        return dict(self.driver.GYRO_LPF1).get(
            self.registers[chip.CTRL6_C] & 3, (293, 505, 925))[(833, 1667, 3333).index(hz)]


SIMULATED = {"lsm6dsox": SimulatedLSM6DSOX, "lsm6ds3trc": SimulatedLSM6DS3TRC}
