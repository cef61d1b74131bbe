"""What a plan tells apart, what could be added to it and how much each addition resolves per
minute, as a dictionary for JSON."""
import copy
import math
from dataclasses import dataclass

from sixflip_sim.effects import typical

from .. import progress
from . import alias, protocols
from .plan_findings import findings_of, kinds_of
from .protocols import rows_of

FREE_MINUTES = 0.25  # an addition that takes no time still takes a thought
LEANING = 12  # as many as there are poses on faces


@dataclass(frozen=True)
class Addition:
    """name, minutes it adds, and what it resolves: pairs of effects now apart, effects that
    were silent and now show, effects whose typical size now shows."""

    name: str
    minutes: float
    pairs: list
    shown: list
    reached: list

    @property
    def resolves(self):
        return len(self.pairs) + len(self.shown) + len(self.reached)

    @property
    def per_minute(self):
        return self.resolves / max(self.minutes, FREE_MINUTES)


def candidates(protocol):
    """[(name, protocol with it)]; those that the protocol has already are left out."""
    first = protocol.sessions[0]
    codes = [r.pose for r in first.rests]
    built = []
    if codes[-1] != codes[0]:
        built.append(("return to the first pose", _returned))
    if codes == [r.pose for r in protocols.named("paper").sessions[0].rests]:
        built.append(("random order", _shuffled))
    if len({c for c in codes if c[0] != "L"}) == len([c for c in codes if c[0] != "L"]):
        built.append(("the poses again backward", _backward))
    if not any(r.leaning for r in first.rests):
        built.append(("%d leaning poses" % LEANING, _leaning))
    if all(s.change_c > 0 for s in protocol.sessions):
        built.append(("a cooling session", _cooling))
    if max(r.dwell_s for s in protocol.sessions for r in s.rests) < protocols.LONG_DWELL_S:
        built.append(("dwell of %g s" % protocols.LONG_DWELL_S, _longer))
    if len({r.turn for r in first.rests}) == 1:
        built.append(("turns both ways", _both_ways))
    if all(s.vibration_mg == 0 for s in protocol.sessions):
        built.append(("the poses again with vibration on", _shaken))
    changed = []
    for name, build in built:
        other = copy.deepcopy(protocol)
        build(other)
        changed.append((name, other))
    return changed


def _returned(protocol):
    protocol.sessions[0].rests.append(copy.copy(protocol.sessions[0].rests[0]))


def _shuffled(protocol):
    rests = {r.pose: r for r in protocol.sessions[0].rests}
    shuffled = protocols.named("random").sessions[0].rests
    protocol.sessions[0].rests = [rests[r.pose] for r in shuffled]


def _backward(protocol):
    rests = protocol.sessions[0].rests
    rests += [copy.copy(r) for r in reversed(rests) if not r.leaning]


def _leaning(protocol):
    rests = protocol.sessions[0].rests
    rests += protocols.leaning_rests(LEANING, 1, dwell_s=rests[0].dwell_s,
                                     move_s=rests[0].move_s)


def _cooling(protocol):
    start, change, tau = protocols.STATES["cooling"]
    session = copy.deepcopy(protocol.sessions[0])
    session.state, session.start_c, session.change_c, session.tau_s = "cooling", start, change, tau
    protocol.sessions.append(session)


def _longer(protocol):
    for session in protocol.sessions:
        for rest in session.rests:
            rest.dwell_s = protocols.LONG_DWELL_S


def _both_ways(protocol):
    for session in protocol.sessions:
        for k, rest in enumerate(session.rests):
            rest.turn = "right" if k // 2 % 2 else "left"


def _shaken(protocol):
    session = copy.deepcopy(protocol.sessions[0])
    session.vibration_mg = protocols.SHAKE_MG
    protocol.sessions.append(session)


def ranked(protocol, base, sensor, certified_box, rate_hz, most_minutes=None,
           ranges=(None, None), prior=None):
    """Additions that resolve something, the most per minute first; those that would make the
    capture longer than most_minutes are left out."""
    additions = []
    for name, other in candidates(protocol):
        if most_minutes is not None and other.minutes > most_minutes:
            continue
        new = findings_of(other, sensor, certified_box, rate_hz, ranges, prior)
        additions.append(Addition(name, other.minutes - protocol.minutes, *gains(base, new)))
    additions.sort(key=lambda a: (-a.per_minute, a.minutes))
    return [a for a in additions if a.resolves]


def gains(base, new):
    """(pairs, shown, reached) between two Findings of the same effects."""
    before = {(f.effect, f.sensor): f for f in base.list}
    after = {(f.effect, f.sensor): f for f in new.list}
    pairs = set()
    for (effect, sensor), old in before.items():
        for other in old.aliases:
            if after[(effect, sensor)].silent or after[(other, sensor)].silent:
                continue
            if other not in after[(effect, sensor)].aliases:
                pairs.add((sensor,) + tuple(sorted((effect, other))))
    shown = [(s, e) for (e, s), old in before.items() if old.silent and not after[(e, s)].silent]
    reached = [(s, e) for (e, s), old in before.items()
               if not old.silent and not old.seen and after[(e, s)].seen]
    return sorted(pairs), sorted(shown), sorted(reached)


def counts(protocol):
    """Equations, residual degrees of freedom and even contrasts for the accelerometer, one
    mean a placement: what is there to see, before any effect is named."""
    rows = rows_of(protocol)
    design = alias.PlannedModel(rows, "accel", certified_box=True, tilt=False)
    return {"equations": 3 * rows.n, "residual": design.freedom,
            "even_contrasts": alias.even_contrasts(rows)}


def planned(protocol, sensor="mpu6050", certified_box=False, rate_hz=100.0, minutes=None,
            ranges=(None, None), prior=None):
    """(dictionary, Findings) of what this Protocol tells apart, and what could be added.

    minutes: how much longer it may become, None: whatever helps; rate_hz: of the samples;
    ranges: full scales in g and deg/s, None: the chip's usual ones; prior: FleetPrior, whose
    sizes stand for the data sheets'.
    """
    progress.doing("what the capture shows")
    findings = findings_of(protocol, sensor, certified_box, rate_hz, ranges, prior)
    progress.doing("what could be added")
    additions = ranked(protocol, findings, sensor, certified_box, rate_hz, minutes, ranges, prior)
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
            "class": {name: round(index, 2) for name, index in sorted(f.aliases.items())},
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
