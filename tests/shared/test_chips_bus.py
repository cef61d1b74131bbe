"""The simulated bus and chips fail and behave as the real ones (BUS: machine.I2C's errors)."""

import errno
import unittest
from array import array

from sixflip.chips import adxl345, itg3205, mpu6050, probe
from sixflip_sim import worlds
from sixflip_sim.bus import EREMOTEIO, FLAVOURS, SimulatedI2C

NOBODY = {"rp2": errno.EIO, "esp32": errno.ENODEV, "stm32": errno.ENODEV, "soft": errno.ENODEV,
          "linux": EREMOTEIO}


def code_of(call, *args):
    try:
        call(*args)
    except OSError as error:
        return error.args[0]
    return 0


def world(sensor="mpu6050", **more):
    spec = {"sensor": sensor, "order": []}
    spec.update(more)
    return worlds.make(spec)


def running(sensor="mpu6050", **more):
    """(world, imu) configured for 100 Hz."""
    a_world = world(sensor, **more)
    imu = probe.find(a_world.i2c, a_world.clock.sleep_ms)[0]
    imu.configure(100)
    return a_world, imu


class Errors(unittest.TestCase):
    def test_nobody_there(self):
        for flavour in FLAVOURS:
            bus = world(flavour=flavour).i2c
            for call, args in ((bus.readfrom_mem, (0x50, 0, 1)), (bus.writeto, (0x50, b"\0")),
                               (bus.writeto_mem, (0x50, 0, b"\0")), (bus.readfrom, (0x50, 1))):
                self.assertEqual(code_of(call, *args), NOBODY[flavour])

    def test_data_not_acknowledged(self):
        wanted = {"rp2": errno.EIO, "esp32": errno.ENODEV, "stm32": errno.EIO, "soft": 0,
                  "linux": EREMOTEIO}
        for flavour in FLAVOURS:
            bus = world(flavour=flavour, faults=[{"kind": "data_nak", "at": 0}]).i2c
            got = code_of(bus.writeto_mem, 0x68, mpu6050.SMPLRT_DIV, b"\x07")
            self.assertEqual(got, wanted[flavour])
            self.assertEqual(bus.readfrom_mem(0x68, mpu6050.SMPLRT_DIV, 1), b"\x00")

    def test_sda_freed_by_nine_pulses(self):
        for flavour in FLAVOURS:
            bus = world(flavour=flavour, faults=[{"kind": "stuck_sda", "at": 0}]).i2c
            stuck = code_of(bus.readfrom_mem, 0x68, mpu6050.WHO_AM_I, 1)
            self.assertEqual(stuck, 0 if flavour == "soft" else errno.ETIMEDOUT)
            for _ in range(8):
                bus.pulse_scl()
            if flavour == "soft":       # SDA low looks like an acknowledgement and like zeros
                self.assertEqual(bus.readfrom_mem(0x68, mpu6050.WHO_AM_I, 1), b"\x00")
            else:
                self.assertEqual(code_of(bus.readfrom_mem, 0x68, 0, 1), errno.ETIMEDOUT)
            bus.pulse_scl()
            self.assertEqual(bus.readfrom_mem(0x68, mpu6050.WHO_AM_I, 1), b"\x68")

    def test_linux_block_length(self):
        bus = world(flavour="linux").i2c
        self.assertEqual(code_of(bus.readfrom_mem, 0x68, 0, 33), errno.EINVAL)
        self.assertEqual(len(bus.readfrom_mem(0x68, 0, 32)), 32)

    def test_descriptions_that_mean_nothing(self):
        self.assertRaises(ValueError, world, flavour="avr")
        self.assertRaises(ValueError, world, faults=[{"kind": "gremlin", "at": 1}])
        self.assertRaises(ValueError, world, faults=[{"kind": "nak"}])
        self.assertRaises(ValueError, worlds.make, {"tilt": 2})
        self.assertRaises(ValueError, world, sensor="bno055")
        self.assertRaises(ValueError, world, magnetometer="AK8963")
        self.assertRaises(ValueError, worlds.make, {"mishaps": [{"kind": "earthquake"}]})


