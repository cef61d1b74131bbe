"""The verdict: a table of four rows on three probabilities, and what holds in none of them.

named      that at least one effect with a name is there
nameless   that something is there which no name of the library stands for
told       of what is named: whether it is known where it comes from; of nothing: whether the
           capture could have shown most of what it is asked about
"""
from dataclasses import dataclass

LIKELY = 0.5  # likelier than not
CLOSED, UPPER_END = 0.9, 0.95  # share of a gap that is all of it; of a 90 % interval, one-sided
ROWS = (  # named, nameless, told: verdict
    (False, True, None, "unexplained"),
    (True, True, None, "partly explained"),
    (True, False, True, "explained"),
    (False, False, True, "no gap"))
OTHERWISE = "cannot tell"


@dataclass(frozen=True)
class Claim:
    """probability that one of a class of names is there; told: they all show themselves in one
    domain, and the share of the gap that goes with them is known; nameless: probability that what
    stands in its place has no name."""

    probability: float
    told: bool
    nameless: float = 0.0


def decide(claims, nameless, seen):
    """The verdict. claims: list of Claim; nameless: probabilities of strangers, of residuals
    beyond noise and of all else without a name; seen: whether a gap could have been seen."""
    named = any_of([c.probability for c in claims])
    strange = any_of([*nameless, *(c.nameless for c in claims)])
    told = any(c.told for c in claims) if named > LIKELY else seen
    for row_named, row_strange, row_told, verdict in ROWS:
        if (row_named, row_strange) == (named > LIKELY, strange > LIKELY) \
                and row_told in (None, told):
            return verdict
    return OTHERWISE


def any_of(probabilities):
    """Largest probability: the tests look at the same samples, and are not independent."""
    return max(probabilities, default=0.0)


def not_closed(interval):
    """Probability that a tenth of the gap and more stays where what was named is taken off: that
    of the upper end of the share's interval, where that lies below (GAP's targets: at least 0.90
    of the explainable gap is closed). interval: (low, high) of the share, or None."""
    return UPPER_END if interval and interval[1] < CLOSED else 0.0


def of_gap(gap):
    """[probability] of what has no name in a sensor_gap.SensorGap: the strangers of the likeliest
    set, each in its place; and what is left, where it is more than noise."""
    strange = [1.0 - gap.posterior.places[form.effect].get("", 0.0) for form in gap.strangers]
    return strange + ([] if gap.adequacy.ok else [1.0 - gap.adequacy.p])
