"""Jobs as tasks on Dask: a cluster of this computer's cores, or one that somebody runs. The jobs
are the boards of a fleet, or the cases of a study.

Tasks are few jobs each, and never more of them under way than keep the workers busy: what is in
memory does not grow with their number. A task whose worker dies is given to another; its rows come
back once, so nothing is lost and nothing is there twice.
"""
import contextlib
import itertools
import logging
import os
import socket
from dataclasses import dataclass
from urllib.parse import urlparse

from .. import optional
from ..errors import BadFile, CheckFailed, UsageError
from . import analysis, worker_versions

AHEAD = 3  # tasks a worker may have waiting: it never idles, and little is lost with it
WAIT_S = 20.0  # for a scheduler to answer
NO_WORKER_S = 60.0  # without any worker of somebody else's cluster, before it is given up
RETRIES = 5  # of a task whose worker died
# Dask has a worker give back all memory above 64 kB at once. A diagnosis asks for tens of MB again
# and again, and what is new is cleared first: that took a quarter of its time.
KEPT_MEMORY = {"MALLOC_TRIM_THRESHOLD_": 64 * 2 ** 20, "MALLOC_MMAP_THRESHOLD_": 32 * 2 ** 20}


@dataclass(frozen=True)
class Target:
    """Where to run: scheduler, an address such as tcp://host:8786 or the path of a scheduler
    file, None: a cluster of this computer; workers of that, 0: one a core."""

    scheduler: str = None
    workers: int = 0


@dataclass(frozen=True)
class Task:
    """What is done with each job. work(jobs, settings): a list with a result of each of a few
    jobs, on a worker; failed(job, settings, why): what stands in its place where workers died of
    it, here; each: jobs of a task; kind: their name in sentences."""

    work: object
    failed: object
    settings: object = None
    each: int = 4
    kind: str = "boards"


class SchedulerLost(CheckFailed):
    """The scheduler is gone in the middle of the work."""


def _dask():
    return optional.need("sixflip fleet", "fleet", "distributed")


@contextlib.contextmanager
def connected(target):
    """A distributed.Client; UsageError or CheckFailed in one sentence where none can be had."""
    distributed = _dask()
    _quiet()
    if target.scheduler is None:
        import dask
        with dask.config.set({"distributed.admin.tick.limit": "60s",
                              "distributed.nanny.pre-spawn-environ": {
                                  **dask.config.get("distributed.nanny.pre-spawn-environ", {}),
                                  **KEPT_MEMORY}}), distributed.LocalCluster(
                n_workers=target.workers or os.cpu_count() or 1, threads_per_worker=1,
                dashboard_address="127.0.0.1:0", silence_logs=logging.CRITICAL) as cluster, \
                distributed.Client(cluster) as client:
            yield client
        return
    client = _client(distributed, target.scheduler)
    try:
        yield client
    finally:
        with contextlib.suppress(Exception):
            client.close(timeout=2)


def _quiet():
    """Dask's loggers have a level each; what they would say is said in one sentence here."""
    for name in list(logging.root.manager.loggerDict):
        if name.split(".")[0] in ("distributed", "tornado", "asyncio"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)


def _client(distributed, scheduler):
    """A Client of somebody else's scheduler, of the same versions as this program."""
    how = {"scheduler_file": scheduler} if os.path.isfile(scheduler) else {"address": scheduler}
    if "address" in how:
        _reachable(scheduler)
    try:
        client = distributed.Client(timeout=WAIT_S, **how)
        versions = client.get_versions()
    except (OSError, ValueError, TypeError, KeyError, TimeoutError, RuntimeError,
            ImportError) as error:
        raise CheckFailed("--scheduler %s: no scheduler of Dask %s answers there (%s): expected "
                          "one of the same version" % (
                              scheduler, distributed.__version__,
                              worker_versions.in_short(error))) from None
    worker_versions.same_dask(distributed, scheduler, versions)
    worker_versions.same_sixflip(client, scheduler)
    return client


