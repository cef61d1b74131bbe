"""Who is on the bus? Every answer of an identification register that was met in the wild."""

import errno
import unittest

from sixflip.chips import catalogue, probe
from sixflip_sim import worlds
from sixflip_sim.bus import FLAVOURS, SimulatedI2C


def world(sensor, **more):
    spec = {"sensor": sensor, "order": []}
    spec.update(more)
    return worlds.make(spec)


def without(a_world, address):
    """The bus of a world with one chip less."""
    a_world.i2c.chips = [c for c in a_world.i2c.chips if c.address != address]
    return a_world.i2c


def together(*some_worlds):
    """One bus with the chips of several worlds."""
    chips = []
    for one in some_worlds:
        chips.extend(one.chips)
    return SimulatedI2C(some_worlds[0].clock, chips)


class Found(unittest.TestCase):
    def test_every_relative_by_name(self):
        known = catalogue.ids_of("mpu6050")
        for who_am_i in known:
            imu, report = probe.find(world("mpu6050", who_am_i=who_am_i).i2c)
            self.assertEqual(imu.name,
                             "%s (0x%02x)" % (known[who_am_i], who_am_i))
            self.assertEqual(imu.who_am_i, (who_am_i, who_am_i))
            self.assertEqual(len(report), 1)

    def test_other_address(self):
        imu, report = probe.find(world("mpu6050", address=0x69).i2c)
        self.assertEqual(imu.address, 0x69)
        self.assertIn("0x69: MPU6050", report[0])
        imu, report = probe.find(world("gy85", address=0x69).i2c)
        self.assertEqual((imu.sensor, imu.gyro.address), ("gy85", 0x69))

    def test_gy85_is_not_taken_for_an_mpu6050(self):
        imu, report = probe.find(world("gy85").i2c)
        self.assertEqual((imu.sensor, imu.who_am_i), ("gy85", (0xE5, 0x68)))
        self.assertEqual(len(report), 2)

    def test_adxl345_alone(self):
        imu, report = probe.find(world("adxl345").i2c)
        self.assertEqual((imu.sensor, imu.has_gyro, imu.gyro_lsb_per_dps), ("adxl345", False, 0))
        self.assertIn("no gyro", report[-1])

    def test_alternative_address_of_the_adxl345(self):
        imu, report = probe.find(world("adxl345", address=0x1D).i2c)
        self.assertEqual(imu.address, 0x1D)

    def test_magnetometers_are_named(self):
        for name, address in (("HMC5883L", "0x1e"), ("QMC5883L", "0x0d")):
            imu, report = probe.find(world("gy85", magnetometer=name).i2c)
            self.assertEqual(imu.sensor, "gy85")
            self.assertIn("%s: %s" % (address, name), report[-1])

    def test_two_devices(self):
        imu, report = probe.find(together(world("mpu6050", address=0x69), world("mpu6050")))
        self.assertEqual(imu.address, 0x68)
        self.assertIn("0x69: a second one, not used", report)
        both = together(world("mpu6050", address=0x69), world("gy85"))
        self.assertEqual(probe.find(both)[0].sensor, "mpu6050")
        imu, report = probe.find(both, sensor="gy85")
        self.assertEqual(imu.sensor, "gy85")
        self.assertEqual(probe.find(both, sensor="adxl345")[0].sensor, "adxl345")

    def test_one_wrong_answer_is_asked_again(self):
        for address in (0x68, 0x53):
            bus = world("gy85", faults=[{"kind": "wrong_id", "at": 0, "address": address}]).i2c
            self.assertEqual(probe.find(bus)[0].sensor, "gy85")
        bus = world("mpu6050", faults=[{"kind": "nak", "at": 0, "count": 2}]).i2c
        self.assertEqual(probe.find(bus)[0].sensor, "mpu6050")


