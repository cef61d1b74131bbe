"""What to capture next: of the captures that can be made by hand within ten minutes, those that
tell the most unresolved pairs of effects apart per minute (GAP stage 7); and why a capture cannot
tell, with what to record to find out."""
import numpy as np

from sixflip.poses import faces

from ..capture import registers
from ..experiment import projection
from . import alias, detectable, protocols
from .plan_findings import SAME_CLASS
from .protocols import rows_of

MOST_MINUTES = 10.0  # of a capture that somebody is asked for, by hand (GAP stage 7)
WORDS = {
    "cooling": "one cooling session, 12 poses", "warm": "one session started warm, 12 poses",
    "backward": "12 poses, then the same backward", "random": "12 poses in random order",
    "leaning": "12 poses and 12 leaning ones",
    "long": "7 poses with a minute of rest on each", "shaken": "12 poses with the vibration on"}


def candidates():
    """{name: SessionPlan}"""
    fixed = protocols.order_of("fixed")
    random = protocols.order_of("random", 11)
    long = protocols.faces_session([1, 3, 5, 7, 9, 11, 2], dwell_s=protocols.LONG_DWELL_S,
                                   state="warm")
    shaken = protocols.faces_session(fixed, state="warm")
    shaken.vibration_mg = protocols.SHAKE_MG
    return {"cooling": protocols.faces_session(random, state="cooling"),
            "warm": protocols.faces_session(random, state="warm"),
            "backward": protocols.faces_session(fixed, backward=True, state="warm"),
            "random": protocols.faces_session(random, state="warm"),
            "leaning": protocols.faces_session(random, 12, state="warm"),
            "long": long, "shaken": shaken}


def present(diagnosis):
    """The protocol that the captures look like, as a plan's sessions."""
    sessions = []
    for session in next(iter(diagnosis.gaps.values())).sessions:
        codes = [run[0] for run in session.runs]
        leaning = sum(f < 0 for f in map(faces.face_of_code, codes))
        on_face = [c for c in codes if 1 <= c <= 12]
        state = "warming"
        if session.temperature is not None:
            change = float(session.temperature[-1] - session.temperature[0])
            state = "cooling" if change < -0.5 else ("warming" if change > 4.0 else "warm")
        dwell = float(np.median([e - f for _, f, e in session.runs])) / session.rate
        plan = protocols.faces_session(on_face, leaning, state=state,
                                       dwell_s=float(np.clip(dwell, 1.0, 120.0)))
        sessions.append(plan)
    return protocols.Protocol("present", sessions)


def pairs(diagnosis):
    """[(sensor, a, b)] that the captures leave unresolved."""
    unresolved = []
    for kind, cause in diagnosis.causes:
        names = cause.names
        unresolved += [(kind, a, b) for i, a in enumerate(names) for b in names[i + 1:]]
    return unresolved


def proposed(diagnosis):
    """list of {capture, minutes, resolves}, the best per minute first; at most three."""
    if not diagnosis.gaps:
        unresolved = [[c.effect, other] for gap in diagnosis.rest.values() for c in gap.causes
                      for other in c.names[1:]]
        return [{"capture": WORDS["cooling"] + _with(diagnosis), "minutes": 4.0,
                 "resolves": unresolved}] if unresolved else []
    wanted = pairs(diagnosis)
    if not wanted:
        return _unseen_help(diagnosis)
    ranked = [(len(resolves) / minutes, words, minutes, resolves) for words, minutes, resolves in
              _by_design(diagnosis, wanted) + _by_hand(wanted) if resolves]
    ranked.sort(key=lambda entry: -entry[0])
    return [{"capture": words, "minutes": round(minutes, 1),
             "resolves": [[a, b] for _, a, b in resolves]}
            for _, words, minutes, resolves in ranked[:3]]


def _by_design(diagnosis, wanted):
    """[(capture, minutes, pairs it resolves)] of the candidates, by their alias index."""
    captures = []
    for name, plan in candidates().items():
        if plan.minutes > MOST_MINUTES:
            continue
        rows = rows_of(protocols.Protocol("added", [*present(diagnosis).sessions, plan]), 2)
        resolves = []
        for kind in sorted({kind for kind, _, _ in wanted}):
            design = alias.PlannedModel(rows, kind, diagnosis.settings.certified)
            resolves += resolved(design, kind, [p for p in wanted if p[0] == kind])
        captures.append((WORDS[name] + _with(diagnosis), plan.minutes, resolves))
    return captures


def _with(diagnosis):
    """What a capture has to have beside its poses: without a thermometer a cooling session tells
    no more than a warming one."""
    measured = all(session.thermometer for session in diagnosis.sessions)
    return "" if measured else ", with its temperature"