class Schedule(unittest.TestCase):
    def test_by_number_and_count(self):
        bus = world(faults=[{"kind": "nak", "at": 2, "count": 3}]).i2c
        codes = [code_of(bus.readfrom_mem, 0x68, mpu6050.WHO_AM_I, 1) for _ in range(8)]
        self.assertEqual([c != 0 for c in codes], [False] * 2 + [True] * 3 + [False] * 3)

    def test_by_time(self):
        a_world = world(faults=[{"kind": "nak", "at_ms": 100}])
        read = a_world.i2c.readfrom_mem
        self.assertEqual(code_of(read, 0x68, 0, 1), 0)
        a_world.clock.sleep_ms(100)
        self.assertEqual(code_of(read, 0x68, 0, 1), errno.EIO)
        self.assertEqual(code_of(read, 0x68, 0, 1), 0)

    def test_by_chance_is_reproducible(self):
        runs = []
        for seed in (3, 3, 4):
            bus = world(faults=[{"kind": "nak", "rate": 0.2, "seed": seed}]).i2c
            runs.append([code_of(bus.readfrom_mem, 0x68, 0, 1) for _ in range(500)])
        self.assertEqual(runs[0], runs[1])
        self.assertNotEqual(runs[0], runs[2])
        hits = len([c for c in runs[0] if c])
        self.assertTrue(70 <= hits <= 130)
        self.assertEqual(hits, len([c for c in runs[0] if c == errno.EIO]))

    def test_every(self):
        bus = world(faults=[{"kind": "nak", "every": 3}]).i2c
        hits = [i for i in range(9) if code_of(bus.readfrom_mem, 0x68, 0, 1)]
        self.assertEqual(hits, [2, 5, 8])
        self.assertEqual(bus.faults.happened, [(2, "nak"), (5, "nak"), (8, "nak")])

    def test_late(self):
        a_world = world(faults=[{"kind": "late", "at": 1, "us": 70000}])
        a_world.i2c.readfrom_mem(0x68, 0, 1)
        before = a_world.clock.now_us()
        a_world.i2c.readfrom_mem(0x68, 0, 1)
        self.assertTrue(70000 <= a_world.clock.now_us() - before < 71000)

    def test_unplugged_for_a_while(self):
        a_world, imu = running()
        a_world.i2c.faults.add({"kind": "unplugged", "at": 0, "for_ms": 50})
        out = array("h", [0] * 7)
        self.assertEqual(code_of(imu.read_into, out), errno.EIO)
        a_world.clock.sleep_ms(60)
        self.assertFalse(imu.read_into(out))
        self.assertFalse(imu.awake())


