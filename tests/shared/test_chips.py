"""Drivers against simulated chips and against a bus that plays bursts made beforehand."""

import io
import unittest
from array import array

from sixflip.chips import adxl345, catalogue, itg3205, mpu6050, probe
from sixflip.chips.adxl345 import ADXL345
from sixflip.chips.gy85 import GY85
from sixflip.chips.itg3205 import ITG3205
from sixflip.chips.mpu6050 import MPU6050
from sixflip_sim import tape, worlds

try:
    from micropython import heap_lock, heap_unlock
except ImportError:
    def heap_lock():
        pass

    def heap_unlock():
        pass


def still(sensor, **more):
    spec = {"sensor": sensor, "order": [], "ideal": True, "accel_noise_mg": 0,
            "gyro_noise_dps": 0}
    spec.update(more)
    return worlds.make(spec)


def sample():
    return array("h", [0] * 7)


class FullScale(unittest.TestCase):
    """Published drivers shipped 62.5 for 65.5: full scale times LSB gives such slips away."""

    def test_mpu6050(self):
        for ranges in (mpu6050.ACCEL_RANGES, mpu6050.GYRO_RANGES):
            for full_scale, lsb, _ in ranges:
                self.assertAlmostEqual(full_scale * lsb, 32768, delta=35)

    def test_adxl345_and_itg3205(self):
        self.assertEqual(adxl345.RANGE_G * adxl345.LSB_PER_G, 4096)
        self.assertEqual(ADXL345(None).accel_rail, 4095)
        self.assertEqual(ADXL345(None, accel_range_g=2).accel_rail, 511)
        self.assertEqual(itg3205.RANGE_DPS * itg3205.LSB_PER_DPS, 28750)

    def test_thermometers(self):
        lsb, offset = itg3205.TEMPERATURE
        self.assertAlmostEqual(-13200 / lsb + offset, 35.0, places=5)
        lsb, offset = mpu6050.TEMPERATURE
        self.assertAlmostEqual(-521 / lsb + offset, 35.0, delta=0.01)


class Columns(unittest.TestCase):
    """Every register byte lands in its column, sign and byte order included."""

    def test_mpu6050(self):
        words = (0x0102, 0xFFFE, 0x7FFF, 0x8000, 0x1234, 0xFEDC, 0x0001)
        data = bytearray()
        for word in words:
            data.append(word >> 8)
            data.append(word & 0xFF)
        imu = MPU6050(tape.open_tape("mpu6050", [io.BytesIO(bytes(data))]))
        out = sample()
        self.assertTrue(imu.read_into(out))
        self.assertEqual(list(out), [0x0102, -2, 32767, 0x1234, -292, 1, -32768])

    def test_gy85(self):
        accel = io.BytesIO(bytes([0x02, 0x01, 0xFE, 0xFF, 0x00, 0xF0]))
        gyro = io.BytesIO(bytes([0xCC, 0x70, 0x01, 0x02, 0xFF, 0xFE, 0x80, 0x00]))
        imu = GY85(tape.open_tape("gy85", [accel, gyro]))
        out = sample()
        self.assertTrue(imu.read_into(out))
        self.assertEqual(list(out), [0x0102, -2, -4096, 0x0102, -2, -32768, -13200])

    def test_adxl345_clears_what_it_lacks(self):
        imu = ADXL345(tape.open_tape("gy85", [io.BytesIO(b"\x01\x00" * 3), io.BytesIO(b"")]))
        out = array("h", [9] * 7)
        imu.read_into(out)
        self.assertEqual(list(out), [1, 1, 1, 0, 0, 0, 0])

    def test_empty_bursts_are_no_samples(self):
        for filler in (b"\x00", b"\xff"):
            imu = MPU6050(tape.open_tape("mpu6050", [io.BytesIO(filler * 14)]))
            self.assertFalse(imu.read_into(sample()))
            pair = tape.open_tape("gy85", [io.BytesIO(filler * 6), io.BytesIO(b"\x01\x02" * 4)])
            self.assertFalse(GY85(pair).read_into(sample()))
            pair = tape.open_tape("gy85", [io.BytesIO(b"\x01\x02" * 3), io.BytesIO(filler * 8)])
            self.assertFalse(GY85(pair).read_into(sample()))

    def test_no_allocation(self):
        out = sample()
        for sensor, driver, lengths in (("mpu6050", MPU6050, (14,)), ("gy85", GY85, (6, 8))):
            files = [io.BytesIO(bytes(range(n)) * 50) for n in lengths]
            bus = tape.open_tape(sensor, files)
            imu = driver(bus)
            imu.configure(100)
            good = True
            heap_lock()
            try:
                for _ in range(50):
                    good = imu.read_into(out) and imu.awake() and good
            finally:
                heap_unlock()
            self.assertTrue(good)
            self.assertEqual([chip.played for chip in bus.chips], [50] * len(lengths))


