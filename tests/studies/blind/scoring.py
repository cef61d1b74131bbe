"""An answer held against its label: what was right, what was wrong, what must never be."""

SAME = {"stuck_bit": {"quantisation"}, "axis_swap": {"axis_swap"}}
# Where an effect may rightly be said to lie.
DOMAINS = {
    "thermal_bias": {"temperature"}, "thermal_scale": {"temperature", "orientation"},
    "warm_up": {"time", "temperature"}, "thermal_rate": {"temperature"},
    "quadratic": {"orientation", "along_gravity"}, "cubic": {"orientation", "along_gravity"},
    "cross_quadratic": {"orientation", "along_gravity", "across_gravity"},
    "asymmetry": {"orientation", "along_gravity", "flip", "motion", "amplitude"},
    "g_sensitivity": {"orientation"}, "drift": {"time", "noise", "frequency"},
    "quantisation": {"amplitude"}, "stuck_bit": {"amplitude"}, "dead_band": {"amplitude"},
    "saturation": {"amplitude"}, "vibration": {"frequency", "noise"},
    "vibration_rectification": {"frequency", "time", "noise"}, "sample_rate": {"timing"},
    "dropped_samples": {"timing"}, "filter_lag": {"motion", "timing", "frequency", "noise"},
    "hysteresis": {"history", "time_since_move"}, "creep": {"history", "time_since_move"},
    "lever_arm": {"motion"}, "box_tilt": {"across_gravity", "orientation"},
    "torn_reads": {"amplitude", "noise"}, "supply": {"time", "noise"},
    "axis_swap": {"motion", "flip", "orientation"}, "local_gravity": set()}
SILENT, ALIASED = 0.01, 0.95        # GAP.md says 0.9: the margin is for two ways to work it out
DETECTABLE = 5.0                    # sigma
# Units of the answer in ours: g, deg/s, deg C, s.
UNITS = {"mg/°C": 1e-3, "mg/degC": 1e-3, "°/s/°C": 1.0, "deg/s/degC": 1.0, "%/°C": 1e-2,
         "%/degC": 1e-2, "mg/g2": 1e-3, "mg/g²": 1e-3, "mg/g3": 1e-3, "mg/g³": 1e-3,
         "mg/g": 1e-3, "%": 1e-2, "deg/s/g": 1.0, "°/s/g": 1.0, "mg/(degC/min)": 6e-2,
         "mg/(°C/min)": 6e-2, "deg/s/(degC/min)": 60.0, "°/s/(°C/min)": 60.0}
MISFIT = 4.0                        # sigma squared
IN_MOTION = ("lever_arm", "filter_lag")
# What can only be said to be there: nobody writes the voltage down; of a vibration rectified the
# theory here has no column (it is named where some rests are shaken and others are not); a bit
# that sticks has no name of its own unless it is the lowest.
NO_COLUMN = ("supply", "vibration_rectification", "stuck_bit")
WHEN_THERE = ("box_tilt", "table_tilt", "earth_rate")   # in every case's world


def fits(cause, effect):
    """Whether a cause's class holds the effect, in its sensor."""
    names = SAME.get(effect["effect"], {effect["effect"]})
    sensors = {effect["sensor"], "device"}
    if effect["sensor"] == "device" or effect["effect"] == "axis_swap":
        sensors = {"accel", "gyro", "device"}
    return bool(names & set(cause["class"] or [cause["effect"]])) and cause["sensor"] in sensors


def belongs(cause, label):
    """Whether a cause is something that was in the case: an effect, what came with one, or the
    crooked box, leaning table and turning Earth of every case."""
    if any(fits(cause, e) for e in label["effects"]):
        return True
    for effect in label["effects"]:
        if any(fits(cause, {"effect": n, "sensor": s}) for n, s in effect["also"]):
            return True
    names = set(cause["class"] or [cause["effect"]])
    if "box_tilt" in names and not label["habits"].get("box_tilt_deg", 0.1):
        names.discard("box_tilt")
    return bool(names & set(WHEN_THERE))


def never(cause, label):
    """Why this cause must never have been named, or None."""
    if not cause["effect"] or len(cause["class"]) > 1 or cause["effect"] in WHEN_THERE:
        return None
    here = label["judged"]["protocol"].get(cause["sensor"], {}).get(cause["effect"])
    if here is None:
        return None
    if here["visible"] < SILENT:
        return "%s %s is silent in this protocol" % (cause["sensor"], cause["effect"])
    aliases = dict(here["aliases"])
    for effect, theory in zip(label["effects"], label["judged"]["effects"]):
        if effect["effect"] == cause["effect"] and fits(cause, effect):
            # it is there: an alias counts if it could also have done just this
            for other, index in theory.get("aliases", {}).items():
                aliases[other] = min(index, aliases.get(other, 0))
    for other, index in aliases.items():
        if index > ALIASED and other not in label["options"]:   # --without: it could not be told
            return "%s %s is an alias of %s (%.3f)" % (cause["sensor"], cause["effect"], other,
                                                       index)
    return None


