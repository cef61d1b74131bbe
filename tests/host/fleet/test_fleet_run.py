"""Boards go through Dask once each, whatever becomes of workers, scheduler and disk."""
import json
import os
import socket

import distributed
import pytest

from sixflip_host import cli
from sixflip_host.errors import BadFile, CheckFailed, UsageError
from sixflip_host.fleet import analysis, cluster, dataset, run_fleet, sources, worker_versions

HERE = cluster.Target(None, 1)


@pytest.fixture(scope="module")
def client():
    """A cluster inside this process: the same scheduler, no time for processes."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=False,
                                  dashboard_address=None) as own, \
            distributed.Client(own) as client:
        yield client


@pytest.fixture
def inside(client, monkeypatch):
    """run_fleet with that cluster."""
    import contextlib
    monkeypatch.setattr(cluster, "connected", lambda target: contextlib.nullcontext(client))


def fleet_of(folder, n=9):
    """A folder of n boards whose captures are no captures: each fails with its sentence."""
    for k in range(n):
        (folder / ("b%d" % k)).mkdir(parents=True)
        (folder / ("b%d" % k) / "s.csv").write_text("nothing of ours %d\n" % k)
    return folder


def counted(rows):
    """A task that leaves a mark for each board that it does."""
    def work(boards, options):
        out = []
        for one in boards:
            with open(rows, "a") as file:
                file.write(one.board + "\n")
            out.append(dict(analysis.row(one, options), failure="", values=[]))
        return out
    return work


def test_every_board_is_done_once_and_not_again(tmp_path, inside):
    folder, marks = fleet_of(tmp_path / "in"), tmp_path / "marks"
    first = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(str(marks)))
    assert first.fresh == 9 and len(list(first.rows())) == 9
    assert sorted(marks.read_text().split()) == ["b%d" % k for k in range(9)]
    again = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(str(marks)))
    assert again.fresh == 0 and len(list(again.rows())) == 9
    (folder / "b4" / "s.csv").write_text("another\n")
    third = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(str(marks)))
    assert third.fresh == 1 and len(list(third.rows())) == 9
    assert len(marks.read_text().split()) == 10


def test_rows_of_another_version_are_done_again(tmp_path, inside, monkeypatch):
    folder, marks = fleet_of(tmp_path / "in", 2), str(tmp_path / "marks")
    run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(marks))
    monkeypatch.setattr(analysis, "VERSION", "another")
    again = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(marks))
    assert again.fresh == 2 and len(list(again.rows())) == 2


def test_damaged_files_are_sentences_and_stop_nobody(tmp_path, inside, capsys):
    folder = fleet_of(tmp_path / "in", 3)
    done = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE)
    assert [board for board, _ in sorted(done.failures)] == ["b0", "b1", "b2"]
    assert all("s.csv" in why and "\n" not in why for _, why in done.failures)
    assert cli.main(["fleet", str(folder), "-o", str(tmp_path / "out")]) == 4
    said = capsys.readouterr()
    assert "b1" in said.out and "could be solved" in said.err
    assert len(json.loads((tmp_path / "out" / "fleet.json").read_text())["failures"]) == 3


def test_what_a_task_raises_is_its_boards_sentence(tmp_path, monkeypatch):
    folder = fleet_of(tmp_path / "in", 1)
    monkeypatch.setattr(analysis, "_of_files", lambda board, options: 1 / 0)
    row = analysis.row(sources.find_boards(folder).boards[0])
    assert row["failure"].startswith("internal error: ZeroDivisionError")


def test_a_full_disk_ends_clearly_and_what_was_done_stays(tmp_path, inside, monkeypatch):
    folder, marks = fleet_of(tmp_path / "in"), str(tmp_path / "marks")
    monkeypatch.setattr(run_fleet, "ROWS_OF_A_PART", 4)
    writes = []

    def full(path, data):
        writes.append(path)
        if len(writes) > 1:
            raise BadFile("%s: cannot be written: No space left on device" % path)
        with open(path, "wb") as file:
            file.write(data)
    with monkeypatch.context() as patch:
        patch.setattr(dataset.atomic_write, "write_bytes", full)
        with pytest.raises(BadFile, match="No space left on device; what was done before is kept"):
            run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(marks))
    again = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(marks))
    assert again.fresh == 5 and len(list(again.rows())) == 9


def test_a_damaged_part_is_said_and_its_boards_are_done_again(tmp_path, inside):
    folder, marks = fleet_of(tmp_path / "in", 4), str(tmp_path / "marks")
    run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(marks))
    part, = dataset.DataSet(tmp_path / "out").parts()
    with open(part, "r+b") as file:
        file.truncate(os.path.getsize(part) // 2)
    again = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(marks))
    assert again.fresh == 4 and any("is damaged" in said for said in again.remarks)


def test_what_a_run_left_is_a_source_itself(tmp_path, inside):
    folder, marks = fleet_of(tmp_path / "in", 3), str(tmp_path / "marks")
    run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, counted(marks))
    taken = run_fleet.boards(str(tmp_path / "out"), str(tmp_path / "new"), HERE)
    assert taken.fresh == 0 and len(list(taken.rows())) == 3


def test_a_lost_connection_is_a_clear_end_that_keeps_what_is_done(tmp_path, client):
    boards = sources.find_boards(fleet_of(tmp_path / "in", 40)).boards
    taken = []

    def take(rows):
        taken.extend(rows)
        raise distributed.CancelledError("scheduler-closed")
    with pytest.raises(cluster.SchedulerLost, match="the same command goes on"):
        cluster.run(client, boards, take, HERE, cluster.Task(cluster.rows_of, analysis.failed))
    assert taken


def test_boards_that_workers_die_of_are_sentences_and_are_tried_again(tmp_path, inside):
    folder = fleet_of(tmp_path / "in", 6)

    def deadly(boards, options):
        if any(one.board == "b5" for one in boards):
            raise distributed.KilledWorker("task", None, 3)
        return [dict(analysis.row(one, options), failure="") for one in boards]
    done = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None, deadly)
    assert len(list(done.rows())) == 6
    assert {board for board, why in done.failures if "its task failed" in why} == {"b4", "b5"}
    again = run_fleet.boards(str(folder), str(tmp_path / "out"), HERE, None,
                             counted(str(tmp_path / "marks")))
    assert again.fresh == 2 and not again.failures


def test_nobody_there_and_no_address_are_one_sentence():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(CheckFailed, match="nobody answers"), cluster.connected(
            cluster.Target("tcp://127.0.0.1:%d" % port)):
        pass
    for word in ("there", "http://x:1", "tcp://x", "tcp://x:99999"):
        with pytest.raises(UsageError, match="expected an address"), cluster.connected(
                cluster.Target(word)):
            pass


def test_another_version_on_the_other_side_is_one_sentence():
    def about(version, python="3.11.2.final.0"):
        return {"packages": {"dask": version, "distributed": version, "python": python}}
    here = about("1.0")
    worker_versions.same_dask(distributed, "tcp://x:1", {
        "client": here, "scheduler": about("1.0", "3.11.9.final.0"), "workers": {"w": here}})
    for scheduler, worker, said in (("0.9", "1.0", "the scheduler is of distributed 0.9"),
                                    ("1.0", "0.9", "a worker is of distributed 0.9")):
        with pytest.raises(CheckFailed, match=said):
            worker_versions.same_dask(distributed, "tcp://x:1", {
                "client": here, "scheduler": about(scheduler), "workers": {"w": about(worker)}})


def test_the_command_line_does_not_load_dask():
    import subprocess
    import sys
    code = ("import sys; from sixflip_host import cli; cli.main(['--help']); "
            "cli.main(['fleet', '--help']); "
            "assert not {'dask', 'distributed', 'pyarrow', 'pandas'} & set(sys.modules)")
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)
