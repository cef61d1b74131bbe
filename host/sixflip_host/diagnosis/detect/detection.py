"""An effect read off the samples themselves: registers, timing, spectrum.

Its score is the log likelihood ratio of the samples with the effect against the likeliest of what
has no name: no effect at all, or the stranger of its domain (jumps of any size, codes that are
missing anywhere, gaps of any length, any matrix). What was tried to find it is taken off.
"""
from scipy import stats

from .. import odds


class Finding:
    """effect, sensor, axes ("xyz" letters), value {key: size}, interval {key: (low, high)} or
    None, unit, score in nats, domain, words (a clause for people), rivals ({effect: why}),
    share of what departs from a sound sensor in its domain (of the samples, peaks, gaps or their
    power) that it accounts for, 0 to 1, or None where that is not known; number: of those, which
    tell how well the share is known;
    plausible; place: {name: probability} of what stands here, "" nothing, "~..." nameless; hz:
    {axis: frequency of a steady line}; lines: the line_frequency.Line of each axis."""

    def __init__(self, effect, sensor, axes, value, unit, score, domain, words, interval=None,
                 rivals=None, plausible=True, place=None, hz=None, share=None, number=1,
                 lines=()):
        self.effect, self.sensor, self.axes = effect, sensor, list(axes)
        self.value, self.unit, self.score, self.domain = value, unit, float(score), domain
        self.words, self.interval, self.rivals = words, interval, rivals or {}
        self.plausible, self.hz, self.share = plausible, hz or {}, share
        self.number, self.lines = number, tuple(lines)
        names = [effect, *sorted(self.rivals)]  # which of them, nobody can tell
        self.place = place or dict.fromkeys(names, odds.probability(self.score) / len(names))

    @property
    def share_interval(self):
        """(low, high): 90 % interval of the share, as one of so many that either are accounted
        for or not [Clopper & Pearson, Biometrika 26 (1934) 404], or None."""
        if self.share is None:
            return None
        hit, among = self.share * self.number, max(float(self.number), 1.0)
        low = float(stats.beta.ppf(0.05, hit, among - hit + 1.0)) if hit > 0.0 else 0.0
        return low, float(stats.beta.ppf(0.95, hit + 1.0, among - hit)) if hit < among else 1.0

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
        return sum(p for name, p in self.place.items() if name.startswith("~"))


def present(score):
    """True when an effect is more likely there than HOLDS."""
    return score >= odds.COST + odds.PRESENT