def expected(effect, theory, label):
    """How much could be said: "motion", "integrity", "silent", "faint", "other form" (the
    library's form of it reproduces less than half), "aliased" or "clear"."""
    if effect["effect"] in IN_MOTION:
        return "motion"
    if effect["parameters"].get("hidden"):      # a clock nobody wrote down
        return "silent"
    if effect["effect"] in NO_COLUMN:
        return "other form"
    if theory.get("by_integrity"):
        return "integrity"
    if theory["visible"] < 1e-4 or theory["distance"] < 1:
        return "silent"
    if theory["distance"] < DETECTABLE:
        return "faint"
    if theory.get("attainable", 1.0) < 0.5:
        return "other form"
    sensor = "gyro" if effect["sensor"] == "gyro" else "accel"
    indices = dict(theory["aliases"])
    here = label["judged"]["protocol"][sensor].get(effect["effect"], {"aliases": {}})
    for other, index in here["aliases"].items():
        indices[other] = max(index, indices.get(other, 0))
    return "clear" if max(indices.values(), default=0) < 0.8 else "aliased"


def domain_rows(answer, sensor, domains):
    """(listed, first): the right domain among the significant rows of a sensor; the first."""
    rows = [r for r in answer["where"] if sensor in (r["sensor"], "device")
            or r["sensor"] == "device"]
    significant = [r for r in rows if r["p"] is None or r["p"] < 0.01]
    return (any(r["domain"] in domains for r in significant),
            bool(significant) and significant[0]["domain"] in domains)


def intervals(cause, theory):
    """[(key, true, low, high)] in our units, where value and truth mean the same."""
    factor = UNITS.get(cause["unit"])
    if factor is None or "values" not in theory:
        return []
    if not theory["own"] and theory["distance"] ** 2 * (1 - theory["attainable"]) > MISFIT:
        return []       # the library's form of it is visibly another one
    out = []
    biggest = max(abs(v) for v in theory["values"].values())
    for key, bounds in (cause["interval_90"] or {}).items():
        true = theory["values"].get(key)
        if true is not None and abs(true) > 0.2 * biggest and bounds and None not in bounds:
            out.append([key, true, bounds[0] * factor, bounds[1] * factor])
    return out


def scored_effect(effect, theory, label, answer):
    causes = answer["causes"]
    mine = [c for c in causes if fits(c, effect)]
    named = [c for c in mine if c["effect"] in SAME.get(effect["effect"], {effect["effect"]})]
    axes = sorted({a for c in mine for a in c["axes"]})
    domains = set(effect["parameters"].get("domains", [])) or DOMAINS.get(effect["effect"], set())
    listed, first = domain_rows(answer, effect["sensor"], domains)
    gap = answer["gap"].get(effect["sensor"]) or {}
    return {"effect": effect["effect"], "sensor": effect["sensor"],
            "multiple": effect["multiple"],
            "expected": expected(effect, theory, label), "distance": theory.get("distance"),
            "class_right": bool(mine), "name_right": bool(named),
            "axes_right": not axes or axes == effect["axes"], "axes_named": axes,
            "axes_true": effect["axes"], "domain_listed": listed, "domain_first": first,
            "attainable": theory.get("attainable"), "explained_share": gap.get("explained_share"),
            "share_interval": gap.get("interval_90"),
            "intervals": [i for c in named for i in intervals(c, theory)]}


def scored(label, outcome):
    """What one outcome of the run (see blind_run.diagnosed) is worth. JSON-ready."""
    answer = outcome["answer"]
    out = {"id": outcome["id"], "suite": label["suite"], "seed": label["seed"],
           "chip": label["chip"], "protocol": label["protocol"], "habits": label["habits"],
           "options": label["options"], "noise_of": label["noise_of"],
           "new_gyro_offset": label["new_gyro_offset"],
           "code": outcome["code"], "error": outcome["error"], "seconds": outcome["seconds"],
           "cpu_s": outcome["cpu_s"], "verdict": answer["verdict"] if answer else None,
           "truth": [[e["effect"], e["sensor"], e["multiple"]] for e in label["effects"]],
           "named": [], "effects": [], "false": [], "never": []}
    if answer is None:
        return out
    causes = answer["causes"]
    out["named"] = [[c["sensor"], c["effect"] or "|".join(c["class"]), c["score_nats"],
                     c.get("probability")] for c in causes]
    out["where"] = [[r["sensor"], r["axis"], r["domain"], r["p"]] for r in answer["where"]][:6]
    out["false"] = [[c["sensor"], c["effect"] or "|".join(c["class"])]
                    for c in causes if not belongs(c, label)]
    out["single_false"] = [c["effect"] for c in causes if c["effect"] and not belongs(c, label)]
    out["never"] = [reason for reason in (never(c, label) for c in causes) if reason]
    out["share"] = share_held(label, answer, outcome.get("twin"))
    out["effects"] = [scored_effect(e, t, label, answer)
                      for e, t in zip(label["effects"], label["judged"]["effects"])]
    return out


def share_held(label, answer, twin):
    """[share, low, high] of the gap closed, the share worked out with the floor that the same
    noise leaves without the effect (the twin's gap); None without a twin or an interval."""
    if not twin:
        return None
    sensor = label["effects"][0]["sensor"]
    gap, floor = answer["gap"].get(sensor), twin["gap"].get(sensor)
    bounds = (gap or {}).get("interval_90")
    if not floor or not bounds or None in bounds:
        return None
    whole = gap["before"] ** 2 - floor["before"] ** 2
    if whole <= 0:
        return None
    return [min((gap["before"] ** 2 - gap["after"] ** 2) / whole, 1.0), *bounds]
