"""fleet.json: the population of every kind of board, and what stands out, as JSON."""
from ..json_numbers import finite
from . import judgement, members

FORMAT = 1
KIND = "sixflip fleet"
DIGITS = 6


def digits(value):
    """A number with as many digits as anything here means, a list of them likewise."""
    if isinstance(value, (list, tuple)):
        return [digits(one) for one in value]
    return value if value is None else float("%.*g" % (DIGITS, float(value)))


def of(kinds, failures, remarks):
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


def _batch(one):
    return {"batch": one.name, "boards": len(one.boards), "cutoff_sigmas": digits(one.cutoff),
            "parameters": [_parameter(p) for p in one.parameters],
            "blocks": [_block(name, *pair) for name, pair in one.populations.items()],
            "outliers": [_outlier(o) for o in one.outliers]}


def _parameter(p):
    found = {"name": p.name, "unit": p.unit, "mean": digits(p.mean), "error": digits(p.error),
             "spread": digits(p.spread), "nominal": p.nominal, "kind": p.kind,
             "systematic_chance": digits(p.systematic), "individual_chance": digits(p.individual),
             "i2": digits(p.i2), "common_share": digits(p.share),
             "repeats": digits(p.repeats)}
    return dict(found, aliases=list(p.aliases)) if p.aliases else found


def _block(name, block, one):
    return {"block": name, "names": list(block.names), "mean": digits(one.mean.tolist()),
            "covariance": digits(one.spread.tolist()), "error": digits(one.error.tolist()),
            "rare": digits(one.rare)}


def _outlier(o):
    return {"board": o.board, "parameter": o.parameter, "value": digits(o.value),
            "mean": digits(o.mean), "sigma": digits(o.sigma), "sigmas": digits(o.sigmas),
            "chance": digits(o.chance), "why": o.why}


def judged(rows, keys=None):
    """[(Members, [Batch], [LotDifference])] of the rows of a data set: see members.of()."""
    found = []
    for them in members.of(rows, keys):
        batches = judgement.batches(them)
        found.append((them, batches, judgement.lots(batches)))
    return found
