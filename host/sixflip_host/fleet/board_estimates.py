"""What the batch and a board's own captures say of each board together, as a Parquet file: a row
a board, of every parameter the shrunk estimate and its standard deviation (`NAME_sigma`)."""
import contextlib
import os

import numpy as np

from .. import optional
from ..errors import BadFile
from . import hierarchy

NAME = "estimates.parquet"


def write(folder, kinds):
    """Write the boards of [(Members, [Batch], …)] into a folder, a piece of a batch at a time.
    BadFile where the disk is full."""
    pa, pq = optional.need("sixflip fleet", "fleet", "pyarrow", "pyarrow.parquet")
    names = list(dict.fromkeys(
        name for _, batches, *_ in kinds for batch in batches
        for block, _ in batch.populations.values() for name in block.names))
    schema = pa.schema([*((name, pa.string()) for name in ("batch", "board", "chip")),
                        *((part, pa.float64()) for name in names
                          for part in (name, name + "_sigma"))])
    path = os.path.join(folder, NAME)
    try:
        with pq.ParquetWriter(path + ".part", schema, compression="zstd") as file:
            for them, batches, *_ in kinds:
                for batch in batches:
                    for cut in hierarchy.cuts(len(batch.boards)):
                        file.write_table(pa.Table.from_pydict(
                            _columns(them, batch, cut, names), schema=schema))
        os.replace(path + ".part", path)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.unlink(path + ".part")
        why = os.strerror(error.errno) if error.errno else str(error)  # Arrow says it at length
        raise BadFile("%s: cannot be written: %s" % (path, why)) from None


def _columns(them, batch, cut, names):
    """{column: values} of some boards of a batch; what is not known of them is null."""
    boards = batch.boards[cut]
    found = {"board": boards, "batch": batch.lots[cut], "chip": [them.chip] * len(boards)}
    for block, one in batch.populations.values():
        values, sigmas = one.shrunk(block.y[cut], block.R[cut], one.belongs[cut])
        for j, name in enumerate(block.names):
            found[name], found[name + "_sigma"] = values[:, j], sigmas[:, j]
    nothing = np.full(len(boards), None)
    return {**{part: nothing for name in names for part in (name, name + "_sigma")}, **found}
