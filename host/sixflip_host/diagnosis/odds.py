"""From log likelihoods to probabilities, the same few lines for every hypothesis, whether it is
made of columns, of a level of noise or of a likelihood over samples; and from those to the
verdict.

Hypotheses for one place stand beside "", that nothing is there. Each but that one costs its prior
odds: how rare it is that chance alone gains so much in a search (cutoffs.py).

The verdict is a table of four rows on three probabilities, and what holds in none of them:

named      that at least one effect with a name is there
nameless   that something is there which no name of the library stands for
told       of what is named: whether it is known where it comes from; of nothing: whether the
           capture could have shown most of what it is asked about
"""
import math
from dataclasses import dataclass
from statistics import NormalDist

from ..experiment.terms import is_stranger

HOLDS = 0.95  # probability that a class of names must hold
PRESENT = math.log(HOLDS / (1.0 - HOLDS))  # nats beyond its cost: more likely there than not
CHANCE = 0.005  # two sensors, turns, moves, box, registers and spectra share 5 %, with room
COST = -math.log(CHANCE)  # nats of a hypothesis over samples, whose chance is in its likelihood
INSIDE = 2.0  # causes of the library for one that is not, in recordings made elsewhere
RARER = math.log(INSIDE)  # nats
BESIDE = 2.0  # readings with one cause for one with two: less can be told by which are seen
ENDS_90 = 0.05, 0.95  # quantiles between which 90 % lies
Z_90 = NormalDist().inv_cdf(0.95)  # standard deviations to either end of a 90 % interval
SMALLEST = 1e-300  # of a probability: what a float holds
LIKELY = 0.5  # likelier than not
CLOSED, UPPER_END = 0.9, 0.95  # share of a gap that is all of it; of a 90 % interval, one-sided
ROWS = (  # named, nameless, told: verdict
    (False, True, None, "unexplained"),
    (True, True, None, "partly explained"),
    (True, False, True, "explained"),
    (False, False, True, "no gap"))
OTHERWISE = "cannot tell"


def shares(scores):
    """{name: probability} of {name: log likelihood less cost}, names below 1e-6 left out."""
    top = max(scores.values())
    weights = {name: math.exp(value - top) for name, value in scores.items()}
    total = sum(weights.values())
    return {name: w / total for name, w in weights.items() if w / total > 1e-6}


def nameless(place):
    """Probability that what stands in a place ({name: probability}) has no name."""
    return sum(p for name, p in place.items() if name and is_stranger(name))


def of_name(probability, mimicked, outside, beside=1.0):
    """Probability that a named cause is the one that is there. probability: that among all
    hypotheses; mimicked: share of the causes outside the library that look like one inside, so
    alike that no likelihood tells them apart; outside: number of causes without a name in the
    same captures; beside: BESIDE where one of them is in the same readings.
    Of all causes INSIDE to 1 are in the library before anything is seen, and each one seen outside
    counts as one [Laplace's rule of succession; Jaynes, Probability Theory (2003), section 18.6].
    """
    return probability / (1.0 + beside * (1.0 + outside) / INSIDE * mimicked)


def probability(score):
    """That something is there which gains so many nats over nothing and over what is nameless."""
    return 1.0 / (1.0 + math.exp(min(COST - score, 700.0)))


def chance(nats):
    """Largest probability with which chance alone gains so many nats: a likelihood ratio has a
    mean of one without an effect, so it exceeds exp(nats) with probability exp(-nats) at most
    [Markov's inequality; Royall, Statistical Evidence (1997), section 1.4]."""
    return max(math.exp(-max(nats, 0.0)), SMALLEST)


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
