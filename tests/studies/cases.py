"""The cases of a study through the scheduler of `sixflip fleet`: on the cores of this computer, or
on a Dask cluster that somebody runs, whose workers were started in this folder too."""
import importlib
import sys
import time
import traceback

from sixflip_host.fleet import cluster

EVERY_S = 20.0  # a line of progress


def add_arguments(parser):
    """--jobs and --scheduler."""
    parser.add_argument("--jobs", type=int, default=2, help="processes on this computer")
    parser.add_argument("--scheduler", metavar="ADDRESS | FILE",
                        help="run on this Dask cluster instead")


def target(args):
    """Where to run, from the arguments."""
    return cluster.Target(args.scheduler, 0 if args.scheduler else args.jobs)


def done(work, cases, where, what, minutes=0.0, take=None):
    """[work(case)] in the order of the cases, with a line of progress now and then on stderr.

    where    cluster.Target
    minutes  give the workers no more cases after so many, 0: all; what they were given is done
    take     called with each result as it comes, in any order
    CaseFailed with the traceback of a case that fails.
    """
    found, begin, shown = {}, time.monotonic(), 0.0
    if not cases:
        return []

    def given():
        for number, case in enumerate(cases):
            if minutes and time.monotonic() - begin > 60.0 * minutes:
                return
            yield number, case

    def taken(results):
        nonlocal shown
        for number, result, why in results:
            if why:
                raise CaseFailed("%s, case %d of %d: %s" % (what, number + 1, len(cases), why))
            found[number] = result
            if take:
                take(result)
        now = time.monotonic() - begin
        if now - shown > EVERY_S or len(found) == len(cases):
            shown = now
            print("%s: %d of %d, %.0f s" % (what, len(found), len(cases), now),
                  file=sys.stderr, flush=True)
    with cluster.connected(where) as client:
        cluster.run(client, given(), taken, where, cluster.Task(_asked, _failed, work, 1, "cases"),
                    len(cases))
    return [found[number] for number in sorted(found)]


def main_of(name):
    """main() of a study that was started by its name: of the module that workers import, too,
    which __main__ is not."""
    return importlib.import_module(name).main()


class CaseFailed(Exception):
    """A case raised, or workers died of it; with its traceback."""


def _asked(jobs, work):
    """[(number, result, "")], or what a case raised in place of the result."""
    out = []
    for number, case in jobs:
        try:
            out.append((number, work(case), ""))
        except Exception:  # told where the study was started, whatever it is
            out.append((number, None, traceback.format_exc()))
    return out


def _failed(job, _work, why):
    return job[0], None, why
