"""A person or a robot on legs that sways while it is taken for at rest: what turns is no drift."""
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import rest_gap
from sixflip_host.diagnosis.diagnosis import Settings
from sixflip_host.experiment import blocks

RATE, STANDS_S, STANDS = 50.0, 12.0, 5
T = np.arange(int(RATE * STANDS_S * STANDS)) / RATE


def smooth(rng, lasts_s):
    """(n,) of standard deviation 1, which goes one way for about so long."""
    x = gaussian_filter1d(rng.normal(size=len(T)), lasts_s * RATE)
    return x / x.std()


def stands(sways_deg=0.0, drifts=0.0, accel_mg=1.0, seed=3, lasts_s=1.7):
    """Session of something that stands still STANDS times: its attitude sways by so many degrees,
    its gyro drifts by so many deg/s without anything turning."""
    rng = np.random.default_rng(seed)
    angles = np.radians(sways_deg) * np.stack([smooth(rng, lasts_s) for _ in range(2)], 1)
    rates = np.degrees(np.gradient(angles, T, axis=0))
    noise = rng.normal(0.0, accel_mg, (len(T), 3))
    mg = 1000.0 * np.stack([-angles[:, 1], angles[:, 0], np.ones(len(T))], 1) + noise
    dps = np.column_stack([rates, np.zeros(len(T))]) + rng.normal(0.0, 0.03, (len(T), 3))
    dps += drifts * np.stack([smooth(rng, lasts_s) for _ in range(3)], 1)
    meta = {"sensor": "lsm6ds3", "rate_hz": RATE, "accel_lsb_per_g": 16384,
            "gyro_lsb_per_dps": 131, "temp_lsb_per_c": 16, "temp_offset_c": 25.0}
    poses = np.where(T % STANDS_S > STANDS_S - 0.5, 0, 1).astype(np.int16)
    return blocks.session_of("stands", Capture(
        meta, np.rint(T * 1e6).astype(np.int64), np.rint(mg * 16.384).astype(np.int16),
        np.rint(dps * 131.0).astype(np.int16), None, None, poses))


def gyro(session):
    return rest_gap.gaps_by_sensor([session], Settings())["gyro"]


@pytest.mark.parametrize("accel_mg", [1.0, 3.0])
def test_what_gravity_turns_by_as_well_is_no_drift_of_the_gyro(accel_mg):
    """A phone in the pocket of somebody who stood between two walks: "drift 0.03 deg/s"."""
    found = gyro(stands(sways_deg=0.05, accel_mg=accel_mg))
    assert not found.causes and not found.nameless and not found.places


@pytest.mark.parametrize("lasts_s", [1.7, 6.0])
def test_a_gyro_that_wanders_while_gravity_stays_drifts(lasts_s):
    found = gyro(stands(drifts=0.03, lasts_s=lasts_s))
    assert found.causes or found.places


def test_a_gyro_that_drifts_on_a_body_that_sways_drifts():
    found = gyro(stands(sways_deg=0.05, drifts=0.05))
    assert found.causes or found.places
