"""What diagnose finds goes into the record, onto a board, and the drift is gone there."""

import json
from pathlib import Path

import numpy as np
import pytest

from sixflip.record import correction_record
from sixflip_host import cli, record_terms
from sixflip_host.board.board_files import board_files
from sixflip_host.board.local_link import LocalLink
from sixflip_host.capture import capture_file
from sixflip_host.diagnosis import diagnosis
from tests.worlds import drifting_part

NAMES = ["accel_thermal_bias", "gyro_thermal_bias", "g_sensitivity"]


@pytest.fixture(scope="module")
def drifting(tmp_path_factory):
    """(captures, record without terms) of the part."""
    folder = tmp_path_factory.mktemp("part")
    return (drifting_part.captures(folder, drifting_part.TERMS),
            drifting_part.calibrated(folder, drifting_part.TERMS))


@pytest.fixture(scope="module")
def corrected(drifting):
    """Path of the record with the terms."""
    paths, record = drifting
    output = record.replace("record_a", "terms")
    assert cli.main(["diagnose", *paths, "--record", record, "-o", output]) == 0
    return output


def test_the_record_holds_what_was_put_in(corrected, capsys):
    record = correction_record.decode(Path(corrected).read_bytes())
    found = record_terms.terms(record)
    assert list(found) == NAMES
    bias = found["accel_thermal_bias"]
    assert 2 in bias["axes"] and bias["k1"][2] == pytest.approx(-1.8, abs=0.06)
    # the sensor's z lies up to 1.5 degrees off the corrected axes
    assert np.abs(bias["k1"][:2]).max() < 0.1 and 0.0 < bias["sigma_k1"][2] < 0.1
    assert bias["low_c"] == pytest.approx(22.0, abs=0.8)
    assert bias["high_c"] == pytest.approx(31.0, abs=0.3)
    assert bias["origin"] == "sessions held out"
    assert bias["source"] == "session0.csv session1.csv"
    assert found["gyro_thermal_bias"]["k1"] == pytest.approx([0.0, 0.15, 0.0], abs=0.003)
    assert found["g_sensitivity"]["k"][0][1] == pytest.approx(0.1, abs=0.005)
    for fields in found.values():
        assert fields["floor"] < 1.3 * fields["after"] < 0.9 * fields["before"]
    capsys.readouterr()
    assert cli.main(["show", corrected]) == 0
    said = capsys.readouterr().out
    assert "drift with temperature, accelerometer: " in said and "z -1.7" in said
    assert "sensitivity to gravity, gyro" in said and "noise alone" in said


