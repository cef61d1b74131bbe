"""How long `sixflip diagnose` takes, and how much memory: two sessions of 90,000 samples each.

    python -m tests.studies.bench.diagnose_speed [--cores 2] [--rests 5 13.5]

The recommended protocol at 100 Hz, 15 minutes a session, with two causes in it, made by
`sixflip simulate`'s own simulator; once with the thresholds to be simulated first and once with
them from the cache, each a process of its own, start of Python and reading included. Beside it
the common way, stepwise regression by BIC on every sample at rest, on the same two files.
Exits with 1 when the target is missed: 20 s on two cores with the thresholds cached, 1 GB.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SAMPLES, TARGET_S, TARGET_GB = 90_000, 20.0, 1.0
EFFECTS = [{"effect": "thermal_bias", "sensor": "accel", "z": -1.8},
           {"effect": "g_sensitivity", "sensor": "gyro", "xy": 0.1}]
SETTLE_S = 30.0  # of rest, at each end of a session
DIAGNOSE = "import sys; from sixflip_host.cli import main; sys.exit(main(sys.argv[1:]))"
STEPWISE = """
import json, sys
from tests.studies.blind.baselines.stepwise import stepwise
from sixflip_host.capture import capture_file
print(json.dumps(stepwise([capture_file.read(path) for path in sys.argv[1:]])))
"""


def made(folder, dwell_s):
    """Paths of the two sessions, and how many samples each has."""
    from sixflip_host.capture import capture_file
    from sixflip_host.planning import protocols
    from sixflip_host.simulation import scenario, simulated_session
    rests = len(protocols.named("recommended").sessions[0].rests)
    move_s = (SAMPLES / 100.0 - 2 * SETTLE_S - rests * dwell_s) / (rests - 1)
    plan = scenario.from_dict({
        "sensor": "mpu6050", "scene": "recommended", "seed": 9, "effects": EFFECTS,
        "world": {"tilt_deg": 1.0, "placement_scatter_deg": 0.05, "dwell_s": dwell_s,
                  "move_s": move_s}})
    paths, sizes = [], []
    for number in (0, 1):
        capture = simulated_session.session(plan, number)
        paths.append(str(folder / ("session%d.csv" % number)))
        capture_file.write(paths[-1], capture)
        sizes.append(len(capture))
    return paths, sizes


class Run:
    """A process of its own: wall, cpu (s), memory (GB, peak), answer (its JSON)."""

    def __init__(self, code, words, cache, cores):
        started = time.perf_counter()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        process = subprocess.Popen(
            [sys.executable, "-c", code, *words], env=dict(os.environ, SIXFLIP_CACHE=str(cache)),
            stdout=subprocess.PIPE, preexec_fn=lambda: keep_to(cores))
        out = process.stdout.read()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.wall = time.perf_counter() - started
        if process.returncode:
            sys.exit("it ended with code %d" % process.returncode)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.memory = used.ru_maxrss / (1e9 if sys.platform == "darwin" else 1e6 / 1.024)
        self.answer = json.loads(out)

    def line(self, words):
        causes = "; ".join("%s %s" % (c["sensor"], " or ".join(c["class"])) for c in sorted(
            self.answer["causes"], key=lambda c: -c["score_nats"])[:4])
        more = len(self.answer["causes"]) - 4
        return "%-28s %7.1f %7.1f %9.2f   %s%s" % (
            words, self.wall, self.cpu, self.memory, causes, ", %d more" % more if more > 0
            else "")


def keep_to(cores):
    """This process on so many cores, where the system can be asked for that."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:cores])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--rests", type=float, nargs="+", default=[5.0, 13.5], metavar="S",
                        help="length of a rest; above 12 s it is cut into more blocks")
    args = parser.parse_args()
    missed = []
    for dwell_s in args.rests:
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            paths, sizes = made(folder, dwell_s)
            print("two sessions of %s samples, rests of %g s, %d cores of %d, load %.1f" % (
                " and ".join(f"{n:,}" for n in sizes), dwell_s, args.cores,
                os.cpu_count(), os.getloadavg()[0]))
            print("%-28s %7s %7s %9s   %s" % ("", "wall s", "CPU s", "peak GB", "named"))
            words = ["diagnose", *paths, "--json", "--jobs", str(args.cores)]
            first = Run(DIAGNOSE, words, folder / "cache", args.cores)
            print(first.line("diagnose, nothing cached"), flush=True)
            second = Run(DIAGNOSE, words, folder / "cache", args.cores)
            print(second.line("diagnose, thresholds cached"), flush=True)
            common = Run(STEPWISE, paths, folder, args.cores)
            print(common.line("stepwise BIC on samples"), flush=True)
            print()
            if second.wall > TARGET_S:
                missed.append("%.1f s, expected at most %g" % (second.wall, TARGET_S))
            if max(first.memory, second.memory) > TARGET_GB:
                missed.append("%.2f GB, expected at most %g" % (
                    max(first.memory, second.memory), TARGET_GB))
    for words in missed:
        print("target missed:", words)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
