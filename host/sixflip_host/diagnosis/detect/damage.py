"""What a recording or its scales suffered, which is no effect of a sensor: it has a sentence of
its own, a domain, and no name of the library.

Its score is, as a detection.Finding's, the log likelihood ratio of the samples against the
likeliest explanation that has no name, less what was tried to find it.
"""
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Damage:
    """kind: sign_extension, byte_order, repeats, full_scale, gravity; sensor: accel or gyro;
    axes: letters, () for all three; domain and words (a sentence); score (nats); value: {key:
    number} of what is known of its size."""

    kind: str
    sensor: str
    axes: tuple
    domain: str
    words: str
    score: float
    value: dict = field(default_factory=dict)


def answer(found):
    """[Damage] as a list of dictionaries for --json."""
    return [{"kind": one.kind, "sensor": one.sensor, "axes": list(one.axes),
             "domain": one.domain, "score_nats": round(min(one.score, 1e6), 2),
             "value": dict(one.value), "words": one.words} for one in found]
