"""From log likelihoods to probabilities: the same few lines for every hypothesis, whether it is
made of columns, of a level of noise or of a likelihood over samples.

Hypotheses for one place stand beside "", that nothing is there. Each but that one costs its prior
odds: how rare it is that chance alone gains so much in a search (cutoffs.py).
"""
import math
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
