"""What is read off the samples themselves (registers, timing, spectrum): an effect of the sensor,
or what a recording or its scales suffered, which has a sentence of its own and no name of the
library.

The score is the log likelihood ratio of the samples with it against the likeliest explanation that
has no name: no effect at all, or the stranger of its domain (jumps of any size, codes that are
missing anywhere, gaps of any length, any matrix). What was tried to find it is taken off.
"""
from dataclasses import dataclass, field

import numpy as np
from scipy import special

from .. import odds

# Where readings are cut off: at the chip's limit, below it, or at a level of a log that does not
# tell where its chip's range ends.
RANGE, BELOW, LEVEL = "range", "below_range", "level"


@dataclass(frozen=True, eq=False)
class Finding:
    """effect, sensor, axes ("xyz" letters), value {key: size}, unit, score in nats, domain, words
    (a clause for people), interval {key: (low, high)} or None, rivals ({effect: why}), plausible;
    share of what departs from a sound sensor in its domain (of the samples, peaks, gaps or their
    power) that it accounts for, 0 to 1, or None where that is not known; number: of those, which
    tell how well the share is known; place: {name: probability} of what stands here, "" nothing,
    by the score where it is not given; hz: {axis: frequency of a steady line};
    lines: the line_frequency.Line of each axis; files: names of the sessions that alone have it,
    () for all; read (3, 3): what is true as swapped axes read it; limits: {axis: RANGE, BELOW or
    LEVEL} of what is cut off; levels: {axis: g or deg/s} of it, where counts are not the chip's
    own; hidden: share of the samples that are missing under a steady clock."""

    effect: str
    sensor: str
    axes: list
    value: dict
    unit: str
    score: float
    domain: str
    words: str
    interval: dict | None = None
    rivals: dict = field(default_factory=dict)
    plausible: bool = True
    share: float | None = None
    number: float = 1
    place: dict | None = None
    hz: dict = field(default_factory=dict)
    lines: tuple = ()
    files: tuple = ()
    read: object = None
    limits: dict = field(default_factory=dict)
    levels: dict = field(default_factory=dict)
    hidden: float = 0.0

    def __post_init__(self):
        if self.place is None:
            names = [self.effect, *sorted(self.rivals)]  # which of them, nobody can tell
            chance = odds.probability(self.score) / len(names)
            object.__setattr__(self, "place", dict.fromkeys(names, chance))

    @property
    def share_interval(self):
        """(low, high): 90 % interval of the share, as one of so many that either are accounted
        for or not [Clopper & Pearson, Biometrika 26 (1934) 404], or None."""
        if self.share is None:
            return None
        hit, among = self.share * self.number, max(float(self.number), 1.0)
        low = float(special.betaincinv(hit, among - hit + 1.0, 0.05)) if hit > 0.0 else 0.0
        return low, float(special.betaincinv(hit + 1.0, among - hit, 0.95)) if hit < among else 1.0

    @property
    def probabilities(self):
        """{effect: probability} of each name of its class."""
        return {name: self.place.get(name, 0.0) for name in [self.effect, *sorted(self.rivals)]}

    @property
    def named(self):
        """Probability that one of its class is there."""
        return sum(self.probabilities.values())

    @property
    def nameless(self):
        """Probability that what stands here has no name."""
        return odds.nameless(self.place)


@dataclass(frozen=True)
class Damage:
    """kind: sign_extension, byte_order, repeats, not read, row order, full_scale, gravity;
    sensor: accel, gyro or device; axes: letters, () for all three; domain and words (a sentence);
    score (nats); value: {key: number} of what is known of its size."""

    kind: str
    sensor: str
    axes: tuple
    domain: str
    words: str
    score: float
    value: dict = field(default_factory=dict)


def present(score):
    """True when an effect is more likely there than HOLDS."""
    return score >= odds.COST + odds.PRESENT


def agreed_by_axis(effect, sensor, sizes, nats, words, numbers):
    """One Finding of what all sessions agree on, axis by axis (3,) in counts; 0 is nothing;
    nats (3,) of each session; numbers (3,): of codes, or of runs of zeros. There is no sample
    that does otherwise: it is all of the gap."""
    least, total = np.min(sizes, axis=0), np.sum(nats, axis=0)
    axes = [i for i in range(3) if least[i] > 1 and present(total[i])]
    if not axes:
        return []
    value = {"xyz"[i]: int(least[i]) for i in axes}
    number = int(np.sum(numbers, axis=0)[axes].sum())
    return [Finding(effect, sensor, ["xyz"[i] for i in axes], value, "counts",
                    sum(total[i] for i in axes), "amplitude", words,
                    {k: (v, v) for k, v in value.items()}, share=1.0, number=number)]


def odd_axes(finding, odd):
    """Those letters of a Finding's axes that are odd, [(sensor, axis letter, ...)]."""
    return {axis for sensor, axis, *_ in odd if sensor == finding.sensor}.intersection(
        finding.axes)


def damages(recording_damages):
    """[Damage] as a list of dictionaries for --json."""
    return [{"kind": damage.kind, "sensor": damage.sensor, "axes": list(damage.axes),
             "domain": damage.domain, "score_nats": round(min(damage.score, 1e6), 2),
             "value": dict(damage.value), "words": damage.words} for damage in recording_damages]
