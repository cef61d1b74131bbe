"""What a fleet says of an effect's size in the next board of its kind: the population of
fleet.json instead of a data sheet's typical size.

The variance is that of the batch about zero, mean² + spread², and of the few boards that are not
of the batch, which may have what any part may: their share is what was found, at least 1 / (n + 2)
after n boards that all were of it [Laplace's rule of succession].
"""
import json
import math
from dataclasses import dataclass

from .. import atomic_write
from ..errors import BadFile
from ..value_kinds import Fields, ListOf, Misfit, Number, Text

NUMBER = Number(-1e12, 1e12)
PARAMETER = Fields("name mean error spread", name=Text(), mean=NUMBER, error=Number(0.0, 1e12),
                   spread=Number(0.0, 1e12))
BLOCK = Fields("names", names=ListOf(Text()), rare=Number(0.0, 1.0))
BATCH = Fields("boards parameters blocks", boards=Number(1, 10 ** 9, whole=True),
               parameters=ListOf(PARAMETER), blocks=ListOf(BLOCK))
GROUP = Fields("chip batches", chip=Text(), batches=ListOf(BATCH))
FILE = Fields("format kind groups", format=Number(1, 1, whole=True), kind=Text(),
              groups=ListOf(GROUP))
NAMED = ("accel", "gyro")


@dataclass(frozen=True)
class FleetPrior:
    """second: {(sensor, effect, key): mean of the squares over the batch}, rare: {the same: share
    of boards that are not of it}; boards: how many; source: words for people."""

    second: dict
    rare: dict
    boards: int
    source: str

    def deviation(self, sensor, effect, key, usual):
        """Standard deviation about zero of a coefficient in the next board, or None where the
        fleet says nothing of it; usual: the deviation that any part has."""
        at = sensor, effect, key
        if at not in self.second:
            return None
        rare = self.rare[at]
        return math.sqrt((1.0 - rare) * self.second[at] + rare * usual ** 2)

    def size(self, sensor, effect):
        """Typical size over the keys of an effect: root of the mean square of the largest; None
        where nothing is known."""
        squares = [value for (s, e, _), value in self.second.items() if (s, e) == (sensor, effect)]
        return math.sqrt(max(squares)) if squares else None


def read(path, chip):
    """FleetPrior of a chip from a fleet.json; BadFile where it is none, or knows no such chip."""
    try:
        content = FILE.take(json.loads(atomic_write.read_bytes(path).decode("utf-8")))
        if content["kind"] != "sixflip fleet":
            raise ValueError("its kind is %r" % content["kind"][:40])
    except Misfit as misfit:
        raise BadFile("%s: %s in what should be a fleet.json of sixflip fleet" % (path, misfit)) \
            from None
    except (ValueError, RecursionError) as error:
        raise BadFile("%s: %s, expected a fleet.json that sixflip fleet wrote" % (
            path, str(error)[:80].replace("\n", " "))) from None
    batches = [batch for group in content["groups"] if group["chip"] == chip
               for batch in group["batches"]]
    if not batches:
        raise BadFile("%s: no boards with a %s in it, expected a fleet of that chip: it has %s" % (
            path, chip, ", ".join(dict.fromkeys(g["chip"] for g in content["groups"])) or "none"))
    return _of_batches(path, batches)


def _of_batches(path, batches):
    sums, rare, number = {}, {}, {}
    for batch in batches:
        share = {name: block.get("rare") or 0.0 for block in batch["blocks"]
                 for name in block["names"]}
        for p in batch["parameters"]:
            at = tuple(p["name"].split("."))
            if len(at) != 3 or at[0] not in NAMED:
                continue
            n = batch["boards"]
            sums[at] = sums.get(at, 0.0) + n * (p["mean"] ** 2 + p["spread"] ** 2
                                                + p["error"] ** 2)
            rare[at] = rare.get(at, 0.0) + n * share.get(p["name"], 0.0)
            number[at] = number.get(at, 0) + n
    boards = sum(batch["boards"] for batch in batches)
    return FleetPrior({at: value / number[at] for at, value in sums.items()},
                      {at: max(value / number[at], 1.0 / (number[at] + 2))
                       for at, value in rare.items()},
                      boards, "%s, %d boards" % (path, boards))
