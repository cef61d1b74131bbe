"""Chips on SPI: the same probe, drivers and sessions behind another bus."""

import sys
import tempfile
import unittest
from array import array

from sixflip.chips import catalogue, probe
from sixflip_device import power_up, settings
from sixflip_device.boards.spi_bus import SPIBus, SpidevPort, values_of
from sixflip_sim import worlds
from sixflip_sim.spi import SimulatedSPI
from tests.worlds.simulated_board import QUICK, SHORT_WORLD, STOP_WHEN_READY, SimulatedBoard


def world(sensor, **more):
    return worlds.make(dict({"sensor": sensor, "order": [], "ideal": True, "accel_noise_mg": 0,
                             "gyro_noise_dps": 0}, **more))


def bus_of(a_world, mode=3):
    return SPIBus(SimulatedSPI(a_world.i2c, mode), mode)


class Spidev:
    """What the package spidev has, in front of a simulated line."""

    def __init__(self, spi):
        self.spi = spi

    def xfer2(self, values):
        self.spi.select(0)
        n = values[1:].count(0) if values[0] & 0x80 else 0
        self.spi.write(bytes(values[:len(values) - n]))
        answer = bytearray(n)
        if n:
            self.spi.readinto(answer)
        self.spi.select(1)
        return [0] * (len(values) - n) + list(answer)

    def close(self):
        self.spi = None


