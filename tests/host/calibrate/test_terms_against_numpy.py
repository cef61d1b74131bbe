"""The shared code of a record's terms against another formulation in numpy, matrix by matrix."""

import numpy as np
import pytest

from sixflip.record.correction import correction_of
from sixflip.record.mounting import compensation
from sixflip_host import record_terms
from sixflip_host.capture.capture_file import Capture
from sixflip_host.export.corrected_rows import corrected_rows
from tests.worlds.written_records import TERMS, with_terms

T0, LOW, HIGH = 28.0, 15.0, 40.0


def by_matrices(record, names, accel, gyro, temp, rest=None):
    """(n, 6) m/s² and rad/s: every sample with matrices of its own, counts in columns."""
    celsius = temp / 340.0 + 36.53
    d = np.clip(celsius, LOW, HIGH) - T0

    def curve(name, at):
        if name not in names:
            return np.zeros((len(np.atleast_1d(at)), 3))
        k = TERMS[name]
        powers = np.stack([np.atleast_1d(at), np.atleast_1d(at) ** 2], 1)
        return powers @ np.array([k["k1"], k.get("k2", [0.0] * 3)])

    then = np.clip(record.temp_c, LOW, HIGH) - T0
    P, W = np.array(record.accel["P"])[:, :3], np.array(record.gyro["P"])
    y = np.hstack([accel / record.accel_lsb_per_g * record.g, np.ones((len(accel), 1))]) @ P
    y = y - (curve("accel_thermal_bias", d) - curve("accel_thermal_bias", then)) * record.g / 1e3
    stretch = curve("accel_thermal_scale", d) - curve("accel_thermal_scale", then)
    force = np.einsum("nij,nj->ni", np.linalg.inv(
        np.eye(3) + np.einsum("ni,ij->nij", stretch / 100.0, np.eye(3))), y)
    K = np.array(TERMS["g_sensitivity"]["k"]) * ("g_sensitivity" in names)
    from_bias = record.gyro_bias["temp_c"]
    from_bias = then if from_bias is None else np.clip(from_bias, LOW, HIGH) - T0
    bias, felt = np.array(record.gyro_bias["bias_dps"]), np.zeros(3)
    if rest is not None:
        bias, felt, from_bias = rest
        from_bias = np.clip(from_bias, LOW, HIGH) - T0
    read = gyro / record.gyro_lsb_per_dps - bias - (force - felt) / record.g @ K.T - (
        curve("gyro_thermal_bias", d) - curve("gyro_thermal_bias", from_bias))
    stretch = curve("gyro_thermal_scale", d) - curve("gyro_thermal_scale", then)
    rate = np.radians(read @ W[:3]) / (1.0 + stretch / 100.0)
    turn = np.array(compensation(record.mounting))
    return np.hstack([force @ turn.T, rate @ turn.T]), force


def samples(n=400):
    rng = np.random.default_rng(11)
    counts = rng.integers(-32768, 32768, (n, 6)).astype(np.int16)
    return counts[:, :3], counts[:, 3:], rng.integers(-9000, 3000, n).astype(np.int16)


@pytest.mark.parametrize("names", [(name,) for name in TERMS] + [tuple(TERMS)],
                         ids=lambda names: "+".join(names) if len(names) == 1 else "all")
@pytest.mark.parametrize("rested", [False, True])
def test_sample_by_sample(tmp_path, names, rested):
    _, record = with_terms(tmp_path / "r.bin", names)
    accel, gyro, temp = samples()
    correction, rest = correction_of(record), None
    if rested:
        means = [100.0, -4000.0, 7000.0, 30.0, -20.0, 10.0, (33.0 - 36.53) * 340.0]
        correction.set_rest(means)
        _, felt = by_matrices(record, names, np.array([means[:3]]), np.array([means[3:6]]),
                              np.array([means[6]]))
        rest = np.array(means[3:6]) / record.gyro_lsb_per_dps, felt[0], 33.0
    expected, _ = by_matrices(record, names, accel, gyro, temp, rest)
    rows = np.column_stack([accel, gyro, temp]).tolist()
    found = np.array([correction.apply(row, [0.0] * 6) for row in rows])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)
    capture = Capture({}, np.arange(len(temp)), accel, gyro, temp, None, None)
    np.testing.assert_allclose(corrected_rows(correction, capture), expected, rtol=0, atol=1e-10)
    assert record_terms.names_of(record) == list(names)