class Several(unittest.TestCase):
    def test_another_sensor_on_the_bus_is_named_with_how_to_take_it(self):
        both = world("icm42688", also="lsm6dsox").i2c
        imu, report = probe.find(both)
        self.assertEqual(imu.sensor, "lsm6dsox")
        self.assertIn("icm42688 is there, too: sensor icm42688 in the settings takes it instead",
                      report)
        self.assertEqual(probe.find(both, sensor="icm42688")[0].address, 0x68)

    def test_two_chips_at_one_address_are_none(self):
        for sensor, also in (("lsm6dsox", "lsm6dsv"), ("icm42688", "mpu6050"),
                             ("icm42688", "icm45686"), ("lsm6ds3trc", "lsm6dsv")):
            with self.assertRaises(probe.NoChip) as caught:
                probe.find(world(sensor, also=also).i2c)
            self.assertIn("two chips", str(caught.exception))

    def test_a_bmi270_is_named_with_why_it_is_not_used(self):
        bus = world("adxl345", stranger=[0x68, 0x00, 0x24]).i2c
        imu, report = probe.find(bus)
        self.assertEqual(imu.sensor, "adxl345")
        self.assertIn("0x68: BMI270 (who_am_i 0x24)", report)
        with self.assertRaises(probe.NoChip) as caught:
            probe.find(without(world("adxl345", stranger=[0x68, 0x00, 0x24]), 0x53))
        self.assertIn("maker's configuration file", str(caught.exception))
        with self.assertRaises(ValueError) as caught:
            probe.find(bus, sensor="bmi270")
        self.assertIn("expected auto or one of", str(caught.exception))

    def test_a_driver_that_was_not_sent_is_said(self):
        def none(sensor):
            raise ImportError("no module")

        kept, catalogue.driver = catalogue.driver, none
        try:
            with self.assertRaises(probe.NoChip) as caught:
                probe.find(world("lsm6dsv").i2c)
        finally:
            catalogue.driver = kept
        self.assertIn("sixflip provision --sensor lsm6dsv", str(caught.exception))


class NotFound(unittest.TestCase):
    def refused(self, bus, words, **more):
        with self.assertRaises(probe.NoChip) as caught:
            probe.find(bus, **more)
        self.assertIn(words, "\n".join(caught.exception.report))
        self.assertIn(words, str(caught.exception))
        self.assertIsInstance(caught.exception, OSError)
        return caught.exception

    def test_nobody_on_any_port(self):
        for flavour in FLAVOURS:
            bus = SimulatedI2C(world("mpu6050").clock, [], flavour)
            error = self.refused(bus, "nobody answers")
            self.assertEqual(error.args[0], errno.ENODEV)

    def test_unknown_identification(self):
        bus = world("mpu6050", who_am_i=0x12).i2c
        self.refused(bus, "0x12 in register 0x75: no chip that is known here; the nearest is "
                     "0x72 in 0x75, MPU6050 clone, 2 bits away")

    def test_identification_always_zero(self):
        bus = world("mpu6050", faults=[{"kind": "wrong_id", "every": 1}]).i2c
        self.refused(bus, "0x00 in register 0x75: that is no identification")

    def test_gyro_without_accelerometer(self):
        self.refused(without(world("gy85"), 0x53), "a gyro without accelerometer")

    def test_magnetometer_alone(self):
        bus = world("adxl345", magnetometer="QMC5883L").i2c
        bus.chips = bus.chips[1:]
        self.refused(bus, "no accelerometer found")

    def test_another_than_asked_for(self):
        self.refused(world("mpu6050").i2c, "ask for gy85", sensor="gy85")
        self.refused(world("gy85").i2c, "ask for mpu6050", sensor="mpu6050")
        self.assertRaises(ValueError, probe.find, world("gy85").i2c, None, "bno055")

    def test_lines_held_low(self):
        for flavour in FLAVOURS:
            for kind in ("stuck_sda", "timeout"):
                fault = {"kind": kind, "every": 1}
                bus = world("mpu6050", flavour=flavour, faults=[fault]).i2c
                with self.assertRaises(probe.BusStuck) as caught:
                    probe.find(bus)
                self.assertEqual(caught.exception.args[0], errno.ETIMEDOUT)
                self.assertIn("held low", caught.exception.report[0])


if __name__ == "__main__":
    unittest.main()