class Configure(unittest.TestCase):
    def test_every_relative(self):
        for who_am_i in catalogue.ids_of("mpu6050"):
            world = still("mpu6050", who_am_i=who_am_i, temperature_c=31.0)
            imu = MPU6050(world.i2c, 0x68, who_am_i, world.clock.sleep_ms)
            imu.configure(100)
            out = sample()
            world.clock.sleep_ms(20)
            self.assertTrue(imu.read_into(out))
            self.assertEqual(list(out[:6]), [0, 0, 16384, 0, 0, 0])
            celsius = out[6] / imu.temp_lsb_per_c + imu.temp_offset_c
            self.assertAlmostEqual(celsius, 31.0, delta=0.1)
            self.assertEqual(imu.metadata()["who_am_i"], [who_am_i, who_am_i])

    def test_without_sleep(self):
        for sensor, driver in (("mpu6050", MPU6050), ("gy85", GY85), ("adxl345", ADXL345)):
            world = still(sensor)
            imu = driver(world.i2c)
            imu.configure(100)
            self.assertTrue(imu.awake())

    def test_ranges(self):
        for g, lsb, _ in mpu6050.ACCEL_RANGES:
            world = still("mpu6050")
            imu = MPU6050(world.i2c, accel_range_g=g, gyro_range_dps=2000)
            imu.configure(100)
            out = sample()
            imu.read_into(out)
            self.assertEqual(out[2], lsb)
            self.assertEqual(imu.accel_lsb_per_g, lsb)
        self.assertRaises(ValueError, MPU6050, world.i2c, accel_range_g=3)

    def test_gyro_ranges_on_a_turning_box(self):
        for dps, lsb, _ in mpu6050.GYRO_RANGES:
            world = still("mpu6050")
            world.scene.turn(2000000, (0.0, 0.0, 1.0), 1.0)
            middle = world.scene.end_us() - 1000000
            imu = MPU6050(world.i2c, gyro_range_dps=dps)
            imu.configure(100)
            world.clock.sleep_us(middle - world.clock.now_us())
            out = sample()
            imu.read_into(out)
            rate_dps = 1.875 * 1.0 / 2.0 * 57.29578       # peak of minimum jerk
            self.assertAlmostEqual(out[5], rate_dps * lsb, delta=lsb * 0.02)

    def test_offsets_of_somebody_else_are_cleared(self):
        world = still("adxl345")
        world.i2c.writeto_mem(0x53, adxl345.OFSX + 2, b"\x40")
        imu = ADXL345(world.i2c)
        imu.configure(100)
        out = sample()
        imu.read_into(out)
        self.assertEqual(list(out), [0, 0, 256, 0, 0, 0, 0])

    def test_what_is_written_into_offset_registers_shifts_and_is_named(self):
        # register, value, column, counts: 0.98 mg and 4 / 131 deg/s a step, 1 / 4096 g a count
        for who_am_i, register, value, column, shift in (
                (0x68, 0x06, 0xFD, 0, 1024), (0x70, 0x7A, 0x03, 1, 2048),
                (0x70, 0x15, 0x01, 4, 512), (0x68, 0x18, 0x10, 5, 32)):
            world = still("mpu6050", who_am_i=who_am_i)
            imu = MPU6050(world.i2c, 0x68, who_am_i)
            imu.configure(100)
            self.assertEqual(imu.shifted(), "")
            before, after = sample(), sample()
            imu.read_into(before)
            world.i2c.writeto_mem(0x68, register, bytes([value]))
            world.clock.sleep_ms(20)
            imu.read_into(after)
            self.assertEqual([a - b for a, b in zip(after, before)][column], shift)
            self.assertFalse(imu.awake())
            self.assertIn("register 0x%02x of" % register, imu.shifted())

    def test_gy85(self):
        world = still("gy85", temperature_c=35.0)
        imu = GY85(world.i2c)
        imu.configure(100)
        out = sample()
        imu.read_into(out)
        self.assertEqual(list(out[:6]), [0, 0, 256, 0, 0, 0])
        self.assertAlmostEqual(out[6], -13200, delta=15)
        data = imu.metadata()
        self.assertEqual(data["sensor"], "gy85")
        self.assertEqual(data["registers"]["gyro 0x16"], 0x1B)
        self.assertEqual(data["registers"]["0x31"], 0x0B)

    def test_rates_that_cannot_be(self):
        world = still("gy85")
        for driver, rate in ((MPU6050, 501), (MPU6050, 0), (ADXL345, 401), (ITG3205, 501)):
            self.assertRaises(ValueError, driver(world.i2c).configure, rate)

    def test_four_times_or_twice_the_polling_rate(self):
        for rate in (1, 7, 50, 100, 200, 400):
            for sensor, driver in (("mpu6050", MPU6050), ("adxl345", ADXL345)):
                world = still(sensor)
                imu = driver(world.i2c)
                imu.configure(rate)
                times = 4 if sensor == "mpu6050" and rate <= 250 else 2
                self.assertTrue(imu.metadata()["output_rate_hz"] >= times * rate)

    def test_lost_writes_are_noticed(self):
        """SoftI2C keeps silent about a lost byte: one is repaired, all of them are an error."""
        for sensor, driver in (("mpu6050", MPU6050), ("gy85", GY85), ("adxl345", ADXL345)):
            for skip in range(4):
                fault = {"kind": "data_nak", "at": 2 * skip}
                world = still(sensor, flavour="soft", faults=[fault])
                imu = driver(world.i2c)
                imu.configure(100)
                self.assertTrue(imu.awake())
            world = still(sensor, flavour="soft", faults=[{"kind": "data_nak", "every": 1}])
            with self.assertRaises(OSError) as caught:
                driver(world.i2c).configure(100)
            self.assertIn("expected", str(caught.exception))

    def test_reset_that_never_ends(self):
        class Stuck:
            def readfrom_mem_into(self, address, register, buf):
                buf[0] = 0x80

            def writeto_mem(self, address, register, data):
                pass

        for driver in (MPU6050, ITG3205):
            with self.assertRaises(OSError) as caught:
                driver(Stuck()).configure(100)
            self.assertIn("reset not finished", str(caught.exception))


