"""What could be added to a protocol, and how much each addition resolves per minute."""
import copy
from dataclasses import dataclass

from . import protocols
from .plan_findings import Findings

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
    found = []
    for name, other in candidates(protocol):
        if most_minutes is not None and other.minutes > most_minutes:
            continue
        new = Findings(other, sensor, certified_box, rate_hz, ranges, prior)
        found.append(Addition(name, other.minutes - protocol.minutes, *gains(base, new)))
    found.sort(key=lambda a: (-a.per_minute, a.minutes))
    return [a for a in found if a.resolves]


def gains(base, new):
    """(pairs, shown, reached) between two Findings of the same effects."""
    before = {(f.effect, f.sensor): f for f in base.list}
    after = {(f.effect, f.sensor): f for f in new.list}
    pairs = set()
    for (effect, sensor), old in before.items():
        for other in old.members:
            if after[(effect, sensor)].silent or after[(other, sensor)].silent:
                continue
            if other not in after[(effect, sensor)].members:
                pairs.add((sensor,) + tuple(sorted((effect, other))))
    shown = [(s, e) for (e, s), old in before.items() if old.silent and not after[(e, s)].silent]
    reached = [(s, e) for (e, s), old in before.items()
               if not old.silent and not old.seen and after[(e, s)].seen]
    return sorted(pairs), sorted(shown), sorted(reached)
