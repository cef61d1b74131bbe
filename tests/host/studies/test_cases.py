"""The cases of a study go through the scheduler of `sixflip fleet`; an interrupted run goes on."""
import argparse
import contextlib
import json
from types import SimpleNamespace

import distributed
import pytest

from sixflip_host.fleet import cluster
from tests.studies import cases
from tests.studies.blind import blind_run, seal

HERE = cluster.Target(None, 2)


@pytest.fixture
def inside(monkeypatch):
    """A cluster inside this process: the same scheduler, no time for processes."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=False,
                                  dashboard_address=None) as own, \
            distributed.Client(own) as client:
        monkeypatch.setattr(cluster, "connected", lambda target: contextlib.nullcontext(client))
        yield


def halved(case):
    if case % 2:
        raise ValueError("%d is odd" % case)
    return case // 2


def test_results_are_in_the_order_of_the_cases_and_come_once(inside):
    came = []
    assert cases.done(halved, range(0, 40, 2), HERE, "halved", take=came.append) == [*range(20)]
    assert sorted(came) == [*range(20)]


def test_a_case_that_raises_is_told_with_its_number_and_line(inside):
    with pytest.raises(cases.CaseFailed, match=r"(?s)halved, case 3 of 4: .*in halved.*3 is odd"):
        cases.done(halved, [0, 2, 3, 4], HERE, "halved")


def test_when_the_time_is_over_what_was_given_is_done(inside, monkeypatch):
    clock = iter(range(0, 10 ** 6, 60))
    monkeypatch.setattr(cases, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    found = cases.done(halved, range(0, 40, 2), HERE, "halved", minutes=9.5)
    assert 0 < len(found) < 10 and found == [*range(len(found))]


def test_jobs_or_a_scheduler_that_is_there():
    parser = argparse.ArgumentParser()
    cases.add_arguments(parser)
    assert cases.target(parser.parse_args(["--jobs", "3"])) == cluster.Target(None, 3)
    assert cases.target(parser.parse_args(["--scheduler", "tcp://a:1"])) == cluster.Target(
        "tcp://a:1", 0)


def test_answers_that_are_there_are_not_asked_for_again(tmp_path, monkeypatch):
    (tmp_path / seal.MANIFEST).write_text(json.dumps({"cases": [
        {"id": name, "files": [], "twin": []} for name in ("one", "two", "three")]}))
    (tmp_path / blind_run.PART).write_text('{"id": "two", "code": 0}\n{"id": "thr')
    asked = []

    def done(work, jobs, where, what, minutes, take):
        found = [{"id": public["id"], "code": 1} for public, _, _ in jobs]
        asked.extend(one["id"] for one in found)
        for one in found:
            take(one)
        return found
    monkeypatch.setattr(cases, "done", done)
    answers = blind_run.diagnose(tmp_path, HERE, keep=False)
    assert asked == ["one", "three"]
    assert [(a["id"], a["code"]) for a in answers] == [("one", 1), ("two", 0), ("three", 1)]
    assert json.loads((tmp_path / "answers.json").read_text()) == answers
    assert not (tmp_path / blind_run.PART).exists()
