"""The answer as JSON, in the words and with the keys of GAP.md."""
from sixflip_sim.effects.drift import FLOOR_OF_KERNEL

from ..capture import registers
from ..json_numbers import number, spelled
from ..planning import detectable, next_capture
from . import closed_loop, odds, rest_noise
from .detect import detection, line_frequency, sample_clock
from .simulator import parameters, simulator_answer

OF_COUNTS = 5  # digits of a whole count of 16 bits; of other sizes four
UNITS = {"accel": "mg", "gyro": "deg/s", "gyro_turns": "deg/s", "accel_motion": "mg"}


def as_dict(diagnosis):
    """dict for json.dumps, no NaN in it."""
    answer = {
        "format": 1, "verdict": diagnosis.verdict, "causes": causes(diagnosis),
        "where": [{"sensor": p.sensor, "axis": p.axis, "domain": p.domain,
                   "share": number(p.share), "p": number(p.p, 2)}
                  for p in diagnosis.where],
        "gap": {kind: _gap(kind, gap) for kind, gap in gaps(diagnosis).items()},
        "unseen": detectable.listed(diagnosis), "next": next_capture.proposed(diagnosis),
        "untold": next_capture.untold(diagnosis) if diagnosis.verdict == odds.OTHERWISE else None,
        "clock": sample_clock.answer(diagnosis.sessions, diagnosis.clocks),
        "held_out": held_out(diagnosis), "damage": detection.damages(diagnosis.damages),
        "noise": rest_noise.answer(diagnosis.noise),
        "remarks": diagnosis.remarks}
    if diagnosis.comparisons:
        answer["simulator"] = simulator_answer.as_json(diagnosis.comparisons)
    return answer


def causes(diagnosis):
    """list of dict, the cause of the largest share first."""
    entries = [of_finding(f) for f in diagnosis.findings]
    entries += [_cause(kind, c, diagnosis.conditions.reference_c) for kind, c in diagnosis.causes]
    entries += [_drift(kind, gap) for kind, gap in diagnosis.gaps.items() if gap.drift]
    known = {(e.sensor, e.stands_for): e for comparison in diagnosis.comparisons
             for e in comparison.effects}
    entries = [_by_both_logs(_with_strangers(cause, diagnosis), known.get(
        (cause["sensor"], tuple(cause["class"])))) for cause in entries]
    return sorted(entries, key=lambda c: -(c["share"] or 0.0) - 1e-3 * c["score_nats"])


def gaps(diagnosis):
    """{sensor: SensorGap}; that of the motion where only that shows something."""
    by_sensor = {**diagnosis.rest, **diagnosis.gaps}
    turns = diagnosis.turns
    if turns and turns.causes and not by_sensor["gyro"].causes:
        by_sensor["gyro"] = turns
    moved = any(f.domain == "motion" for f in diagnosis.findings)
    if diagnosis.motion and moved and not by_sensor["accel"].causes:
        by_sensor["accel"] = diagnosis.motion
    return by_sensor


def held_out(diagnosis):
    """What the figures of the gap were checked on."""
    if diagnosis.rest:
        return "pieces of the time, each by the others"
    if not diagnosis.gaps:
        return None
    if any(g.same_session for g in diagnosis.gaps.values()):
        return "same session"
    return "each session by the others"


def _sizes(values, digits=4):
    return {k: number(v, digits) for k, v in values.items()}


def _intervals(intervals, digits=4):
    return {k: [number(end, digits) for end in ends] for k, ends in intervals.items()}


def _entry(sensor, axes, probabilities, score, value, unit, interval, plausible, share):
    """probabilities: {name: probability} of the names of the class, the likeliest first."""
    names = list(probabilities)
    single, digits = len(names) == 1 and plausible, OF_COUNTS if unit == "counts" else 4
    return {"sensor": sensor, "axes": axes, "effect": names[0] if single else None,
            "class": names, "probability": number(min(sum(probabilities.values()), 1.0)),
            "class_probabilities": {k: number(p) for k, p in probabilities.items()},
            "score_nats": number(score), "value": _sizes(value, digits),
            "unit": spelled(unit), "interval_90": _intervals(interval, digits),
            "plausible": plausible, "share": number(share)}


