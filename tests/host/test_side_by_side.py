"""Work on several processors: the same answers, errors where they are expected, nothing lost."""
import os
import signal
import sys

import pytest

from sixflip_host import side_by_side
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.errors import BadFile
from sixflip_host.simulation import scenario, simulated_session

copies = pytest.mark.skipif(sys.platform != "linux", reason="copies of a process: Linux only")


@copies
def test_what_is_returned_is_in_order_and_from_processes_of_their_own():
    found = side_by_side.results([lambda k=k: (k, os.getpid()) for k in range(3)], 3)
    assert [k for k, _ in found] == [0, 1, 2]
    assert found[0][1] == os.getpid()
    assert len({pid for _, pid in found}) == 3


@copies
def test_many_functions_take_no_more_processes_than_processors():
    found = side_by_side.results([lambda k=k: (k, os.getpid()) for k in range(31)], 2)
    assert [k for k, _ in found] == list(range(31))
    assert len({pid for _, pid in found}) == 2


def test_one_processor_makes_no_copies():
    assert side_by_side.results([os.getpid, os.getpid], 1) == [os.getpid()] * 2


@copies
def test_what_a_copy_raises_is_raised_and_none_is_left_over(monkeypatch):
    fork, copied = os.fork, []

    def watched():
        copied.append(fork())
        return copied[-1]

    def wrong():
        raise BadFile("session.csv: no rest")
    monkeypatch.setattr(os, "fork", watched)
    with pytest.raises(BadFile, match=r"session\.csv: no rest"):
        side_by_side.results([lambda: 1, wrong], 2)
    with pytest.raises(BadFile):
        side_by_side.results([wrong, signal.pause], 2)
    assert len(copied) == 2
    for pid in copied:
        with pytest.raises(ChildProcessError):  # not of any child: other tests may have some
            os.waitpid(pid, os.WNOHANG)


@copies
def test_what_a_copy_that_was_ended_had_to_do_is_done_here():
    here = os.getpid()

    def ended():
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return "done"
    assert side_by_side.results([lambda: 1, ended], 2) == [1, "done"]


@copies
def test_a_system_that_has_no_more_processes_to_give_does_it_here(monkeypatch):
    def none():
        raise BlockingIOError
    monkeypatch.setattr(os, "fork", none)
    assert side_by_side.results([lambda: 1, lambda: 2], 2) == [1, 2]


def test_a_diagnosis_is_the_same_on_any_number_of_processors():
    world = scenario.from_dict({
        "sensor": "mpu6050", "seed": 4, "effects": [
            {"effect": "quantisation", "sensor": "accel", "x": 16}]})
    captures = [("one", simulated_session.session(world, 0))]
    one, two = (answer.as_dict(diagnose(captures, jobs=jobs)) for jobs in (1, 2))
    assert one == two
    assert one["causes"]
