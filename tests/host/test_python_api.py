"""The Python functions: the notebook of docs/ runs, and their values are the verbs' own."""

import dataclasses
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import sixflip_host
from sixflip_host.errors import BadFile, UsageError

NOTEBOOK = Path(__file__).resolve().parents[2] / "docs" / "python-api.ipynb"
PAPER = {"seed": 3, "scene": "paper"}


@pytest.mark.long
def test_the_notebook_runs_from_top_to_bottom(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cells = [cell for cell in json.loads(NOTEBOOK.read_text())["cells"]
             if cell["cell_type"] == "code"]
    names = {}
    for number, cell in enumerate(cells, 1):
        exec(compile("".join(cell["source"]), "cell %d" % number, "exec"), names)
    assert len(cells) > 6 and names["against"].verdict == "explained"


@pytest.fixture(scope="module")
def capture():
    return sixflip_host.simulate(PAPER)[0]


def test_importing_loads_no_numpy():
    code = "import sys, sixflip_host; assert 'numpy' not in sys.modules"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_solve_says_what_the_verb_says(capture, tmp_path, capsys):
    from sixflip_host.capture import capture_file
    from sixflip_host.cli import main
    path = tmp_path / "capture.csv"
    capture_file.write(path, capture)
    assert main(["solve", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == dict(sixflip_host.solve(path).json)


def test_values_cannot_be_changed_and_captures_are_not(capture):
    labels = capture.pose
    capture.pose = None
    found = sixflip_host.solve(capture)
    assert capture.pose is None                     # the poses found stay with the solution
    capture.pose = labels
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.verdict = "good"
    with pytest.raises(ValueError):
        found.accelerometer[0, 0] = 1.0
    with pytest.raises(TypeError):
        found.json["verdict"] = "good"
    assert np.allclose(found.accelerometer[:, 3], [0, 0, 0, 1])


def test_what_is_wrong_is_a_sentence(tmp_path):
    with pytest.raises(BadFile, match="no_such"):
        sixflip_host.diagnose(tmp_path / "no_such.csv")
    for nothing in ([], None):
        with pytest.raises(UsageError, match="no captures: expected one"):
            sixflip_host.diagnose(nothing)
    with pytest.raises(UsageError, match="2 captures: expected one"):
        sixflip_host.solve(sixflip_host.simulate({"scene": "paper"}) * 2)
    with pytest.raises(UsageError, match="expected one of paper"):
        sixflip_host.plan("papr")
    with pytest.raises(BadFile, match="scenario: "):
        sixflip_host.simulate({"scen": "paper"})
    with pytest.raises(AttributeError, match="diagnoze"):
        sixflip_host.diagnoze  # noqa: B018
