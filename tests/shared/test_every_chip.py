"""What every driver must do, against its simulated twin; a chip of the catalogue is in it at
once, without a line here."""

import unittest
from array import array

from sixflip.chips import catalogue, probe
from sixflip.poses.still_window import StillWindow
from sixflip_sim import worlds

try:
    from micropython import heap_lock, heap_unlock
except ImportError:
    def heap_lock():
        pass

    def heap_unlock():
        pass

ALL = catalogue.SENSORS
SINGLE = [name for name in ALL if name != "gy85"]       # one chip, one burst
SIX_AXIS = [name for name in SINGLE if name != "adxl345"]


def world(sensor, **more):
    """A world at rest, noiseless and without errors."""
    spec = {"sensor": sensor, "order": [], "ideal": True, "accel_noise_mg": 0,
            "gyro_noise_dps": 0}
    spec.update(more)
    return worlds.make(spec)


def running(sensor, rate_hz=100, ranges=(None, None), **more):
    """(world, imu) set up for a rate."""
    a_world = world(sensor, **more)
    imu = probe.find(a_world.i2c, a_world.clock.sleep_ms, sensor, ranges)[0]
    imu.configure(rate_hz)
    return a_world, imu


def sample_of(a_world, imu, wait_ms=200):
    a_world.clock.sleep_ms(wait_ms)
    sample = array("h", [0] * 7)
    assert imu.read_into(sample)
    return list(sample)


class Identification(unittest.TestCase):
    def test_found_by_itself_and_by_name(self):
        for sensor in ALL:
            for wanted in ("auto", sensor):
                a_world = world(sensor)
                imu, report = probe.find(a_world.i2c, sensor=wanted)
                self.assertEqual((imu.sensor, report[0][:2]), (sensor, "0x"))

    def test_every_address(self):
        for sensor in SINGLE:
            for address in catalogue.row_of(sensor)[2]:
                self.assertEqual(probe.find(world(sensor, address=address).i2c)[0].address,
                                 address)

    def test_every_id_has_its_name_in_the_record(self):
        for sensor in SIX_AXIS:
            for who_am_i, name in catalogue.ids_of(sensor).items():
                imu = probe.find(world(sensor, who_am_i=who_am_i).i2c)[0]
                self.assertEqual(imu.name, "%s (0x%02x)" % (name, who_am_i))
                self.assertEqual(imu.who_am_i, (who_am_i, who_am_i))

    def test_an_unknown_id_is_named_in_hex_with_the_nearest_that_is_known(self):
        for sensor in SIX_AXIS:
            ids = catalogue.ids_of(sensor)
            known = min(ids)
            strange = [known ^ bit for bit in (1, 2, 4, 8, 16, 32, 64, 128)
                       if not taken(sensor, known ^ bit)][0]
            with self.assertRaises(probe.NoChip) as caught:
                probe.find(world(sensor, who_am_i=strange).i2c)
            said = str(caught.exception)
            self.assertIn("0x%02x in register 0x%02x" % (strange,
                                                         catalogue.row_of(sensor)[3]), said)
            self.assertIn("the nearest is", said)
            self.assertIn("1 bit away", said)

    def test_a_clone_with_another_id_is_used_where_the_settings_name_the_sensor(self):
        for sensor in SIX_AXIS:
            strange = [i for i in (0x33, 0x55) if not taken(sensor, i)][0]
            a_world = world(sensor, who_am_i=strange)
            imu, report = probe.find(a_world.i2c, a_world.clock.sleep_ms, sensor)
            self.assertEqual(imu.who_am_i[0], strange)
            self.assertIn("clone", imu.name)
            self.assertIn("taken for a clone", " ".join(report))
            imu.configure(100)
            self.assertEqual(sample_of(a_world, imu)[2], round(imu.accel_lsb_per_g))

    def test_a_record_holds_the_name(self):
        for sensor in ALL:
            self.assertTrue(len(sensor) <= 16)