def _reachable(address):
    """UsageError or CheckFailed for an address that is none, or where nobody listens: Dask itself
    would try for half a minute."""
    parts = urlparse(address)
    try:
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if parts.scheme not in ("tcp", "tls", "ws", "wss", "ucx") or not host or not port:
        raise UsageError("--scheduler %s: expected an address such as tcp://host:8786, or a "
                         "scheduler file" % address)
    try:
        socket.create_connection((host, port), timeout=WAIT_S).close()
    except OSError as error:
        raise CheckFailed("--scheduler %s: nobody answers there: %s" % (
            address, error.strerror or error)) from None


def rows_of(boards, options):
    """The work of a fleet: a row for each of a few boards."""
    return [analysis.row(one, options) for one in boards]


def run(client, jobs, take, target, task, number=None):
    """Give every job to the workers; take(results) is called here with what comes back, once for
    each job. jobs is asked for the next ones when workers have time for them; number: how many
    there are. CheckFailed when the scheduler is lost or no worker is left."""
    distributed = _dask()
    jobs, number = iter(jobs), len(jobs) if number is None else number
    done, given = 0, {}

    def give(tasks):
        for _ in range(tasks):
            some = list(itertools.islice(jobs, task.each))
            if not some:
                return
            future = client.submit(task.work, some, task.settings, pure=False, retries=RETRIES)
            given[future.key] = some
            pool.add(future)

    def so_far():
        return "%d of %d %s are done and kept" % (done, number, task.kind)
    try:
        pool = distributed.as_completed(loop=client.loop)
        give(AHEAD * _workers(client, target))
        while pool.count():
            future = _next(pool, client, target, so_far)
            results = _result(future, given.pop(future.key), task)
            future.release()
            take(results)
            done += len(results)
            give(1)
    except (BadFile, CheckFailed):
        raise
    except (OSError, TimeoutError, distributed.CancelledError, RuntimeError) as error:
        raise _lost(target, so_far, error) from None


def _result(future, jobs, task):
    """The results of a task; where workers died of it again and again, what says so."""
    try:
        return future.result()
    except (OSError, TimeoutError, _dask().CancelledError):
        raise
    except Exception as error:
        return [task.failed(one, task.settings, "not done, its task failed on %d workers (%s)" % (
            RETRIES + 1, worker_versions.in_short(error))) for one in jobs]


def _next(pool, client, target, so_far):
    """The next future that is finished; SchedulerLost where nothing can come any more."""
    waited = 0.0
    while True:
        try:
            return _timed(pool)
        except TimeoutError:
            waited += 1.0
        if client.status not in ("running", "connecting"):
            raise _lost(target, so_far, "the connection is closed")
        if waited >= NO_WORKER_S and not _count(client):
            raise SchedulerLost("%s has no worker any more: %s, the same command goes on from "
                                "there" % (_where(target), so_far()))


def _timed(pool):
    """Next of as_completed within a second, or TimeoutError."""
    import time
    deadline = time.monotonic() + 1.0
    while pool.queue.empty():
        if time.monotonic() > deadline:
            raise TimeoutError
        time.sleep(0.005)
    return next(pool)


def _count(client):
    try:
        return len(client.scheduler_info()["workers"])
    except Exception:
        return 0


def _workers(client, target):
    try:
        client.wait_for_workers(1, timeout=NO_WORKER_S)
    except Exception:
        raise CheckFailed("%s has no worker: start one with dask worker" % _where(target)) \
            from None
    return max(1, _count(client))


def _where(target):
    return "the scheduler at %s" % target.scheduler if target.scheduler else "the local cluster"


def _lost(target, so_far, error):
    return SchedulerLost("%s is lost (%s): %s, the same command goes on from there" % (
        _where(target), worker_versions.in_short(error), so_far()))
