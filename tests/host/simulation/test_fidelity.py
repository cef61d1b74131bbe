"""The simulator against real recordings; without the recordings these tests are left out."""
import numpy as np
import pytest

from sixflip_host.capture import recordings as found
from sixflip_host.errors import BadFile
from sixflip_host.experiment import signal_measures as measures
from sixflip_host.simulation import fidelity, replica


@pytest.fixture(scope="module")
def rows(recordings):
    return {what: (real, twin) for what, _, real, twin in fidelity.all_rows(recordings)}


def test_noise_and_spectrum_within_a_tenth_or_two(rows):
    for what, (real, twin) in rows.items():
        if what.endswith("noise"):
            assert twin == pytest.approx(real, rel=0.05), what
        elif "spectrum" in what:
            assert twin == pytest.approx(real, rel=0.25), what
        elif "Allan at 0." in what:
            assert twin == pytest.approx(real, rel=0.35), what


def test_steps_are_those_of_the_recordings(rows):
    assert rows["suarez accel step"] == (4.0, 4.0)
    assert rows["tree accel step"] == (4.0, 4.0)
    assert rows["suarez gyro step"] == (1.0, 1.0)


def test_effects_seen_in_the_recordings_are_found_again(rows):
    assert rows["xsens misalignment"] == pytest.approx((3.44, 3.44), abs=0.1)
    real, twin = rows["xsens g-sensitivity, largest"]
    assert real == pytest.approx(0.155, abs=0.005) and twin == pytest.approx(real, rel=0.1)
    real, twin = rows["tree Z over temperature"]
    assert real == pytest.approx(-23.5, abs=1.5) and twin == pytest.approx(real, rel=0.1)
    real, twin = rows["tree chainsaw line"]
    assert 143 <= real <= 166 and 143 <= twin <= 166
    real, twin = rows["tree chain far, samples on a rail"]
    assert 0 < twin < 4 * real and real > 0


def test_the_picture_and_the_table(recordings, monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("SIXFLIP_DATA", str(recordings))
    assert fidelity.main(["--out", str(tmp_path / "out")]) == 0
    assert "ratio" in capsys.readouterr().out
    assert (tmp_path / "out" / "fidelity.png").stat().st_size > 10000


def test_missing_recordings_are_one_line(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("SIXFLIP_DATA", str(tmp_path))
    with pytest.raises(BadFile, match="set SIXFLIP_DATA"):
        found.folder()
    assert fidelity.main(["--out", str(tmp_path)]) == 4
    assert capsys.readouterr().err.count("\n") == 1


def test_measures_on_known_signals():
    draw = np.random.default_rng(1)
    x = draw.normal(size=(50000, 3)) * [1.0, 2.0, 4.0]
    assert measures.white(x) == pytest.approx([1, 2, 4], rel=0.03)
    assert measures.allan(x, 100) == pytest.approx([0.1, 0.2, 0.4], rel=0.1)
    assert measures.band(x, 100.0, 5, 50) == pytest.approx(
        np.array([1, 2, 4]) / np.sqrt(50), rel=0.05)
    t = np.arange(2000) / 333.0
    wave = 5.0 * np.sin(2 * np.pi * 151.3 * t + 0.7) + draw.normal(size=2000)
    frequency, amplitude, phase = measures.line(wave, 333.0)
    assert frequency == pytest.approx(151.3, abs=0.02)
    assert amplitude == pytest.approx(5.0, abs=0.15) and phase == pytest.approx(0.7, abs=0.3)
    assert measures.step(np.array([[4, 3], [8, 6], [-12, 7]])).tolist() == [4, 1]
    assert measures.railed(np.array([[32767], [-32768], [0], [5]])).tolist() == [0.5]


def test_a_replica_is_fitted_to_what_it_was_made_from():
    draw = np.random.default_rng(2)
    counts = np.rint(draw.normal(size=(6000, 3)) * 50 / 4) * 4 + [16000, -400, 800]
    again = replica.accel_at_rest(counts, 16384.0, 100.0, 6000)
    assert again.mean(axis=0) == pytest.approx(counts.mean(axis=0), abs=3)
    assert again.std(axis=0) == pytest.approx([50] * 3, rel=0.05)
    assert (again % 4 == 0).all()