class Awake(unittest.TestCase):
    def check(self, sensor, driver, fault):
        world = still(sensor)
        imu = driver(world.i2c, sleep_ms=world.clock.sleep_ms)
        imu.configure(100)
        out = sample()
        imu.read_into(out)
        self.assertTrue(imu.awake())
        world.i2c.faults.add(fault)
        world.clock.sleep_ms(10)
        imu.read_into(out)
        self.assertFalse(imu.awake())
        imu.configure(100)
        self.assertTrue(imu.awake())
        self.assertTrue(imu.read_into(out))

    def test_reset(self):
        self.check("mpu6050", MPU6050, {"kind": "reset", "at": 0})
        self.check("adxl345", ADXL345, {"kind": "reset", "at": 0})
        self.check("gy85", GY85, {"kind": "reset", "at": 0, "address": 0x53})
        self.check("gy85", GY85, {"kind": "reset", "at": 0, "address": 0x68})

    def test_reset_of_a_relative_that_wakes_by_itself(self):
        world = still("mpu6050", who_am_i=0x71)
        imu = MPU6050(world.i2c, who_am_i=0x71)
        imu.configure(100)
        world.chips[0].power_on()
        self.assertFalse(imu.awake())

    def test_sleep(self):
        self.check("mpu6050", MPU6050, {"kind": "sleep", "at": 0})
        self.check("gy85", GY85, {"kind": "sleep", "at": 0, "address": 0x68})
        self.check("adxl345", ADXL345, {"kind": "sleep", "at": 0})

    def test_reset_chip_reads_zeros(self):
        world = still("mpu6050")
        imu = MPU6050(world.i2c)
        imu.configure(100)
        out = sample()
        self.assertTrue(imu.read_into(out))
        world.chips[0].power_on()
        self.assertFalse(imu.read_into(out))


class Tape(unittest.TestCase):
    def test_a_world_on_tape_reads_the_same(self):
        for sensor, driver in (("mpu6050", MPU6050), ("gy85", GY85)):
            spec = {"sensor": sensor, "seed": 5, "order": ["Z+a", "Z+b"], "first_rest_s": 0.5,
                    "dwell_s": 0.3, "move_s": 0.5}
            files = [io.BytesIO(), io.BytesIO()]
            n = tape.record(worlds.make(spec), files)
            for file in files:
                file.seek(0)
            self.assertGreater(n, 120)
            played = driver(tape.open_tape(sensor, files))
            world = worlds.make(spec)
            clock = world.clock
            live = probe.find(world.i2c, clock.sleep_ms)[0]
            live.configure(100)
            start = clock.now_us()
            here, there = sample(), sample()
            for i in range(1, n + 1):
                clock.sleep_us(start + i * 10000 - clock.now_us())
                live.read_into(here)
                played.read_into(there)
                self.assertEqual(list(here), list(there))


if __name__ == "__main__":
    unittest.main()