class Readings(unittest.TestCase):
    def readings(self, n, fault=None, sensor="mpu6050", rate=100):
        a_world, imu = running(sensor)
        start = a_world.i2c.transactions
        if fault:
            fault["at"] = start + 5
            a_world.i2c.faults.add(fault)
        rows = []
        for _ in range(n):
            a_world.clock.sleep_us(1000000 // rate)
            out = array("h", [0] * 7)
            imu.read_into(out)
            rows.append(list(out))
        return rows

    def test_no_sample_is_seen_twice(self):
        for sensor in ("mpu6050", "gy85"):
            rows = self.readings(60, None, sensor)
            same = [i for i in range(1, 60) if rows[i] == rows[i - 1]]
            self.assertEqual(same, [])

    def test_duplicate(self):
        good = self.readings(10)
        bad = self.readings(10, {"kind": "duplicate"})
        self.assertEqual(bad[5], good[4])
        self.assertEqual(bad[:5] + bad[6:], good[:5] + good[6:])

    def test_torn(self):
        good = self.readings(10)
        bad = self.readings(10, {"kind": "torn", "byte": 4})
        self.assertEqual(bad[5], good[4][:2] + good[5][2:])

    def test_noise(self):
        for sensor, last in (("mpu6050", 7), ("adxl345", 3)):
            good = self.readings(8, None, sensor)
            bad = self.readings(8, {"kind": "noise", "counts": 100}, sensor)
            self.assertEqual(bad[:5] + bad[6:], good[:5] + good[6:])
            off = [bad[5][i] - good[5][i] for i in range(7)]
            self.assertEqual([i for i in range(7) if off[i]], list(range(last)))
            self.assertTrue(max([abs(x) for x in off]) < 500)

    def test_frozen(self):
        rows = self.readings(20, {"kind": "frozen", "for_ms": 100})
        for i in range(5, 14):
            self.assertEqual(rows[i], rows[4])
        self.assertNotEqual(rows[18], rows[4])


class Registers(unittest.TestCase):
    def test_wakes_asleep_with_zeros(self):
        a_world = world()
        bus = a_world.i2c
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.PWR_MGMT_1, 1), b"\x40")
        a_world.clock.sleep_ms(50)
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.ACCEL_XOUT_H, 14), bytes(14))
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.WHO_AM_I, 1), b"\x68")

    def test_sleep_keeps_the_last_reading(self):
        a_world, imu = running()
        out = array("h", [0] * 7)
        imu.read_into(out)
        a_world.chips[0].fall_asleep()
        a_world.clock.sleep_ms(500)
        again = array("h", [0] * 7)
        imu.read_into(again)
        self.assertEqual(list(out), list(again))
        self.assertFalse(imu.awake())

    def test_data_ready(self):
        a_world, imu = running()
        bus = a_world.i2c
        a_world.clock.sleep_ms(20)
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.INT_STATUS, 1)[0] & 1, 1)
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.INT_STATUS, 1)[0] & 1, 0)
        a_world.clock.sleep_us(5000)
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.INT_STATUS, 1)[0] & 1, 1)
        a_world, imu = running("gy85")
        bus = a_world.i2c
        a_world.clock.sleep_ms(20)
        self.assertEqual(bus.readfrom_mem(0x53, adxl345.INT_SOURCE, 1)[0] & 0x80, 0x80)
        bus.readfrom_mem(0x53, adxl345.DATAX0, 6)
        self.assertEqual(bus.readfrom_mem(0x53, adxl345.INT_SOURCE, 1)[0] & 0x80, 0)
        self.assertEqual(bus.readfrom_mem(0x68, itg3205.INT_STATUS, 1)[0] & 1, 1)

    def test_pointer_counts_up(self):
        bus = world().i2c
        self.assertEqual(bus.writeto(0x68, bytes([mpu6050.SMPLRT_DIV, 4, 3, 8, 16])), 5)
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.SMPLRT_DIV, 4), bytes([4, 3, 8, 16]))
        bus.writeto(0x68, bytes([mpu6050.GYRO_CONFIG]))
        self.assertEqual(bus.readfrom(0x68, 2), bytes([8, 16]))

    def test_identification_and_data_are_read_only(self):
        bus = world().i2c
        bus.writeto_mem(0x68, mpu6050.WHO_AM_I, b"\x00")
        bus.writeto_mem(0x68, mpu6050.ACCEL_XOUT_H, b"\x55")
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.WHO_AM_I, 1), b"\x68")
        self.assertEqual(bus.readfrom_mem(0x68, mpu6050.ACCEL_XOUT_H, 1), b"\x00")

    def test_filter_makes_it_quieter(self):
        spread = []
        for dlpf in (1, 6):
            a_world, imu = running(accel_noise_mg=10.0)
            a_world.i2c.writeto_mem(0x68, mpu6050.CONFIG, bytes([dlpf]))
            out = array("h", [0] * 7)
            values = []
            for _ in range(300):
                a_world.clock.sleep_us(10000)
                imu.read_into(out)
                values.append(out[0])
            mean = sum(values) / len(values)
            spread.append((sum([(v - mean) ** 2 for v in values]) / len(values)) ** 0.5)
        self.assertAlmostEqual(spread[0] / spread[1], (184 / 5) ** 0.5, delta=1.0)

    def test_saturated_counts_stop_at_the_rail(self):
        a_world, imu = running(accel_bias_mg=[1500.0, -3000.0, 5000.0])
        out = array("h", [0] * 7)
        imu.read_into(out)
        self.assertEqual((out[1], out[2]), (-32768, 32767))
        a_world, imu = running("gy85", accel_bias_mg=[0, -30000.0, 30000.0])
        imu.read_into(out)
        self.assertEqual((out[1], out[2]), (-4096, 4095))

    def test_scan_and_bus_time(self):
        a_world = world("gy85", magnetometer="HMC5883L")
        self.assertEqual(a_world.i2c.scan(), [0x1E, 0x53, 0x68])
        before = a_world.clock.now_us()
        a_world.i2c.readfrom_mem(0x53, adxl345.DATAX0, 6)
        self.assertAlmostEqual(a_world.clock.now_us() - before, 9 * 22.5, delta=1)
        self.assertEqual(SimulatedI2C(a_world.clock, []).scan(), [])


class Time(unittest.TestCase):
    def test_wraps_like_a_board(self):
        clock = world().clock
        clock.advance_ns(((1 << 30) - 10) * 1000)
        before = clock.ticks_us()
        clock.sleep_us(50)
        after = clock.ticks_us()
        self.assertLess(after, before)
        self.assertEqual(clock.ticks_diff(after, before), 52)
        self.assertEqual(clock.ticks_diff(before, after), -52)


if __name__ == "__main__":
    unittest.main()