def test_the_gain_is_that_of_the_record_itself(drifting, corrected):
    """apply, the verb, takes away of a capture what the record says."""
    spread = {}
    for name in (drifting[1], corrected):
        output = name + ".csv"
        assert cli.main(["apply", name, drifting[0][0], "-o", output]) == 0
        capture = capture_file.read(drifting[0][0])
        with open(output) as file:
            rows = np.loadtxt(file, delimiter=",", skiprows=1)
        up = [rows[capture.pose == code, 3] for code in (1, 2)]
        late = np.concatenate([one[len(one) // 2:] for one in up]).mean()
        soon = np.concatenate([one[:len(one) // 2] for one in up]).mean()
        spread[name] = 1e3 * abs(late - soon) / drifting_part.G
    assert spread[drifting[1]] > 4.0 and spread[corrected] < 1.0


def streamed(monkeypatch, tmp_path, link, record, name):
    """Path of a corrected stream of a board with this record."""
    for module in ("sixflip_host.verbs.restore", "sixflip_host.verbs.stream"):
        monkeypatch.setattr(module + ".open_link", lambda port=None: link())
    assert cli.main(["restore", "--from", record]) == 0
    output = tmp_path / (name + ".csv")
    assert cli.main(["stream", "--hz", "100", "--seconds", "85", "-o", str(output)]) == 0
    return output


def flash(folder):
    for name, path in board_files().items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(path.read_bytes())
    (folder / "sixflip.json").write_text(json.dumps({"grace_ms": 100, "rest_s": 5}))
    return folder


def worst(errors):
    return np.abs(errors).max(axis=0)


def test_on_the_board_the_drift_is_gone(drifting, corrected, tmp_path, monkeypatch, capsys):
    folder = flash(tmp_path / "flash")
    world = drifting_part.used_in(drifting_part.TERMS)
    found = {}
    for name, record in (("without", drifting[1]), ("with", corrected)):
        found[name] = drifting_part.errors(streamed(
            monkeypatch, tmp_path, lambda: LocalLink(folder, world), record, name))
    (mg, dps), (less_mg, less_dps) = found["without"], found["with"]
    assert len(mg) == len(less_mg) > 40
    assert worst(mg)[2] > 9.0 and worst(less_mg)[2] < 1.5
    assert worst(dps)[1] > 0.8 and worst(less_dps)[1] < 0.03
    assert worst(dps)[0] > 0.08 and worst(less_dps)[0] < 0.03
    said = capsys.readouterr().out
    assert "restored: slot b, sequence 2, with " + ", ".join(NAMES) in said
    held = {one.name: record_terms.names_of(correction_record.decode(one.read_bytes()))
            for one in folder.glob("record_?.bin")}
    assert held == {"record_a.bin": [], "record_b.bin": NAMES}


def test_outside_of_what_was_measured_the_board_says_so_once(drifting, corrected, tmp_path,
                                                             monkeypatch, capsys):
    folder = flash(tmp_path / "flash")
    world = drifting_part.used_in(drifting_part.TERMS, temperature_c=45.0, warm_c=0.0)
    output = streamed(monkeypatch, tmp_path, lambda: LocalLink(folder, world), corrected, "hot")
    said = capsys.readouterr()
    assert (said.out + said.err).count("what the record's terms were measured at") == 1
    # at the edge, 31 of 45 °C, the correction has done 6 of 20 K
    assert drifting_part.errors(output)[0][:, 2].mean() == pytest.approx(-1.8 * 14, abs=1.5)


def diagnosed(drifting, folder, effects, capsys):
    """Exit code, JSON of `terms`, error and output of a diagnosis into a record."""
    output = folder / "terms.bin"
    code = cli.main(["diagnose", *drifting_part.captures(folder, effects), "--json", "--record",
                     drifting_part.calibrated(folder, effects), "-o", str(output)])
    said = capsys.readouterr()
    return code, json.loads(said.out)["terms"], said.err, output


def test_one_effect_makes_one_term(drifting, tmp_path, capsys):
    code, terms, _, output = diagnosed(
        drifting, tmp_path, [{"effect": "thermal_scale", "sensor": "accel", "x": 0.06}], capsys)
    assert code == 0 and terms["written"] == str(output)
    assert [term["term"] for term in terms["found"]] == ["accel_thermal_scale"]
    assert terms["found"][0]["value"] == {"x": pytest.approx(0.06, abs=0.01)}
    record = correction_record.decode(output.read_bytes())
    assert record_terms.names_of(record) == ["accel_thermal_scale"] and record.sequence == 2


def test_nothing_makes_no_record(drifting, tmp_path, capsys):
    code, terms, err, output = diagnosed(drifting, tmp_path, [], capsys)
    assert code == 1 and not output.exists()
    assert terms["found"] == [] and terms["written"] is None
    assert "nothing was found that a record can take out" in err and err.count("\n") == 1


def test_wrong_command_lines_and_another_parts_record(drifting, tmp_path, capsys, monkeypatch):
    """Each is said before a diagnosis begins, which would be minutes on a slow machine."""
    def begun(*words):
        raise AssertionError("the diagnosis began")
    monkeypatch.setattr(diagnosis, "Diagnosis", begun)
    paths, record = drifting
    for words in (["--record", record], ["-o", "x"],
                  ["--record", record, "-o", "x", "--sim", paths[0]]):
        assert cli.main(["diagnose", *paths, *words]) == 2
    other = correction_record.decode(Path(record).read_bytes())
    other.accel["P"][3][2] += 0.5
    path = tmp_path / "other.bin"
    path.write_bytes(correction_record.encode(other))
    capsys.readouterr()
    words = ["diagnose", paths[0], "--record", str(path), "-o", str(tmp_path / "o")]
    assert cli.main(words) == 1
    assert "it is the record of another part" in capsys.readouterr().err
    other.chip, other.who_am_i = "gy85", (0xE5, 0x68)
    other.accel_range_g, other.accel_lsb_per_g = 16, 256.0
    other.gyro_range_dps, other.gyro_lsb_per_dps = 2000, 14.375
    path.write_bytes(correction_record.encode(other))
    assert cli.main(words) == 4
    assert "the record is for a gy85" in capsys.readouterr().err
