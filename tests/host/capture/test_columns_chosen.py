"""Which columns are taken for a sensor where a table has several that would do, and what is said
of the others."""

import numpy as np
import pytest

from tests.worlds.imported_text import COUNTS, GYRO, SECONDS, G, imported, lines

FORCE = COUNTS / 16384
RATES = np.radians(GYRO / 16.4)
BESIDE = np.random.default_rng(2).normal(0.0, 0.3, (len(FORCE), 6))
SCALED = [sensor + axis for sensor in ("scaledAccel", "scaledGyro") for axis in "XYZ"]
ESTIMATED = [sensor + axis for sensor in ("estLinearAccel", "estAngularRate") for axis in "XYZ"]
MAPPED = [word for ours, name in zip(("ax", "ay", "az", "gx", "gy", "gz"), SCALED)
          for word in ("--map", "%s=%s" % (ours, name))]


def _log(names, *blocks):
    rows = ["%.2f,%s" % row for row in zip(SECONDS, lines(np.hstack(blocks), "%.9g"))]
    return "t,%s\n" % ",".join(names) + "\n".join(rows) + "\n"


def _has_the_forces(capture):
    accel = capture.accel / capture.meta["accel_lsb_per_g"]
    assert accel.mean(axis=0) == pytest.approx(FORCE.mean(axis=0), abs=1e-4)


@pytest.mark.parametrize("words", [(), MAPPED])
def test_a_filters_estimate_is_left_out_where_the_readings_stand_beside_it(
        tmp_path, capsys, words):
    """Gravity is in the one and not in the other, whichever comes first; and of columns that
    somebody named nothing is said that is not so."""
    capture, said = imported(tmp_path, capsys, _log(
        ESTIMATED + SCALED, BESIDE, FORCE, RATES), *words)
    _has_the_forces(capture)
    assert ("columns scaledAccelX scaledAccelY scaledAccelZ are taken, estLinearAccelX" in said) \
        != bool(words)
    assert "are left out" not in said or not words


def test_the_unit_of_columns_that_were_named_is_their_own(tmp_path, capsys):
    """That of the columns beside them was taken, by whose names the sensor is told."""
    names = ["acc_x [g]", "acc_y [g]", "acc_z [g]", "raw_x", "raw_y", "raw_z"]
    capture, said = imported(tmp_path, capsys, _log(names, BESIDE[:, :3] + [0, 0, 1.0],
                                                    FORCE * G), "--map",
                             "ax=raw_x,ay=raw_y,az=raw_z")
    _has_the_forces(capture)
    assert "the accelerometer is in m/s2" in said


def test_a_covariance_with_its_number_is_no_reading(tmp_path, capsys):
    """mavros' topics in a CSV: the axis stands before the sensor, and the covariances of linear
    acceleration were taken for the accelerometer."""
    names = ["%s_covariance%d" % (name, k) for name in ("linear_acceleration", "angular_velocity")
             for k in range(3)] + ["xla", "yla", "zla", "xav", "yav", "zav"]
    capture, _ = imported(tmp_path, capsys, _log(names, 9e-8 + 0 * BESIDE, FORCE * G, RATES))
    _has_the_forces(capture)
    gyro = capture.gyro / capture.meta["gyro_lsb_per_dps"]
    assert gyro.mean(axis=0) == pytest.approx((GYRO / 16.4).mean(axis=0), abs=1e-3)
