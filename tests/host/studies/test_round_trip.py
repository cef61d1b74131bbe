"""The effect put back: a diagnosis is exported, the simulator runs through it, and is diagnosed
again against the same real log."""
import json

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="the zoo needs MuJoCo: pip install 'sixflip[test]'")

from sixflip_host import cli  # noqa: E402
from sixflip_host.capture import capture_file  # noqa: E402
from sixflip_host.diagnosis import answer as as_json  # noqa: E402
from sixflip_host.diagnosis.diagnose import diagnose  # noqa: E402
from tests.studies.zoo import defects, engine  # noqa: E402

G = 9.80665


@pytest.fixture(scope="module")
def box():
    return engine.box(4, "arm", quick=True)


def answered(real, sim):
    return as_json.as_dict(diagnose([("real.csv", real)], [("sim.csv", sim)]))


def captures(name, motion, **more):
    return [capture_file.parse("log", text.encode())
            for text in defects.pair(name, motion, motion, 8, **more)]


def exported(answer, target, folder):
    file = folder / "gap.json"
    file.write_text(json.dumps(answer), encoding="utf-8")
    out = folder / ("put_back." + target)
    assert cli.main(["export", str(file), "--to", target, "-o", str(out)]) == 0
    return out.read_text(encoding="utf-8")


def through(model, capture):
    """The capture as the ImuModel reads it."""
    lsb = capture.meta["accel_lsb_per_g"] / G, capture.meta["gyro_lsb_per_dps"] * 180.0 / np.pi
    celsius = capture.temp / capture.meta["temp_lsb_per_c"] + capture.meta["temp_offset_c"]
    rows = [model.step(f, w, c, 0.01) for f, w, c in zip(
        capture.accel / lsb[0], capture.gyro / lsb[1], celsius)]
    read = [np.round(np.array(x) * scale).astype(np.int16) for x, scale in zip(zip(*rows), lsb)]
    return capture_file.Capture(capture.meta, capture.t_us, read[0], read[1], capture.temp, None,
                                capture.pose)


@pytest.mark.long
@pytest.mark.parametrize("name,own,effect", [
    ("healthy", True, "thermal_bias"), ("healthy", True, "quadratic"), ("no_noise", False, ""),
    ("gyro_late", True, "")])
def test_simulated_again_with_the_class_there_is_no_gap(box, once, tmp_path, name, own, effect):
    real, sim = captures(name, box, own=own, effect=effect)
    before = once(name + effect, lambda: answered(real, sim))
    assert before["verdict"] != "no gap"
    space = {}
    exec(exported(before, "numpy", tmp_path), space)
    after = answered(real, through(space["ImuModel"](3), sim))
    left = [(s, n, a) for s, named in after["simulator"]["parameters"].items()
            for n, axes in named.items() for a, p in axes.items() if p["differs"]]
    assert not left and not after["simulator"]["conventions"]
    # What was seen under several names is in no file, and is there still.
    unnamed = [c for c in after["causes"] if c["effect"] is None]
    assert [c for c in after["causes"] if c["effect"]] == []
    assert after["verdict"] == ("cannot tell" if unnamed else "no gap")
    for kind, gap in after["simulator"]["gap"].items():
        assert gap["before"] < 0.3 * before["simulator"]["gap"][kind]["before"] or (
            gap["before"] < 2.0 * gap["floor"])


@pytest.mark.long
def test_mujoco_takes_its_own_snippet_and_the_lever_arm_with_it(box, tmp_path):
    real, sim = captures("no_lever_arm", box, own=False)
    text = exported(answered(real, sim), "mujoco", tmp_path)
    model = mujoco.MjModel.from_xml_string(text)
    assert model.site_pos[0] == pytest.approx(defects.ARM, abs=0.002)
    moved = engine.BOX.replace('pos="0.04 -0.015 0.02"', 'pos="%g %g %g"' % tuple(
        model.site_pos[0]))
    again = engine.motion(mujoco.MjModel.from_xml_string(moved), engine.Hand(4, True), "arm",
                          box.labels)
    text = defects.pair("healthy", box, again, 8, own=False)[1]
    after = answered(real, capture_file.parse("log", text.encode()))
    assert not after["simulator"]["conventions"]
    assert after["verdict"] == "no gap"


@pytest.mark.parametrize("target", ["gz", "genesis", "isaaclab", "matlab", "kalibr"])
def test_every_target_says_what_it_cannot_express(box, once, tmp_path, target):
    answer = once("gyro_late", lambda: answered(*captures("gyro_late", box)))
    text = exported(answer, target, tmp_path)
    assert "cannot express" in text and "delay" in text
    if target == "gz":
        import xml.etree.ElementTree as ElementTree
        means = [float(m.text) for m in ElementTree.fromstring(text).iter("mean")]
        bias = answer["simulator"]["parameters"]["gyro"]["bias"]
        assert means[:3] == pytest.approx(
            [np.radians(bias[a]["difference"]) for a in "xyz"], rel=1e-3)
    if target == "matlab":
        part = json.loads(text)["sixflip"]
        assert np.shape(part["Accelerometer"]["AxesMisalignment"]) == (3, 3)


def test_a_file_that_is_no_diagnosis_is_refused(tmp_path, capsys):
    for text, code in (("{}", 4), ('{"format": 1, "verdict": "no gap"}', 2), ("", 4),
                       ('{"verdict": 1, "causes": 3, "simulator": {"parameters": 5}}', 4)):
        file = tmp_path / "gap.json"
        file.write_text(text)
        assert cli.main(["export", str(file), "--to", "numpy", "-o",
                         str(tmp_path / "out.py")]) == code
        assert "expected" in capsys.readouterr().err
