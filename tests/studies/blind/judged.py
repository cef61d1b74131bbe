"""What is right to answer on a case: derived at generation, kept under the seal."""

import numpy as np

from .identifiability import Geometry, plain, share_reproduced, span_of

# Effects in rows and counts show in single samples, not in pose means; no theory is needed.
INTEGRITY = {"quantisation", "dead_band", "saturation", "torn_reads", "stuck_bit", "sample_rate",
             "dropped_samples", "vibration", "axis_swap"}
LAGGED = ("thermal_bias", "thermal_scale")
SILENT_SHARE = 0.01
# GAP.md's protocol-wide index is averaged over coefficients with equal weight.


def judged(case):
    """{"protocol": {sensor: {effect: {...}}}, "effects": [...]}, JSON-ready.

    Of every effect of the library in this protocol: "visible", the share of its signature that
    nothing absorbs, and "aliases", {other: mean index}. Of every effect the case has:
    "distance", its size in sigma after projection; "visible"; "aliases" of what it really does;
    "attainable", the share its own plain form reproduces; "values" {key: true value}: the part's
    own where the library has its form, else what fits its form best; none where that is bent.
    """
    geometry = Geometry(case)
    sensors = {}
    for sensor in ("accel", "gyro"):
        design = geometry.design(sensor)
        library = plain(sensor, case)
        raw = {name: geometry.columns(sensor, [shape for _, shape in pieces])
               for name, pieces in library.items()}
        sensors[sensor] = (design, library, raw,
                           {name: design.seen(columns) for name, columns in raw.items()})
    answer = {"protocol": {s: _protocol(*sensors[s]) for s in sensors}, "effects": []}
    for index, effect in enumerate(case.effects):
        if effect.name in INTEGRITY:
            answer["effects"].append({"by_integrity": True})
            continue
        answer["effects"].append(_effect(case, geometry, index, effect, sensors))
    return answer


def _protocol(design, library, raw, seen):
    out = {}
    for name in library:
        visible = [float(np.sum(s ** 2) / max(np.sum(design.white(r) ** 2), 1e-300))
                   for s, r in zip(seen[name].T, raw[name].T)]
        aliases = {}
        if max(visible) > SILENT_SHARE:
            shown = [s for s, v in zip(seen[name].T, visible) if v > SILENT_SHARE]
            for other in library:
                if other != name:
                    aliases[other] = round(float(np.mean(
                        [share_reproduced(s, seen[other]) for s in shown])), 4)
        out[name] = {"visible": round(max(visible), 6), "aliases": aliases}
    return out


def _effect(case, geometry, index, effect, sensors):
    sensor = "gyro" if effect.sensor == "gyro" else "accel"
    design, library, _, seen = sensors[sensor]
    series = []
    for number in range(len(case.sessions)):
        with_it, without = case.signals(number), case.signals(number, {index})
        series.append(with_it.out(sensor) - without.out(sensor))
    rows = geometry.rows(sensor, series)
    y = design.seen(rows)
    out = {"distance": round(float(np.sqrt(y @ y)), 2),
           "visible": round(design.visible(rows), 6),
           "aliases": {name: round(share_reproduced(y, columns), 4)
                       for name, columns in seen.items() if name != effect.name}}
    if effect.name in library:
        own = seen[effect.name]
        out["attainable"] = round(share_reproduced(y, own), 8)
        values = _values(effect, y, own)
        if values is not None:
            out["own"] = effect.name in LAGGED
            out["values"] = {key: float(v) for (key, _), v in zip(library[effect.name], values)}
    return out


def _values(effect, y, own):
    """One coefficient for each of an effect's plain columns, or None where none is "the" one."""
    if effect.name in LAGGED:
        # the thermometer's lag is the library's too: what the part has is comparable, a
        # straight line against the thermometer is not
        return None if effect.parameters.get("bend") else effect.parameters["size"]
    if effect.name == "warm_up" or span_of(own, 1e-4).shape[1] < own.shape[1]:
        return None
    return np.linalg.lstsq(own, y, rcond=None)[0]