def _with_strangers(cause, diagnosis):
    """A cause with its probabilities lessened by what only looks like it."""
    def stated(probability):
        return number(diagnosis.of_name(cause["sensor"], probability, cause["class"],
                                        cause["share"]))
    return {**cause, "probability": stated(cause["probability"]), "class_probabilities": {
        name: stated(probability) for name, probability in cause["class_probabilities"].items()}}


def _cause(kind, c, reference_c):
    """value_of: whose size is stated, where the class has several names; shape: the parameters of
    the library's effect that do not enter linearly."""
    entry = _entry(kind, c.letters, c.probabilities, c.score, c.value, c.unit, c.interval,
                   c.plausible, c.share)
    if len(entry["class"]) > 1:
        entry["value_of"] = c.effect
    shape = closed_loop.shape(c, reference_c)
    return {**entry, "shape": shape} if shape else entry


def _by_both_logs(cause, effect):
    """A cause with the size that two logs of one motion show (effects_beside.Beside or None): the
    rests of a short log hardly tell a bend from where the box lay."""
    if effect is None:
        return cause
    there = parameters.told(effect.interval)
    axes = sorted({key[0] for key in there if not effect.interval[key][0] <= 0.0
                   <= effect.interval[key][1]}) or cause["axes"]
    named = {"value_of": effect.effect} if len(cause["class"]) > 1 else {}
    return {**cause, **named, "axes": axes, "value": _sizes({k: effect.value[k] for k in there}),
            "interval_90": _intervals({k: effect.interval[k] for k in there}),
            "unit": spelled(effect.unit), "shape": effect.shape}


def of_finding(f):
    """The cause that a detection.Finding is."""
    entry = _entry(f.sensor, f.axes, f.probabilities, f.score, f.value, f.unit,
                   f.interval or {}, f.plausible, f.share)
    if f.share_interval:
        entry["share_interval_90"] = [number(v) for v in f.share_interval]
    if f.limits:
        entry["cut_off_at"] = f.limits
    if f.levels and not f.limits:
        scale, unit = (1e3, "mg") if f.sensor == "accel" else (1.0, registers.UNITS[f.sensor])
        entry["value_in"] = _sizes({axis: scale * size for axis, size in f.levels.items()})
        entry["value_in_unit"] = spelled(unit)
    elif f.levels:
        entry["cut_off_level"] = _sizes(f.levels)
        entry["cut_off_unit"] = spelled(registers.UNITS[f.sensor])
    if f.hz:
        entry["hz"] = {key: number(hz, 7) for key, hz in f.hz.items()}
    if f.lines:
        entry["lines"] = line_frequency.answer(f.lines)
    return entry


def _drift(kind, gap):
    there = {"drift": gap.posterior.places["drift"]["drift"]}
    floor, low, high = (v * FLOOR_OF_KERNEL for v in (
        gap.drift.level, gap.drift.low, gap.drift.high))
    axes = gap.drift.axes or "xyz"
    return _entry(kind, list(gap.drift.axes), there, gap.drift.score, dict.fromkeys(axes, floor),
                  UNITS[kind], dict.fromkeys(axes, (low, high)), True, gap.drift.share)


def _gap(kind, gap):
    figures = _shrinkage(kind, gap.shrinkage)
    if hasattr(gap, "by_axis"):
        figures["axes"] = {key: _shrinkage(kind, shrinkage)
                           for key, shrinkage in gap.by_axis.items()}
    return figures


def _shrinkage(kind, s):
    return {"unit": spelled(UNITS[kind]), "before": number(s.before), "after": number(s.after),
            "floor": number(s.floor), "explained_share": number(s.share),
            "interval_90": None if s.interval is None else [number(v) for v in s.interval]}


def of_loop(kind, loop):
    """Real against simulated, before and after the effects were added."""
    return {"unit": spelled(UNITS[kind]), "before": number(loop.before),
            "after": number(loop.after), "floor": number(loop.floor),
            "explained_share": number(loop.share), "effects": loop.effects}
