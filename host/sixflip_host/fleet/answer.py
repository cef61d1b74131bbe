"""What `sixflip fleet` leaves in files: fleet.json, the population of every kind of board and what
stands out; estimates.parquet, what is known of each board."""
import contextlib
import os

import numpy as np

from .. import optional
from ..errors import BadFile
from ..json_numbers import finite, number
from . import hierarchy, judgement, members

FORMAT = 1
KIND = "sixflip fleet"
DIGITS = 6
ESTIMATES = "estimates.parquet"


def digits(value):
    """A number with as many digits as anything here means, a list of them likewise."""
    if isinstance(value, (list, tuple)):
        return [digits(one) for one in value]
    return number(value, DIGITS)


def population(kinds, failures, remarks):
    """dict of [(Members, [Batch], [LotDifference])], [(board, sentence)], [sentence]."""
    return finite({"format": FORMAT, "kind": KIND,
                   "groups": [_group(*one) for one in kinds],
                   "failures": [{"board": board, "why": why} for board, why in failures],
                   "remarks": list(remarks)})


def _group(them, batches, lots):
    return {"chip": them.chip, "accel_range_g": them.accel_range_g,
            "gyro_range_dps": them.gyro_range_dps, "boards": len(them.boards),
            "unseen": list(them.unseen), "batches": [_batch(one) for one in batches],
            "lots": [{"batch": one.batch, "parameter": one.parameter,
                      "difference": digits(one.difference), "error": digits(one.error),
                      "chance": digits(one.chance)} for one in lots]}


def _batch(batch):
    return {"batch": batch.name, "boards": len(batch.boards),
            "cutoff_sigmas": digits(batch.cutoff),
            "parameters": [_parameter(p) for p in batch.parameters],
            "blocks": [_block(name, *pair) for name, pair in batch.populations.items()],
            "outliers": [_outlier(o) for o in batch.outliers]}


def _parameter(p):
    fields = {"name": p.name, "unit": p.unit, "mean": digits(p.mean), "error": digits(p.error),
              "spread": digits(p.spread), "nominal": p.nominal, "kind": p.kind,
              "systematic_chance": digits(p.systematic), "individual_chance": digits(p.individual),
              "i2": digits(p.i2), "common_share": digits(p.share),
              "repeats": digits(p.repeats)}
    return dict(fields, aliases=list(p.aliases)) if p.aliases else fields


def _block(name, block, fitted):
    return {"block": name, "names": list(block.names), "mean": digits(fitted.mean.tolist()),
            "covariance": digits(fitted.spread.tolist()), "error": digits(fitted.error.tolist()),
            "rare": digits(fitted.rare)}


def _outlier(o):
    return {"board": o.board, "parameter": o.parameter, "value": digits(o.value),
            "mean": digits(o.mean), "sigma": digits(o.sigma), "sigmas": digits(o.sigmas),
            "chance": digits(o.chance), "why": o.why}


def judged(rows, keys=None):
    """[(Members, [Batch], [LotDifference])] of the rows of a data set: see members.by_kind()."""
    groups = []
    for them in members.by_kind(rows, keys):
        batches = judgement.batches(them)
        groups.append((them, batches, judgement.lots(batches)))
    return groups


def write_estimates(folder, kinds):
    """Write what the batch and a board's own captures say of each board together as a Parquet
    file in a folder: a row a board, of every parameter the shrunk estimate and its standard
    deviation (`NAME_sigma`). [(Members, [Batch], …)], a piece of a batch at a time; BadFile
    where the disk is full."""
    pa, pq = optional.need("sixflip fleet", "fleet", "pyarrow", "pyarrow.parquet")
    names = list(dict.fromkeys(
        name for _, batches, *_ in kinds for batch in batches
        for block, _ in batch.populations.values() for name in block.names))
    schema = pa.schema([*((name, pa.string()) for name in ("batch", "board", "chip")),
                        *((part, pa.float64()) for name in names
                          for part in (name, name + "_sigma"))])
    path = os.path.join(folder, ESTIMATES)
    try:
        with pq.ParquetWriter(path + ".part", schema, compression="zstd") as file:
            for them, batches, *_ in kinds:
                for batch in batches:
                    for cut in hierarchy.cuts(len(batch.boards)):
                        file.write_table(pa.Table.from_pydict(
                            _estimates(them, batch, cut, names), schema=schema))
        os.replace(path + ".part", path)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.unlink(path + ".part")
        why = os.strerror(error.errno) if error.errno else str(error)  # Arrow says it at length
        raise BadFile("%s: cannot be written: %s" % (path, why)) from None


def _estimates(them, batch, cut, names):
    """{column: values} of some boards of a batch; what is not known of them is null."""
    boards = batch.boards[cut]
    known = {"board": boards, "batch": batch.lots[cut], "chip": [them.chip] * len(boards)}
    for block, fitted in batch.populations.values():
        values, sigmas = fitted.shrunk(block.y[cut], block.R[cut], fitted.belongs[cut])
        for j, name in enumerate(block.names):
            known[name], known[name + "_sigma"] = values[:, j], sigmas[:, j]
    nothing = np.full(len(boards), None)
    return {**{part: nothing for name in names for part in (name, name + "_sigma")}, **known}
