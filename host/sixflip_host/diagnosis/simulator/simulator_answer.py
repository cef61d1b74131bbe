"""The comparison with a simulator as JSON, what is said of its logs, and what it makes of the
verdict."""
from ...capture.registers import SENSORS
from ...json_numbers import number, spelled


def as_json(comparisons):
    """{"conventions": [...], "parameters": {...}, "task": {...}, ...} of a list of Comparison;
    the log of the same motion, or else the first, gives parameters, task and gap."""
    best = main(comparisons)
    return {
        "conventions": [convention(c, x.log) for x in comparisons for c in x.conventions],
        "parameters": numbers(best.parameters),
        "effects": [effect(x) for x in best.effects],
        "task": None if best.task is None else {
            "estimator": best.task.estimator, "against": best.task.against, "unit": "°",
            "attitude": rounded(best.task.attitude), "heading": rounded(best.task.heading)},
        "gap": {kind: {"unit": "mg" if kind == "accel" else "deg/s", "before": number(before),
                       "after": number(after), "floor": number(floor)}
                for kind, (before, after, floor) in best.gap.items()},
        "reference_c": number(best.reference_c),
        "logs": [log(x) for x in comparisons],
        "unseen": list(dict.fromkeys(s for x in comparisons for s in x.unseen)),
    }


def main(comparisons):
    """The Comparison that says most."""
    return max(comparisons, key=lambda x: (x.alignment.same, x.alignment.correlation))


def log(x):
    """One log of the simulator: against which real one, whether of one motion, clock, remarks."""
    a = x.alignment
    return {"log": x.log, "against": x.against, "same_motion": a.same,
            "correlation": number(a.correlation),
            "offset_s": number(a.offset_s, 6) if a.same else None,
            "offset_interval_90": [number(a.offset_s - 1.645 * a.offset_sigma_s, 6),
                                   number(a.offset_s + 1.645 * a.offset_sigma_s, 6)]
            if a.same else None, "remarks": list(x.remarks)}


def convention(c, name):
    """A Convention found in the log of this name."""
    return {"name": c.name, "sensor": c.sensor, "class": list(c.one_of or (c.name,)),
            "probability": number(c.probability), "score_nats": number(min(c.nats, 1e6)),
            "value": {k: v if isinstance(v, str) else number(v) for k, v in c.value.items()},
            "unit": c.unit, "interval_90": {k: [number(v) for v in span]
                                            for k, span in c.interval_90.items()},
            "words": c.words, "set": c.set_to, "log": name}


def effect(beside):
    """value: of the effect named, which stands for its class."""
    return {"effect": beside.effect, "sensor": beside.sensor, "class": list(beside.stands_for),
            "value": {k: number(v) for k, v in beside.value.items()},
            "unit": spelled(beside.unit),
            "interval_90": {k: span(v) for k, v in beside.interval.items()}, "shape": beside.shape}


def numbers(parameters):
    """{sensor: {name: {axis or "all": {...}}}}"""
    by_sensor = {}
    for p in parameters:
        place = by_sensor.setdefault(p.sensor, {}).setdefault(p.name, {})
        place[p.axis or "all"] = {
            "unit": p.unit, "real": number(p.real, whole(p)),
            "real_interval_90": span(p.real_interval),
            "simulator": number(p.simulated),
            "simulator_interval_90": span(p.simulated_interval),
            "difference": number(p.difference),
            "difference_interval_90": span(p.difference_interval), "differs": p.differs,
            "set": number(p.set_to, whole(p)), "how": p.how}
        if p.form:
            place[p.axis or "all"]["form"] = p.form
    return by_sensor


def whole(parameter):
    """Significant digits of a Parameter's value: a step stands in readings thousands of times."""
    return 9 if parameter.name in ("step", "range") else 4


def span(interval):
    """[low, high] of an interval, or None."""
    return None if interval is None else [number(x) for x in interval]


def rounded(values):
    """{key: number} to four digits."""
    return {k: number(v) for k, v in values.items()}


def _known(x):
    """Whether what both sensors of a Comparison read by themselves is known, and is alike."""
    return None not in (x.real, x.simulated) and not x.otherwise


def verdict(effects, comparisons, named_effects=False):
    """The verdict over all layers; effects: that of the effects' layer alone; named_effects: it
    names some, be it under several names."""
    unexplained = any(x.unexplained for x in comparisons)
    undecided = any(c.one_of for x in comparisons for c in x.conventions)
    named = any(c.name != "unknown" for x in comparisons for c in x.conventions)
    explains = named or any(x.differs for x in comparisons)
    left = effects in ("unexplained", "partly explained")
    if unexplained or left:
        return "partly explained" if explains or effects == "partly explained" else "unexplained"
    shaken = any(x.shaken for x in comparisons)
    if explains:
        return "partly explained" if shaken else "explained"
    if undecided or shaken:
        return "cannot tell"
    if effects == "cannot tell" and not named_effects and all(
            x.alignment.same and x.motion_judged for x in comparisons):
        return "no gap"
    if effects == "no gap" and not any(x.fits or _known(x) for x in comparisons):
        return "cannot tell"  # neither compared, nor is what each sensor is known by itself
    return effects


def _drowned(trace):
    """Of which sensors of a Trace the noise is not known, in words."""
    kinds = [SENSORS[kind] for kind, noise in trace.noise.items() if noise is None]
    return ": that of the %s is not told from what shakes it" % " and the ".join(kinds) \
        if kinds else ""


def said_of(real, sim, aligned):
    """Sentences on the two logs."""
    logs = sim.name, real.name, aligned.by, aligned.correlation
    sentences = [
        "%s and %s are of one motion (correlation of the %s %.3f): offset %.3f ± %.3f s, "
        "%.0f s together" % (*logs, aligned.offset_s, 1.645 * aligned.offset_sigma_s,
                             aligned.overlap_s) if aligned.same else
        "%s and %s are of different motions (correlation of the %s %.2f): each was held "
        "against its own rests and moves" % logs if aligned.moving and aligned.overlap_s else
        "%s and %s are together for too short to show whether they are of one motion: each was "
        "held against its own rests and moves" % logs[:2] if aligned.moving else
        "neither %s nor %s turns more than its noise, and both rest nearly all the time: there is "
        "no motion to be compared, each was held against its own rests" % logs[:2]]
    for trace in (real, sim):
        if not trace.rests:
            sentences.append("no rest in %s: gravity and the gyro's bias are known in it on "
                             "average alone, and its noise by the quick end of its spectrum%s" % (
                                 trace.name, _drowned(trace)))
        if trace.rate is None:
            sentences.append("no gyro in %s" % trace.name)
    if abs(real.rate_hz / sim.rate_hz - 1.0) > 0.02:
        sentences.append("%s has %.4g rows a second, %s %.4g: compared on one grid" % (
            sim.name, sim.rate_hz, real.name, real.rate_hz))
    return sentences
