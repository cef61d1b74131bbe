"""Counts per unit that are, and are not, those of a chip."""

import pytest

from sixflip_host.capture import chip_scales


@pytest.mark.parametrize("stated", [
    ("gy85", 16, 256, 2000, 14.375), ("adxl345", 2, 256, 0, 0), ("adxl345", 16, 32, 0, 0),
    ("adxl345", None, 250, None, None), ("mpu6050", 16, 2048, 2000, 16.4),
    ("lsm6dsox", 4, 8197, 2000, 14.286), ("qmi8658", 2, 16384, 512, 64.0),
    ("mpu6050", None, 16384, None, 131), ("other", 3, 1000, 300, 7.0)])
def test_counts_of_a_chip(stated):
    assert chip_scales.wrong(*stated) is None


@pytest.mark.parametrize("stated,found,expected", [
    (("mpu6050", 16, 16384, 500, 65.5), "16384 counts per g at ±16 g", "2048"),
    (("mpu6050", 2, 16384, 500, 62.5), "62.5 counts per deg/s", "65.5"),
    (("lsm6dsox", 4, 16393, 500, 57.143), "16393 counts per g at ±4 g", "8197"),
    (("adxl345", None, 16384, None, None), "an adxl345 with 16384 counts per g", "256"),
    (("gy85", 16, 256, 2000, 16.4), "16.4 counts per deg/s", "14.375")])
def test_counts_of_another_chip(stated, found, expected):
    said = chip_scales.wrong(*stated)
    assert found in said[0] and said[1] == expected
