"""What a baseline found, in the form of the JSON of `sixflip diagnose`."""


def answer(found, gaps):
    """found: {sensor: [((effect, axis letter), coefficient, score)]}; gaps: {sensor: gap}."""
    causes = []
    for sensor, entries in found.items():
        for effect in dict.fromkeys(name for (name, _), _, _ in entries):
            mine = [(axis, value, score) for (name, axis), value, score in entries
                    if name == effect]
            causes.append({"sensor": sensor, "axes": sorted({a for a, _, _ in mine}),
                           "effect": effect, "class": [effect], "plausible": True,
                           "unit": "", "interval_90": {}, "share": None,
                           "score_nats": float(max(s for _, _, s in mine)),
                           "value": {a: float(v) for a, v, _ in mine}})
    return {"verdict": "explained" if causes else "no gap", "causes": causes, "where": [],
            "effects": sorted({c["effect"] for c in causes}),
            "gap": {k: g for k, g in gaps.items() if g}}
