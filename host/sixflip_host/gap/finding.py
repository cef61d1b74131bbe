"""An effect read off the samples themselves: registers, timing, spectrum."""

CERTAIN = 99.0  # nats written where chance is out of the question


class Finding:
    """effect, sensor, axes ("xyz" letters), value {key: size}, interval {key: (low, high)} or
    None, unit, score in nats, domain, words (a clause for people), rivals ({effect: why})."""

    def __init__(self, effect, sensor, axes, value, unit, score, domain, words, interval=None,
                 rivals=None):
        self.effect, self.sensor, self.axes = effect, sensor, list(axes)
        self.value, self.unit, self.score, self.domain = value, unit, float(score), domain
        self.words, self.interval, self.rivals = words, interval, rivals or {}
