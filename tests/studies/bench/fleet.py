"""How `sixflip fleet` scales, and what becomes of it when a worker or the scheduler dies.

    python -m tests.studies.bench.fleet [--boards 100 1000] [--workers 1 2]
    python -m tests.studies.bench.fleet --diagnosed 10

Boards come as summaries of two sessions of 24 poses each, made by tests/worlds/simulated_fleet.py,
and are done by the command itself in processes of its own. Memory is the largest sum over the
command and its workers (proportional set size, so what they share counts once). Then a worker is
killed in mid-run, and a scheduler of its own; the data set is counted afterwards. --diagnosed is
of the processor time only: the same boards plain and with --diagnose, one worker, what chance
alone shows in their protocol simulated in a run before.
"""
import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil

from sixflip_host.fleet import dataset, summary_file
from tests.worlds.simulated_fleet import THERMAL, drawn, summary_of

SIXFLIP = [sys.executable, "-m", "sixflip_host"]


def made(folder, number):
    """A folder of summaries of so many boards."""
    rng = np.random.default_rng(3)
    for k in range(number):
        part, place = drawn(rng), folder / ("batch %d" % (k // 500)) / ("b%05d" % k)
        place.mkdir(parents=True)
        for n, plan in enumerate(THERMAL):
            one = summary_of(part, plan, rng, "b%05d-%d" % (k, n), n)
            (place / ("s%d.csv%s" % (n, summary_file.SUFFIX))).write_bytes(
                summary_file.encode(one))
    return folder


def memory(process):
    """MB of a process and all below it."""
    total = 0
    for one in [process, *process.children(recursive=True)]:
        try:
            total += one.memory_full_info().pss
        except (psutil.Error, AttributeError):
            continue
    return total / 2 ** 20


def run(command, hook=None):
    """(seconds, largest memory MB, exit code, stderr); hook(process, seconds) is called now and
    then."""
    start, most = time.monotonic(), 0.0
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said,
                                   env=dict(os.environ, OPENBLAS_NUM_THREADS="1"))
        about = psutil.Process(process.pid)
        while process.poll() is None:
            try:
                most = max(most, memory(about))
            except psutil.Error:
                break
            if hook:
                hook(about, time.monotonic() - start)
            time.sleep(0.5)
        code = process.wait()
        said.seek(0)
        return time.monotonic() - start, most, code, said.read().strip()


def counted(out):
    """(boards in a data set, rows in it)"""
    data = dataset.DataSet(out)
    return len(data.done()[0]), sum(len(data._read(p, ("board",))) for p in data.parts())


def speed(number, workers, top):
    """One line of the table, and boards a second."""
    folder = top / ("in-%d" % number)
    if not folder.exists():
        made(folder, number)
    out = top / ("out-%d-%d" % (number, workers))
    seconds, most, code, said = run([*SIXFLIP, "fleet", str(folder), "-o", str(out),
                                     "--workers", str(workers)])
    data = dataset.DataSet(out)
    cpu = float(np.mean([r["cpu_s"] for r in data.rows(columns=("board", "batch", "written",
                                                                "cpu_s"))]))
    print("%6d boards, %d workers: %6.1f s, %5.2f boards/s, %.2f s of processor a board, %4.0f MB"
          "%s" % (number, workers, seconds, number / seconds, cpu, most,
                  "" if code == 0 else ", exit code %d: %s" % (code, said)), flush=True)
    return number / seconds


def diagnosed(number, top):
    """Processor time of a board without and with --diagnose, the latter with cutoffs cached."""
    folder = made(top / "in", number)
    for name, more in (("plain", ()), ("what chance alone shows not yet kept", ("--diagnose",)),
                       ("diagnosed", ("--diagnose",))):
        out = top / name
        code, said = run([*SIXFLIP, "fleet", str(folder), "-o", str(out), "--workers", "1",
                          *more])[2:]
        cpu = [row["cpu_s"] for row in dataset.DataSet(out).rows(
            columns=("board", "batch", "written", "cpu_s"))]
        print("%d boards, %s: %.2f s of processor a board, median; %.2f to %.2f%s" % (
            len(cpu), name, np.median(cpu), min(cpu), max(cpu),
            "" if code == 0 else ", exit code %d: %s" % (code, said)), flush=True)


def worker_killed(folder, number, top):
    """A worker dies while boards are under way."""
    killed, out = [], top / "out-killed"

    def kill(process, seconds):
        if killed or counted(out)[0] < 1:
            return
        for one in process.children(recursive=True):
            if "spawn_main" in " ".join(one.cmdline()):
                one.send_signal(signal.SIGKILL)
                killed.append(counted(out)[0])
                return
    _, _, code, said = run([*SIXFLIP, "fleet", str(folder), "-o", str(out), "--workers", "2"],
                           kill)
    boards, rows = counted(out)
    print("a worker killed with %s boards kept: exit code %d, %d of %d boards, %d rows%s" % (
        killed[0] if killed else "all", code, boards, number, rows, " " + said if said else ""))


def scheduler_lost(folder, number, top):
    """The scheduler of somebody else's cluster dies; the same command goes on elsewhere."""
    file, out, dead = top / "scheduler.json", top / "out-lost", []
    dask = [sys.executable, "-m", "distributed.cli."]

    def start(what, *more):
        return subprocess.Popen([*dask[:-1], dask[-1] + what, "--scheduler-file", str(file),
                                 "--no-dashboard", *more],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    scheduler = start("dask_scheduler", "--port", "0", "--host", "127.0.0.1")
    while not file.exists():
        time.sleep(0.1)
    workers = [start("dask_worker", "--nthreads", "1", "--death-timeout", "20") for _ in range(2)]

    def kill(process, seconds):
        if not dead and counted(out)[0] >= 1:
            scheduler.kill()
            dead.append(seconds)
    try:
        _, _, code, said = run([*SIXFLIP, "fleet", str(folder), "-o", str(out), "--scheduler",
                                str(file)], kill)
    finally:
        for one in [scheduler, *workers]:
            one.kill()
            one.wait()
    print("the scheduler killed: exit code %d, %d of %d boards kept\n   %s" % (
        code, counted(out)[0], number, said))
    code = run([*SIXFLIP, "fleet", str(folder), "-o", str(out), "--workers", "2"])[2]
    print("the same command again: exit code %d, %d of %d boards, %d rows" % (
        code, counted(out)[0], number, counted(out)[1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--boards", type=int, nargs="+", default=[100, 1000])
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--diagnosed", type=int, metavar="BOARDS")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as top:
        top = Path(top)
        if args.diagnosed:
            diagnosed(args.diagnosed, top)
            return
        for number in args.boards:
            rates = [speed(number, workers, top) for workers in args.workers]
            if len(rates) > 1:
                print("%6d boards: %d workers do %.2f times as many as %d" % (
                    number, args.workers[-1], rates[-1] / rates[0], args.workers[0]))
        least = min(args.boards)
        worker_killed(top / ("in-%d" % least), least, top)
        scheduler_lost(top / ("in-%d" % least), least, top)


if __name__ == "__main__":
    main()
