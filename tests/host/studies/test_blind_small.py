"""A small blind run: sealed cases of the independent generator, diagnosed and scored."""

import contextlib
import json

import pytest

from sixflip_host.fleet import cluster
from tests.studies.blind import blind_run, reliability, seal, target_tables
from tests.studies.blind.generator.case import Specification
from tests.studies.blind.scoring import scored

pytestmark = pytest.mark.long
HERE = cluster.Target(None, 1)
SQUARE = {"box_tilt_deg": 0.0}
CASES = {
    "null": ("null", Specification(11, habits=SQUARE)),
    "both": ("pair", Specification(12, effects=[("thermal_bias", "accel", 1.0),
                                                ("g_sensitivity", "gyro", 1.0)], habits=SQUARE)),
    "step": ("stranger", Specification(14, effects=[("bias step", "accel", 1.0)],
                                       habits=SQUARE)),
    "paper": ("paper", Specification(15, protocol="paper", effects=[("cubic", "accel", 1.0)],
                                     habits=SQUARE)),
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """{name: scored result} of the cases above, after a whole run through files and seals."""
    folder = tmp_path_factory.mktemp("blind")
    with cluster.connected(HERE) as client, pytest.MonkeyPatch.context() as patch:
        patch.setattr(cluster, "connected", lambda target: contextlib.nullcontext(client))
        blind_run.make(list(CASES.values()), folder, HERE)
        manifest = (folder / seal.MANIFEST).read_text()
        assert "thermal" not in manifest and "null" not in manifest
        answers = blind_run.diagnose(folder, HERE, keep=False)
    labels = seal.opened(folder)
    return dict(zip(CASES, (scored(labels[a["id"]], a) for a in answers)))


def test_every_case_was_answered(run):
    assert [r["error"] for r in run.values() if r["verdict"] is None] == []


def test_a_healthy_sensor_has_no_gap(run):
    assert run["null"]["verdict"] == "no gap" and run["null"]["named"] == []


def test_a_thermal_bias_of_another_form_is_in_the_class_named(run):
    effect = run["both"]["effects"][0]
    assert effect["class_right"] and effect["axes_right"] and effect["domain_listed"]
    assert run["both"]["false"] == []


def test_a_g_sensitivity_is_named(run):
    assert run["both"]["effects"][1]["name_right"]


def test_a_family_outside_the_library_is_not_called_explained(run):
    assert run["step"]["verdict"] in target_tables.SHOWN
    assert run["step"]["single_false"] == []


def test_twelve_poses_do_not_name_a_cubic(run):
    assert run["paper"]["named"] == [] and run["paper"]["verdict"] in ("no gap", "cannot tell")


def test_nothing_was_named_inside_a_silent_or_aliased_class(run):
    assert [r["never"] for r in run.values() if r["never"]] == []


def test_the_tables_count_what_was_wrong(run):
    """The scorer itself: a wrong name, a false alarm and a crash must show in its tables."""
    wrong = json.loads(json.dumps(run["null"]))
    wrong.update(verdict="explained", named=[["accel", "cubic", 9.0, 0.97]],
                 false=[["accel", "cubic"]], single_false=["cubic"],
                 never=["accel cubic is silent in this protocol"])
    alone = dict(run["both"], suite="single", effects=run["both"]["effects"][:1])
    text, failed = target_tables.report([wrong] * 3 + [alone, *run.values()])
    assert failed and "false alarm" in text and "cubic is silent" in text
    assert reliability.calibration_error([wrong] * 3) == (pytest.approx(0.97), 3)
    assert reliability.by_name([wrong] * 3) == [("cubic", 3, pytest.approx(0.97), 0)]
    assert "Reliability by what was named" in text
    _, fine = target_tables.report(list(run.values()))
    assert not fine
