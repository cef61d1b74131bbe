"""The chips behind the emulated I2C peripheral, asked as the Pico's own driver asks them."""

import pytest

pytest.importorskip("rp2040py")
from i2c_driver import EIO, ETIMEDOUT, Driver  # noqa: E402
from rp2040py.rp2040 import RP2040  # noqa: E402

from sixflip.chips import adxl345, itg3205, mpu6050  # noqa: E402
from sixflip_host.emulated.i2c_device import SCL, SDA, ChipsOnI2C  # noqa: E402
from sixflip_sim import worlds  # noqa: E402

MPU, ADXL = 0x68, 0x53
PULLED_DOWN = 1 << 6 | 1 << 2  # IE and PDE of a pad, RP2040 datasheet 2.19.6.3


def bench(**spec):
    """(driver, chips) of a world; the box lies still."""
    mcu = RP2040()
    chips = ChipsOnI2C(worlds.make(dict({"order": []}, **spec)))
    chips.attach(mcu)
    return Driver(mcu), chips


def failure(driver, *arguments):
    with pytest.raises(OSError) as caught:
        driver.read_mem(*arguments)
    return caught.value.errno


def test_one_bus_dispatches_to_every_chip_of_a_gy85():
    driver, _ = bench(sensor="gy85", magnetometer="HMC5883L")
    assert driver.read_mem(ADXL, adxl345.DEVID, 1) == bytes([adxl345.DEVICE_ID])
    assert driver.read_mem(MPU, itg3205.WHO_AM_I, 1) == bytes([itg3205.ID])
    assert driver.read_mem(0x1E, 10, 3) == b"H43"


def test_nobody_at_the_address_is_eio_at_once():
    driver, chips = bench()
    before = driver.mcu.clock.nanos
    assert failure(driver, ADXL, 0, 1) == EIO
    assert driver.mcu.clock.nanos - before < 1e6  # the driver's time-out is 50 ms
    assert chips.refused == 1
    assert driver.read_mem(MPU, mpu6050.WHO_AM_I, 1) == b"\x68"


def test_data_that_is_not_acknowledged_is_not_written():
    driver, _ = bench(faults=[{"kind": "data_nak", "at": 0}])
    assert driver.write_mem(MPU, mpu6050.PWR_MGMT_1, b"\x01") == 1  # of two bytes
    assert driver.read_mem(MPU, mpu6050.PWR_MGMT_1, 1) == b"\x40"
    assert driver.write_mem(MPU, mpu6050.PWR_MGMT_1, b"\x01") == 2
    assert driver.read_mem(MPU, mpu6050.PWR_MGMT_1, 1) == b"\x01"


def awake(driver):
    driver.write_mem(MPU, mpu6050.PWR_MGMT_1, b"\x01")
    driver.write_mem(MPU, mpu6050.CONFIG, b"\x03")


def test_registers_count_up_in_a_write():
    driver, chips = bench()
    assert driver.write_mem(MPU, mpu6050.GYRO_CONFIG, b"\x08\x10") == 3
    assert bytes(chips.world.chips[0].registers[mpu6050.GYRO_CONFIG:][:2]) == b"\x08\x10"


def test_a_burst_is_of_one_sample_however_long_the_driver_takes():
    driver, chips = bench()
    awake(driver)
    driver.ns_a_poll = 700000  # so slowly that new samples come between the bytes
    slow = driver.read_mem(MPU, mpu6050.ACCEL_XOUT_H, 14)
    assert slow == bytes(chips.world.chips[0].registers[mpu6050.ACCEL_XOUT_H:][:14])
    assert slow[:2] != b"\0\0"
    assert driver.read_mem(MPU, mpu6050.ACCEL_XOUT_H, 14) != slow


def test_the_world_goes_by_emulated_time():
    driver, chips = bench()
    awake(driver)
    driver.wait_us(2000000)
    driver.read_mem(MPU, mpu6050.WHO_AM_I, 1)
    assert 2000000 <= chips.world.clock.now_us() <= chips.now_us() < 2001000


def test_a_clock_held_for_too_long_is_a_timeout_and_then_over():
    driver, _ = bench(faults=[{"kind": "timeout", "at": 1}])
    assert failure(driver, MPU, mpu6050.WHO_AM_I, 1) == ETIMEDOUT
    driver.wait_us(10000)
    assert driver.read_mem(MPU, mpu6050.WHO_AM_I, 1) == b"\x68"


def pulse(driver, count):
    """By hand, open drain: SCL driven low and let go of."""
    pin = driver.mcu.gpio[SCL]
    pin.ctrl = 5  # SIO
    for _ in range(count):
        for driven in (1 << SCL, 0):
            driver.mcu.sio.gpio_output_enable = driven
            pin.check_for_updates()


def test_a_stuck_line_comes_free_after_the_pulses_it_needs():
    driver, _ = bench(faults=[{"kind": "stuck_sda", "at": 0, "pulses": 9}])
    for _ in range(2):
        assert failure(driver, MPU, mpu6050.WHO_AM_I, 1) == ETIMEDOUT
    pulse(driver, 8)
    assert failure(driver, MPU, mpu6050.WHO_AM_I, 1) == ETIMEDOUT
    pulse(driver, 1)
    driver.init()
    assert driver.read_mem(MPU, mpu6050.WHO_AM_I, 1) == b"\x68"


def levels(driver):
    """SDA and SCL as the pins read them against their own pull-downs."""
    for line in (SDA, SCL):
        driver.mcu.gpio[line].pad_value = PULLED_DOWN
    return [driver.mcu.gpio[line].input_value for line in (SDA, SCL)]


def test_the_modules_resistors_pull_both_lines_up_unless_a_chip_holds_one():
    driver, _ = bench(faults=[{"kind": "stuck_sda", "at": 0, "pulses": 9}])
    assert levels(driver) == [True, True]
    assert failure(driver, MPU, mpu6050.WHO_AM_I, 1) == ETIMEDOUT
    assert levels(driver) == [False, True]
    pulse(driver, 9)
    assert levels(driver) == [True, True]


def test_power_up_begins_the_world_anew():
    driver, chips = bench()
    awake(driver)
    driver.wait_us(500000)
    chips.power_up(worlds.make({"order": []}))
    assert driver.read_mem(MPU, mpu6050.PWR_MGMT_1, 1) == b"\x40"
    assert chips.now_us() < 1000


def test_a_wrong_identification_is_read_once():
    driver, _ = bench(faults=[{"kind": "wrong_id", "at": 0, "value": 0x13}])
    assert driver.read_mem(MPU, mpu6050.WHO_AM_I, 1) == b"\x13"
    assert driver.read_mem(MPU, mpu6050.WHO_AM_I, 1) == b"\x68"
