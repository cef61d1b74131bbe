"""What `sixflip diagnose` costs as the data grows: seconds and peak memory.

    python -m tests.studies.bench.diagnose_cost [--largest ROWS] [--cores 2]

One capture of 180,000 rows and 114 rests, of 480,000 and 304, of 2,000,000 and 1,292, and two
sessions of 90,000 samples; at 100 Hz, with two causes in them, made by `sixflip simulate`'s own
simulator. Each is diagnosed twice in a process of its own, start of Python and reading included:
with what chance shows to be simulated first, and with that from the cache: elapsed seconds and
processor time of both. The last columns are, of the second, seconds of processor time a rest and
peak memory a row: they are to stay as they are, or fall, as the data grows.
"""
import argparse
import tempfile
from pathlib import Path

from tests.studies.bench.diagnose_speed import DIAGNOSE, EFFECTS, Run

SIZES = ((1, 57, 90_000), (1, 114, 180_000), (1, 304, 480_000), (1, 1292, 2_000_000),
         (2, 57, 90_000))  # sessions; rests and rows of each
DWELL_S, LEANING = 5.0, 15


def plan_of(rests, rows, number):
    """SessionPlan of so many rests and rows: the faces in pairs and leaning poses, again and
    again, each time in another order; warming, and cooling in a second session."""
    from sixflip_host.planning import protocols
    found = []
    while len(found) < rests:
        seed = 7 + number + len(found)
        found += protocols.faces_session(protocols.order_of("pairs", seed), LEANING, True, True,
                                         "warming", seed).rests
    move_s = (rows / 100.0 - rests * DWELL_S) / (rests - 1)
    for rest in found[:rests]:
        rest.dwell_s, rest.move_s = DWELL_S, move_s
    state = ("warming", "cooling")[number % 2]
    return protocols.SessionPlan(found[:rests], state, *protocols.STATES[state])


def made(folder, sessions, rests, rows):
    """Paths of the captures, and how many rows they have together."""
    from sixflip_host.capture import capture_file
    from sixflip_host.planning import plan_file, protocols
    from sixflip_host.simulation import scenario, simulated_session
    plan = str(folder / "plan.json")
    plan_file.write(plan, protocols.Protocol("cost", [plan_of(rests, rows, k)
                                                      for k in range(sessions)]))
    world = scenario.from_dict({
        "sensor": "mpu6050", "plan": plan, "seed": 9, "effects": EFFECTS,
        "world": {"tilt_deg": 1.0, "placement_scatter_deg": 0.05}})
    paths, total = [], 0
    for number in range(sessions):
        capture = simulated_session.session(world, number)
        paths.append(str(folder / ("session%d.csv" % number)))
        capture_file.write(paths[-1], capture)
        total += len(capture)
    return paths, total


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--largest", type=int, default=SIZES[3][2], metavar="ROWS",
                        help="leave out captures of more rows (default: none)")
    parser.add_argument("--cores", type=int, default=2)
    args = parser.parse_args()
    print("%10s %6s %9s %8s %9s %8s %9s %8s %9s %9s" % (
        "rows", "rests", "sessions", "first s", "first CPU", "again s", "again CPU", "peak GB",
        "CPU/rest", "bytes/row"))
    for sessions, rests, rows in SIZES:
        if rows > args.largest:
            continue
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            paths, total = made(folder, sessions, rests, rows)
            words = ["diagnose", *paths, "--json", "--jobs", str(args.cores)]
            first = Run(DIAGNOSE, words, folder / "cache", args.cores)
            again = Run(DIAGNOSE, words, folder / "cache", args.cores)
            memory = max(first.memory, again.memory)
            print("%10s %6d %9d %8.1f %9.1f %8.1f %9.1f %8.2f %9.3f %9.0f" % (
                f"{total:,}", sessions * rests, sessions, first.wall, first.cpu, again.wall,
                again.cpu, memory, again.cpu / (sessions * rests), 1e9 * memory / total),
                flush=True)


if __name__ == "__main__":
    main()