class OnSpi(unittest.TestCase):
    def test_every_chip_is_found_and_read(self):
        for sensor in catalogue.ON_SPI:
            for mode in (0, 3):
                a_world = world(sensor, gyro_bias_dps=[1, -2, 3])
                bus = bus_of(a_world, mode)
                imu, report = probe.find(bus, a_world.clock.sleep_ms)
                self.assertEqual(imu.sensor, sensor)
                self.assertTrue(report[0].startswith("SPI: "))
                imu.configure(100)
                a_world.clock.sleep_ms(100)
                sample = array("h", [0] * 7)
                self.assertTrue(imu.read_into(sample))
                self.assertEqual(sample[2], round(imu.accel_lsb_per_g))
                self.assertEqual(sample[4], round(-2 * imu.gyro_lsb_per_dps))
                self.assertTrue(imu.awake())

    def test_invensense_chips_have_i2c_shut_off_there_and_nowhere_else(self):
        """Else edges on the lines of SPI may be taken for I2C (MPU-6500 register map, register
        106; ICM-20948, 8.1; ICM-42688-P, 14.38). On I2C the bit makes a chip deaf for good."""
        shut = 0
        for sensor in catalogue.ON_SPI:
            register, bits = worlds.simulated(sensor).no_i2c
            a_world = world(sensor)
            imu = probe.find(a_world.i2c, a_world.clock.sleep_ms)[0]
            imu.configure(100)
            if bits:
                self.assertEqual(a_world.chips[0].registers[register] & bits, 0)
                a_world.i2c.writeto_mem(imu.address, register, bytes([bits]))
                with self.assertRaises(OSError):
                    imu.awake()
            for by_fifo in (False, True)[:1 + bool(imu.FIFO)]:
                a_world = world(sensor)
                imu = probe.find(bus_of(a_world), a_world.clock.sleep_ms)[0]
                if by_fifo:
                    imu.use_fifo()
                imu.configure(200)
                self.assertEqual(a_world.chips[0].registers[register] & bits, bits)
                self.assertTrue(imu.awake())
                shut += bool(bits)
        self.assertEqual(shut, 6)

    def test_linux_sends_and_reads_in_one_transfer(self):
        a_world = world("icm20948")
        bus = SPIBus(SpidevPort(Spidev(SimulatedSPI(a_world.i2c, 3))))
        imu = probe.find(bus, a_world.clock.sleep_ms)[0]
        imu.configure(200)
        a_world.clock.sleep_ms(50)
        sample = array("h", [0] * 7)
        self.assertTrue(imu.read_into(sample))
        self.assertEqual(sample[2], 16384)
        bus.close()

    def test_a_wrong_mode_is_named(self):
        for sensor in catalogue.ON_SPI:
            for mode in (1, 2):
                with self.assertRaises(probe.NoChip) as caught:
                    probe.find(bus_of(world(sensor), mode))
                self.assertIn("SPI mode %d is wrong, the chips take 0 and 3" % mode,
                              str(caught.exception))

    def test_nobody_there(self):
        a_world = world("lsm6dsox")
        bus = bus_of(a_world)
        del a_world.i2c.chips[:]
        with self.assertRaises(probe.NoChip) as caught:
            probe.find(bus)
        self.assertIn("MISO", str(caught.exception))
        self.assertIn("0xff in register 0x0f", str(caught.exception))

    def test_an_unknown_id_and_a_clone(self):
        bus = bus_of(world("lsm6dsv", who_am_i=0x73))
        with self.assertRaises(probe.NoChip) as caught:
            probe.find(bus)
        self.assertIn("0x73 in register 0x0f", str(caught.exception))
        self.assertIn("the nearest is", str(caught.exception))
        self.assertEqual(probe.find(bus, sensor="lsm6dsv")[0].who_am_i, (0x73, 0x73))

    def test_a_raspberry_pi_without_spidev_says_what_to_do(self):
        from sixflip_device.boards import raspberry_pi
        kept = sys.modules.get("spidev")
        sys.modules["spidev"] = None
        try:
            with self.assertRaises(OSError) as caught:
                raspberry_pi.open_spi({})
        finally:
            del sys.modules["spidev"]
            if kept is not None:
                sys.modules["spidev"] = kept
        self.assertIn("pip install spidev", str(caught.exception))

    def test_a_raspberry_pi_opens_the_device_in_the_mode_that_is_set(self):
        import types

        from sixflip_device.boards import raspberry_pi
        opened = []

        class SpiDev(Spidev):
            def __init__(self):
                Spidev.__init__(self, SimulatedSPI(world("qmi8658").i2c, 3))

            def open(self, bus, device):
                opened.append((bus, device))

        kept = sys.modules.get("spidev")
        sys.modules["spidev"] = types.SimpleNamespace(SpiDev=SpiDev)
        try:
            bus = raspberry_pi.open_spi({"cs": 1, "freq": 500000})
        finally:
            del sys.modules["spidev"]
            if kept is not None:
                sys.modules["spidev"] = kept
        self.assertEqual(opened, [(0, 1)])
        self.assertEqual((bus._port._device.mode, bus._port._device.max_speed_hz), (3, 500000))
        self.assertEqual(probe.find(bus)[0].sensor, "qmi8658")

    def test_settings_that_cannot_be(self):
        for spi, words in (({"clk": 3}, "a key clk"), ({"mode": 4}, "the mode 4")):
            with self.assertRaises(ValueError) as caught:
                values_of(spi, {"cs": 1})
            self.assertIn(words, str(caught.exception))
        self.assertEqual(values_of({"cs": 9}, {"cs": 17, "bus": 0}),
                         {"cs": 9, "bus": 0, "mode": 3, "freq": 1000000})


class Board(SimulatedBoard):
    scl_pulse = None

    def reopen_i2c(self):
        return self.i2c


class Session(unittest.TestCase):
    def test_a_whole_session_with_a_reset_in_the_middle(self):
        a_world = worlds.make(dict(SHORT_WORLD, sensor="icm42688",
                                   faults=[{"kind": "reset", "at_ms": 25000}]))
        with tempfile.TemporaryDirectory() as root:
            board = Board(a_world, root, (STOP_WHEN_READY,))
            board.i2c = bus_of(a_world)
            power_up.run(board, *settings.merge(QUICK))
        self.assertEqual(board.only("hello")["report"][0], "SPI: ICM-42688-P (who_am_i 0x47)")
        self.assertEqual(board.only("solved")["verdict"], "good", board.only("solved"))
        self.assertTrue(board.named("bus_error"))
        self.assertTrue(board.only("ready")["corrected"])


if __name__ == "__main__":
    unittest.main()
