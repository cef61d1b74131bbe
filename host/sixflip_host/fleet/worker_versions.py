"""Whether the workers of somebody else's cluster have the Dask, the Python and the sixflip that
are here: rows of another layout would be taken for ours."""
from sixflip import __version__

from ..errors import CheckFailed
from . import analysis


def same_dask(distributed, scheduler, versions):
    """CheckFailed where the scheduler or a worker is of another Dask or Python."""
    here = versions["client"]["packages"]
    others = [("the scheduler", versions["scheduler"])] + [
        ("a worker", one) for one in versions["workers"].values()]
    for who, reported in others:
        for package in ("distributed", "dask", "python"):
            there = (reported or {}).get("packages", {}).get(package)
            mine = here.get(package)
            if package == "python":
                there, mine = (".".join(str(v).split(".")[:2]) for v in (there, mine))
            if there != mine:
                raise CheckFailed("--scheduler %s: %s is of %s %s, this is %s: expected the same "
                                  "version on both sides" % (scheduler, who, package, there, mine))


def same_sixflip(client, scheduler):
    """CheckFailed where a worker has no sixflip, or another."""
    try:
        running = client.run(_own_version)
    except Exception as error:  # whatever a worker without sixflip raises
        raise CheckFailed("--scheduler %s: a worker has no sixflip %s (%s): install it there" % (
            scheduler, __version__, in_short(error))) from None
    for worker, version in running.items():
        if version != analysis.VERSION:
            raise CheckFailed("--scheduler %s: the worker %s has row layout %s, this is %s: "
                              "expected the same version on both sides" % (
                                  scheduler, worker, version, analysis.VERSION))


def _own_version():
    return analysis.VERSION


def in_short(error):
    """The first line of an error of Dask's, without what it puts before a reason."""
    words = (str(error) or type(error).__name__).split("\n")[0]
    return words.rpartition("cancelled for reason: ")[2].rstrip(".")[:120]