def taken(sensor, who_am_i):
    """Whether an answer is that of a known chip, at the sensor's own register."""
    register = catalogue.row_of(sensor)[3]
    return who_am_i in (0, 255) or any(who_am_i & row[6] in row[4] for row in catalogue.CHIPS
                                       if row[3] == register)


class Readings(unittest.TestCase):
    def test_one_g_up_and_the_temperature(self):
        for sensor in ALL:
            a_world, imu = running(sensor, temperature_c=31.0)
            sample = sample_of(a_world, imu)
            self.assertEqual(sample[:6], [0, 0, round(imu.accel_lsb_per_g), 0, 0, 0])
            if imu.has_temp:
                celsius = sample[6] / imu.temp_lsb_per_c + imu.temp_offset_c
                self.assertAlmostEqual(celsius, 31.0, delta=0.1)
                data = imu.metadata()
                self.assertEqual((data["temp_lsb_per_c"], data["temp_offset_c"]),
                                 (imu.temp_lsb_per_c, imu.temp_offset_c))

    def test_every_axis_in_its_column_with_its_sign(self):
        """A burst in the wrong order, or its bytes the wrong way round, shows here."""
        for sensor in SIX_AXIS:
            a_world, imu = running(sensor, accel_bias_mg=[100, -200, 300],
                                   gyro_bias_dps=[10, -20, 30])
            found = sample_of(a_world, imu)
            g, dps = imu.accel_lsb_per_g, imu.gyro_lsb_per_dps
            for value, expected in zip(found, (0.1 * g, -0.2 * g, 1.3 * g, 10 * dps, -20 * dps,
                                               30 * dps)):
                self.assertAlmostEqual(value, expected, delta=1)

    def test_every_range(self):
        for sensor in SIX_AXIS:
            driver = catalogue.driver(sensor)
            for full_scale, lsb, _ in driver.ACCEL_RANGES:
                a_world, imu = running(sensor, ranges=(full_scale, None))
                self.assertEqual((imu.accel_range_g, imu.accel_lsb_per_g), (full_scale, lsb))
                self.assertEqual(sample_of(a_world, imu)[2], round(lsb))
            for full_scale, lsb, _ in driver.GYRO_RANGES:
                a_world, imu = running(sensor, ranges=(None, full_scale),
                                       gyro_bias_dps=[0, 0, full_scale / 2])
                self.assertEqual((imu.gyro_range_dps, imu.gyro_lsb_per_dps), (full_scale, lsb))
                self.assertAlmostEqual(sample_of(a_world, imu)[5], full_scale / 2 * lsb, delta=1)

    def test_full_scale_times_counts_is_the_same_in_every_range(self):
        for sensor in SIX_AXIS:
            driver = catalogue.driver(sensor)
            for ranges in (driver.ACCEL_RANGES, driver.GYRO_RANGES):
                for full_scale, lsb, _ in ranges:
                    self.assertTrue(28000 < full_scale * lsb < 32850)
                    self.assertAlmostEqual(full_scale * lsb / (ranges[0][0] * ranges[0][1]), 1.0,
                                           delta=2e-3)

    def test_a_range_the_chip_has_not_got_is_the_next_larger_and_said(self):
        for sensor in SIX_AXIS:
            scales = sorted([row[0] for row in catalogue.driver(sensor).ACCEL_RANGES])
            a_world = world(sensor)
            imu, report = probe.find(a_world.i2c, sensor=sensor, ranges=(scales[0] + 0.5, 99999))
            self.assertEqual(imu.accel_range_g, scales[1])
            self.assertIn("%s is used" % scales[1], " ".join(report))
            self.assertEqual(imu.gyro_range_dps,
                             max([row[0] for row in catalogue.driver(sensor).GYRO_RANGES]))

    def test_rates(self):
        for sensor in ALL:
            for rate in (10, 25, 50, 100, 200, 400, 500):
                if rate > catalogue.driver(sensor).MOST_HZ:
                    continue
                a_world, imu = running(sensor, rate)
                data = imu.metadata()
                self.assertTrue(data["output_rate_hz"] >= 2 * rate)
                self.assertTrue(sensor not in SIX_AXIS
                                or rate / 25 <= data["filter_hz"] <= rate)
                rows = []
                for _ in range(20):
                    a_world.clock.sleep_us(1000000 // rate)
                    rows.append(array("h", [0] * 7))
                    self.assertTrue(imu.read_into(rows[-1]))
            for rate in (0, 501):
                with self.assertRaises(ValueError):
                    running(sensor, rate)

    def test_no_sample_is_seen_twice(self):
        for sensor in ALL:
            a_world, imu = running(sensor, 100, accel_noise_mg=None, gyro_noise_dps=None)
            rows = []
            for _ in range(60):
                a_world.clock.sleep_us(10000)
                sample = array("h", [0] * 7)
                imu.read_into(sample)
                rows.append(list(sample))
            self.assertEqual([i for i in range(1, 60) if rows[i] == rows[i - 1]], [])

    def test_nothing_allocated_while_sampling(self):
        for sensor in ALL:
            a_world, imu = running(sensor)
            bus = Locked(a_world.i2c)
            imu.answers(bus)
            sample = array("h", [0] * 7)
            bus.learn(imu, sample)
            good = True
            heap_lock()
            try:
                for _ in range(20):
                    good = imu.read_into(sample) and imu.awake() and good
            finally:
                heap_unlock()
            self.assertTrue(good)

    def test_noise_stays_below_what_passes_for_a_sensors_at_every_rate(self):
        """noise_floor.CAP: beyond 30 mg and 1 deg/s nobody takes it for noise."""
        for sensor in SIX_AXIS:
            for rate in (50, catalogue.driver(sensor).MOST_HZ):
                widest = [max([row[0] for row in ranges]) for ranges in
                          (catalogue.driver(sensor).ACCEL_RANGES,
                           catalogue.driver(sensor).GYRO_RANGES)]
                a_world, imu = running(sensor, rate, widest, accel_noise_mg=None,
                                       gyro_noise_dps=None)
                window = StillWindow(40, imu.accel_rail, imu.gyro_rail, 1000000 // rate)
                sample = array("h", [0] * 7)
                for _ in range(40):
                    a_world.clock.sleep_us(1000000 // rate)
                    imu.read_into(sample)
                    window.add(1000000 // rate, sample)
                for axis in range(6):
                    lsb = imu.gyro_lsb_per_dps if axis > 2 else imu.accel_lsb_per_g / 1000
                    noise = window.variance(axis) ** 0.5 / lsb
                    self.assertTrue(noise < (15.0, 0.5)[axis // 3])


class Locked:
    """A bus whose answers are made beforehand: nothing behind it allocates."""

    def __init__(self, bus):
        self.bus = bus
        self.known = {}
        self.learning = True

    def readfrom_mem_into(self, address, register, buf):
        if self.learning:
            self.bus.readfrom_mem_into(address, register, buf)
            self.known.setdefault((address, register, len(buf)), []).append(bytes(buf))
            return
        self.at += 1
        data = self.order[self.at % len(self.order)]
        for i in range(len(buf)):
            buf[i] = data[i]

    def readfrom_mem(self, address, register, n):
        return self.bus.readfrom_mem(address, register, n)

    def writeto_mem(self, address, register, data):
        if self.learning:
            self.bus.writeto_mem(address, register, data)

    def learn(self, imu, sample):
        """One turn of the loop, to be played over and over."""
        order = []
        live = self.bus

        class Noting:
            def readfrom_mem_into(self, address, register, buf):
                live.readfrom_mem_into(address, register, buf)
                order.append(bytes(buf))

            def writeto_mem(self, address, register, data):
                live.writeto_mem(address, register, data)

            readfrom_mem = live.readfrom_mem

        imu.answers(Noting())
        order[:] = []
        imu.read_into(sample)
        imu.awake()
        imu.answers(live)
        imu.answers(self)
        self.order = order
        self.at = -1
        self.learning = False


class Registers(unittest.TestCase):
    def test_asleep_after_power_up(self):
        for sensor in SIX_AXIS:
            a_world = world(sensor)
            imu = probe.find(a_world.i2c, sensor=sensor)[0]
            a_world.clock.sleep_ms(500)
            self.assertFalse(imu.read_into(array("h", [0] * 7)))

    def test_reset_and_sleep_are_noticed_and_mended(self):
        for sensor in ALL:
            for kind in ("reset", "sleep"):
                a_world, imu = running(sensor)
                sample_of(a_world, imu)
                self.assertTrue(imu.awake())
                a_world.i2c.faults.add({"kind": kind, "at": 0, "address": imu.address})
                a_world.clock.sleep_ms(20)
                imu.read_into(array("h", [0] * 7))
                self.assertFalse(imu.awake())
                imu.configure(100)
                self.assertTrue(imu.awake())
                sample_of(a_world, imu)

    def test_data_ready(self):
        for sensor in SIX_AXIS:
            a_world, imu = running(sensor)
            register, bits = imu.READY
            a_world.clock.sleep_ms(50)
            self.assertEqual(read(a_world, imu, register) & bits, bits)
            sample_of(a_world, imu, 0)
            read(a_world, imu, register)
            self.assertEqual(read(a_world, imu, register) & bits, 0)
            a_world.clock.sleep_ms(20)
            self.assertEqual(read(a_world, imu, register) & bits, bits)

    def test_lost_writes_are_mended_or_an_error(self):
        for sensor in ALL:
            a_world = world(sensor, flavour="soft", faults=[{"kind": "data_nak", "at": 6}])
            imu = probe.find(a_world.i2c, sensor=sensor)[0]
            imu.configure(100)
            self.assertTrue(imu.awake())
            a_world = world(sensor, flavour="soft")
            imu = probe.find(a_world.i2c, sensor=sensor)[0]
            a_world.i2c.faults.add({"kind": "data_nak", "every": 1})
            with self.assertRaises(OSError) as caught:
                imu.configure(100)
            self.assertIn("expected", str(caught.exception))

    def test_a_reset_that_never_ends_is_an_error(self):
        class Stuck:
            def readfrom_mem_into(self, address, register, buf):
                for i in range(len(buf)):
                    buf[i] = 0xFF if self.on else 0x00

            def writeto_mem(self, address, register, data):
                pass

        for sensor in SIX_AXIS:
            caught = 0
            for on in (True, False):
                bus = Stuck()
                bus.on = on
                imu = catalogue.driver(sensor)(bus, 0x68, min(catalogue.ids_of(sensor)))
                try:
                    imu.configure(100)
                except OSError:
                    caught += 1
            self.assertEqual(caught, 2)

    def test_what_somebody_else_left_in_the_registers_does_not_matter(self):
        """Another program's bank, byte order or address mode: probe and driver clear them."""
        for sensor in SIX_AXIS:
            for register, value in worlds.simulated(sensor).TRAPS:
                a_world = world(sensor)
                a_world.i2c.writeto_mem(a_world.chips[0].address, register, values_of(value))
                imu = probe.find(a_world.i2c, a_world.clock.sleep_ms)[0]
                self.assertEqual(imu.sensor, sensor)
                imu.configure(100)
                self.assertEqual(sample_of(a_world, imu)[2], round(imu.accel_lsb_per_g))

    def test_a_trap_in_mid_session_is_noticed(self):
        for sensor in SIX_AXIS:
            for register, value in worlds.simulated(sensor).TRAPS:
                a_world, imu = running(sensor)
                sample_of(a_world, imu)
                a_world.i2c.writeto_mem(imu.address, register, values_of(value))
                noticed = not imu.awake()
                if noticed:
                    imu.configure(100)
                self.assertEqual(sample_of(a_world, imu)[2], round(imu.accel_lsb_per_g))


def values_of(trap):
    return bytes(trap if isinstance(trap, tuple) else (trap,))


def read(a_world, imu, register):
    return a_world.i2c.readfrom_mem(imu.address, register, 1)[0]


if __name__ == "__main__":
    unittest.main()
