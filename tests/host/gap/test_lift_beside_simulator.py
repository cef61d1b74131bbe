"""`sixflip diagnose --sim` of a thing that drives up and down and does not turn: its gyro reads
noise, and tells neither the time of one log by the other nor how the sensor sits."""
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import comparison

RATE, SECONDS = 100.0, 80.0


def driven(seed=1, late_s=0.0):
    """(n,) mg up of a lift that starts and stops every nine seconds, softly, 0.9 m/s2."""
    t = np.arange(0.0, SECONDS, 1.0 / RATE) + late_s
    rng, up = np.random.default_rng(seed), np.zeros(len(t))
    for k in range(int(SECONDS // 18)):
        size, at = rng.uniform(70.0, 110.0) * (-1.0) ** k, 18.0 * k + 3.0
        for sign, begin in ((1.0, at), (-1.0, at + 8.0)):
            u = (t - begin) / 2.4
            up += sign * size * np.clip(4.0 * np.minimum(u, 1.0 - u), 0.0, 1.0)
    return up


def log(up, seed, mount=(0.0, 0.0), bias_mg=(0.0, 0.0, 0.0), noise_mg=2.0):
    """Capture of a sensor that leans by mount, degrees about x and y."""
    rng = np.random.default_rng(seed)
    body = Rotation.from_euler("xy", mount, degrees=True).inv().apply(
        np.outer(1000.0 + up, [0.0, 0.0, 1.0]))
    accel = body + bias_mg + rng.normal(0.0, noise_mg, body.shape)
    gyro = rng.normal(0.0, 0.05, body.shape) + [0.4, -0.3, 0.2]
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 8192.0,
            "gyro_lsb_per_dps": 65.5}
    return Capture(meta, np.rint(np.arange(len(up)) * 1e6 / RATE).astype(np.int64),
                   np.rint(8.192 * accel).astype(np.int16), np.rint(65.5 * gyro).astype(np.int16))


def compared(real, sim):
    return comparison.compare([("real", real)], "sim", sim)


def accel(found):
    return {(p.name, p.axis): p.difference for p in found.differs if p.sensor == "accel"}


def test_a_lift_s_logs_lie_by_their_forces():
    found = compared(log(driven(), 1), log(driven(late_s=1.3), 2))
    assert found.alignment.same and found.alignment.offset_s == pytest.approx(1.3, abs=0.01)
    assert "correlation of the forces" in found.remarks[0]
    assert not found.conventions and not accel(found)
    assert any("nothing turns" in said for said in found.unseen)


def test_a_mount_that_leans_in_the_real_lift_alone_is_told_from_a_bias():
    """Forces of -95 and -78 mg where the simulator had 8 and -7 were "no gap": they were held
    against rests that lie alike, by which no difference below 190 mg could have been seen."""
    found = compared(log(driven(), 1, mount=(-4.5, 5.5)), log(driven(late_s=1.3), 2))
    assert found.alignment.same and not found.conventions
    leans = accel(found)
    assert leans["misalignment", "xz"] == pytest.approx(-5.5, abs=0.3)
    assert leans["misalignment", "yz"] == pytest.approx(-4.5, abs=0.3)
    assert not any(name == "bias" for name, _ in leans)
    before, after, noise = found.gap["accel"]
    assert before > 50.0 and after < 1.5 * noise


def test_a_bias_of_the_axis_along_the_drive_is_no_time_step():
    found = compared(log(driven(), 1, bias_mg=(0.0, 0.0, -25.0), mount=(1.0, -2.0)),
                     log(driven(late_s=1.3), 2, mount=(1.0, -2.0)))
    assert not found.conventions
    assert accel(found) == {("bias", "z"): pytest.approx(-25.0, abs=1.0)}


@pytest.mark.long
def test_logs_of_other_drives_that_read_otherwise_at_rest_do_not_tell_and_say_so():
    said = diagnose([("real", log(driven(), 1, mount=(-4.5, 5.5)))],
                    [("sim", log(driven(seed=5, late_s=4.7), 2))])
    found, = said.comparisons
    assert not found.alignment.same and said.verdict == "cannot tell"
    assert found.otherwise and any("a bias or how they lie" in unseen for unseen in found.unseen)


def test_logs_of_other_drives_that_read_alike_at_rest_do_not_differ_there():
    found = compared(log(driven(), 1), log(driven(seed=5, late_s=4.7), 2))
    assert not found.alignment.same and not found.otherwise


def test_an_axis_that_reads_one_value_tells_nothing_across_the_drive():
    """A singular matrix, where the line of the forces has exactly nothing of an axis."""
    real, sim = log(driven(), 1), log(driven(), 2)
    real.accel[:, :2] = 0
    found = compared(real, sim)
    assert found.alignment.same