def _by_hand(wanted):
    """What no plan's single exponential of temperature can hold."""
    resolves = [p for p in wanted if {p[1], p[2]} == {"thermal_bias", "thermal_rate"}]
    return [("12 poses twice, the box warmed (hair dryer) and left to cool halfway", 7.0,
             resolves)]


def resolved(design, kind, wanted):
    """The pairs that are no longer aliased in a design."""
    known = alias.ACCEL if kind == "accel" else alias.GYRO
    names = {n for _, a, b in wanted for n in (a, b)} & set(known)
    signature = {n: design.signature(n) for n in names}
    apart = []
    for pair in wanted:
        first, second = signature.get(pair[1]), signature.get(pair[2])
        if first is None or second is None:
            continue
        index = max(projection.alias_index(first, second), projection.alias_index(second, first))
        if index < SAME_CLASS:
            apart.append(pair)
    return apart


def _unseen_help(diagnosis):
    """Where nothing is ambiguous: what would let the silent effects speak."""
    gap = next(iter(diagnosis.gaps.values()))
    if any((s.face < 0).any() for s in gap.sessions):
        return []
    return [{"capture": WORDS["leaning"], "minutes": round(candidates()["leaning"].minutes, 1),
             "resolves": [["cubic", "thermal_scale"], ["quadratic", "box_tilt"]]}]


def untold(diagnosis):
    """{why, record} of a diagnosis whose verdict is that it cannot tell: clauses for people."""
    why, record = _beside_simulators(diagnosis) or _of_causes(diagnosis) or _of_nothing(diagnosis)
    return {"why": why, "record": record}


def _beside_simulators(diagnosis):
    """(why, what to record) where it is the logs of a simulator that cannot tell, or None."""
    for x in diagnosis.comparisons:
        between = "between %s and %s" % (x.against, x.log)
        for one in x.conventions:
            if one.one_of:
                return "%s, %s" % (one.words, between), (
                    "both in one motion that turns them about every axis, with rests between")
        if x.shaken:
            return "more of the %s is left %s than noise, and it may be a motion that only one " \
                "of them had" % (" and ".join(registers.SENSORS[k] for k in x.shaken), between), (
                    "both in one motion, the real one with its motors off or on softer ground")
    if diagnosis.comparisons and not any(x.alignment.same for x in diagnosis.comparisons):
        moving = any(x.alignment.moving for x in diagnosis.comparisons)
        alike = sorted({p.name.replace("_", " ") for x in diagnosis.comparisons
                        for p in x.parameters if p.difference_interval and not p.differs})
        return "%s%s, and what each shows by itself is not enough" % (
            "%s are alike in both, but " % ", ".join(alike) if alike else "",
            "the two logs are of different motions" if moving else "neither log moves"), \
            "the simulator in the motion of the real log, with rests of some seconds"
    return None


def _of_causes(diagnosis):
    """(why, what to record) where causes were named and that was not enough, or None."""
    names = sorted({name.replace("_", " ") for _, cause in diagnosis.causes
                    for name in cause.names} | {f.effect.replace("_", " ")
                                                for f in diagnosis.findings})
    if not names:
        return None
    wanted = [entry["capture"] for entry in proposed(diagnosis)[:1]]
    why = "%s would look alike in it" % " and ".join(names) if len(names) > 1 else \
        "how much of the gap %s makes is within its noise" % names[0]
    return why, (wanted or ["the same for longer, with more rests"])[0]


def _of_nothing(diagnosis):
    """(why, what to record) where nothing was found and little would have shown."""
    if not any(session.runs for session in diagnosis.sessions):
        return "it holds no rest, in which a bias, noise or drift would show", (
            "half a minute at rest before and after the motion")
    if not diagnosis.gaps:
        return "its rests are too short, or all in one pose", "rests of some seconds in 12 poses"
    asked = [one for one in detectable.listed(diagnosis) if one["sensor"] in diagnosis.gaps]
    kinds = [one["reason"].split(":")[0] for one in asked]
    kind = max(kinds, key=kinds.count, default="")
    few = sum(len(session.runs) for session in diagnosis.sessions)
    hidden = list(dict.fromkeys(one["effect"].replace("_", " ") for one, mine in zip(
        asked, kinds) if mine == kind))
    why = "its %d rests would not show most effects at the size they usually have (%s: %s%s)" % (
        few, kind, ", ".join(hidden[:3]), " and %d more" % (len(hidden) - 3) if hidden[3:] else "")
    return why, "two sessions of 12 poses and 12 leaning ones, one of them as it warms up"
