"""What a plan says, as a dictionary for JSON."""

import math

from sixflip_sim.effects import typical

from .. import progress
from ..experiment.session_rows import rows_of
from . import alias, plan_additions
from .plan_findings import Findings, kinds_of


def counts(protocol):
    """Equations, residual degrees of freedom and even contrasts for the accelerometer, one
    mean a placement: what is there to see, before any effect is named."""
    rows = rows_of(protocol)
    design = alias.PlannedModel(rows, "accel", certified_box=True, tilt=False)
    return {"equations": 3 * rows.n, "residual": design.freedom,
            "even_contrasts": alias.even_contrasts(rows)}


def planned(protocol, sensor="mpu6050", certified_box=False, rate_hz=100.0, minutes=None,
            ranges=(None, None), prior=None):
    """The answer as a dictionary: what this Protocol tells apart, and what could be added.

    minutes: how much longer it may become, None: whatever helps; rate_hz: of the samples;
    ranges: full scales in g and deg/s, None: the chip's usual ones; prior: FleetPrior, whose
    sizes stand for the data sheets'.
    """
    progress.doing("what the capture shows")
    findings = Findings(protocol, sensor, certified_box, rate_hz, ranges, prior)
    progress.doing("what could be added")
    additions = plan_additions.ranked(protocol, findings, sensor, certified_box, rate_hz, minutes,
                                      ranges, prior)
    answer = as_dict(protocol, sensor, certified_box, findings, additions)
    answer.update(rate_hz=rate_hz, noise={
        kind: [rounded(sigma) for sigma in typical.noise_of(sensor, kind, rate_hz, full_scale)]
        for kind, full_scale in zip(("accel", "gyro"), ranges) if kind in kinds_of(sensor)})
    return answer, findings


def as_dict(protocol, sensor, certified_box, findings, additions):
    """The answer of --json; null for a size that no sample could show."""
    effects = []
    for f in findings.list:
        effects.append({
            "effect": f.effect, "sensor": f.sensor, "unit": f.unit, "silent": f.silent,
            "absorbed_by": f.absorbed or None,
            "smallest": None if math.isinf(f.smallest) else rounded(f.smallest),
            "typical": f.typical, "source": f.source, "seen_at_typical_size": f.seen,
            "class": {name: round(index, 2) for name, index in sorted(f.members.items())},
            "how": f.how or None})
    return {
        "format": 1, "protocol": protocol.name, "sensor": sensor,
        "certified_box": certified_box, "minutes": round(protocol.minutes, 2),
        "placements": sum(len(s.rests) for s in protocol.sessions),
        "sessions": [s.state for s in protocol.sessions], "accel": counts(protocol),
        "effects": effects,
        "alias": {kind: {"names": names, "index": [[round(float(v), 3) for v in row]
                                                   for row in index]}
                  for kind, (names, index) in findings.matrices.items()},
        "additions": [{
            "add": a.name, "minutes": round(a.minutes, 2), "per_minute": round(a.per_minute, 2),
            "tells_apart": [list(p) for p in a.pairs], "no_longer_silent": [list(s)
                                                                             for s in a.shown],
            "typical_size_reached": [list(r) for r in a.reached]} for a in additions]}


def rounded(value):
    """Three significant digits: more would claim what the formula does not know."""
    return float("%.3g" % value)
