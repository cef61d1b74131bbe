"""Every corpus file through its target, and a bounded run of the fuzzer with a fixed seed."""

import json
import select
import subprocess
import sys
from pathlib import Path

import pytest

from tests.fuzz import targets

HERE = Path(__file__).resolve().parent
FILES = sorted(path for path in (HERE / "corpus").rglob("*") if path.is_file())
# Runs that take a second or two: a target that goes through a whole verb is slower.
RUNS = {"capture_text": 300, "capture_of_a_board": 25, "recorded_pieces": 100, "record": 40,
        "somebodys_csv": 150, "foreign_file": 60,
        "sections": 80, "scenario_file": 300, "settings": 300, "plan": 500,
        "fleet_manifest": 1000, "fleet_summary": 40, "fleet_population": 500}
A_FEW = 2000


@pytest.mark.parametrize("path", FILES, ids=lambda path: "%s/%s" % (path.parent.name, path.name))
def test_corpus(path):
    targets.TARGETS[path.parent.name](path.read_bytes())


def test_every_target_has_a_corpus():
    assert {path.parent.name for path in FILES} == set(targets.TARGETS)


@pytest.fixture(scope="module")
def fuzzer():
    """The process that forks for each target: what they import is instrumented once."""
    with subprocess.Popen([sys.executable, "-m", "tests.fuzz.fuzz", "--each"], text=True,
                          cwd=HERE.parents[1], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL) as process:
        yield process
        process.stdin.close()


@pytest.mark.parametrize("name", targets.TARGETS)
def test_some_runs(fuzzer, name, tmp_path):
    said = tmp_path / "said"
    inputs = tmp_path / "inputs"
    inputs.mkdir()
    options = ["-runs=%d" % RUNS.get(name, A_FEW), "-seed=1", "-max_len=6000",
               "-rss_limit_mb=1500", "-timeout=60", "-artifact_prefix=%s/" % inputs]
    print(json.dumps([name, options, str(said)]), file=fuzzer.stdin, flush=True)
    assert select.select([fuzzer.stdout], [], [], 300)[0], "no end of it in 300 s"
    code = fuzzer.stdout.readline().strip()
    kept = [path.read_bytes()[:2000] for path in inputs.iterdir()]
    assert code == "0", "%s\n%s" % (kept, said.read_text(errors="replace")[-3000:])
