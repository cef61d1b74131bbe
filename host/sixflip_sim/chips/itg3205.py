"""Simulated ITG3205, by the driver's own tables."""

import math

from sixflip.chips import itg3205 as chip
from sixflip_sim.chips.invensense import InvenSense

NOMINAL_BANDWIDTH_HZ = 42       # DLPF_CFG 3, what 100 Hz polling gets


class SimulatedITG3205(InvenSense):
    columns = (6, 3, 4, 5)
    self_clearing = (chip.PWR_MGM, chip.RESET)
    id_register = chip.WHO_AM_I
    power_register = chip.PWR_MGM
    divider_register = chip.SMPLRT_DIV
    filter_register = chip.DLPF_FS
    status_register = chip.INT_STATUS
    data_register = chip.TEMP_OUT_H
    data_length = chip.BURST

    def __init__(self, clock, model, address=0x68, who_am_i=chip.ID):
        self.who_am_i = who_am_i
        InvenSense.__init__(self, address, clock, model)

    def power_on(self):
        InvenSense.power_on(self)
        self.registers[chip.WHO_AM_I] = self.who_am_i

    def sample(self, k, t_us):
        setting = self.registers[chip.DLPF_FS]
        # FS_SEL 0..2 are reserved; read as ±250, 500, 1000 °/s, which a driver that
        # forgets to set it would see at once.
        lsb = chip.LSB_PER_DPS * (8 >> (setting >> 3 & 3))
        code = setting & 7
        bandwidth = chip.BANDWIDTH_HZ[code] if code < 7 else chip.BANDWIDTH_HZ[0]
        louder = math.sqrt(bandwidth / NOMINAL_BANDWIDTH_HZ)
        counts = self.counts
        self.model.gyro_counts(k, t_us, lsb, chip.RAIL, louder, counts)
        self.model.temp_counts(k, t_us, chip.TEMPERATURE[0], chip.TEMPERATURE[1], counts)
        self.store(self.columns)


SIMULATED = {"itg3205": SimulatedITG3205}
