"""Every canonical effect by its name, and making one from what a scenario says."""
from sixflip_sim.effects import (
    coupling,
    drift,
    memory,
    nonlinearity,
    registers,
    surroundings,
    thermal,
    timing,
)
from sixflip_sim.effects.effect import BadEffect

CLASSES = (
    thermal.ThermalBias, thermal.ThermalScale, thermal.WarmUp, thermal.ThermalRate,
    nonlinearity.Quadratic, nonlinearity.CrossQuadratic, nonlinearity.Cubic,
    nonlinearity.Asymmetry, coupling.GSensitivity, drift.Drift, registers.Quantisation,
    registers.DeadBand, registers.Saturation, surroundings.Vibration,
    nonlinearity.VibrationRectification, timing.SampleRate, timing.DroppedSamples,
    timing.FilterLag, memory.Hysteresis, memory.Creep, surroundings.LeverArm,
    surroundings.BoxTilt, surroundings.TableTilt, surroundings.LocalGravity,
    registers.TornReads, coupling.Supply, registers.AxisSwap, coupling.EarthRate)
EFFECTS = {cls.name: cls for cls in CLASSES}
NAMES = tuple(cls.name for cls in CLASSES)


def make(spec):
    """An effect from {"effect": name, "sensor": "accel", key: size, parameter: value}.

    Raises BadEffect with one sentence that says what was expected.
    """
    if not isinstance(spec, dict) or "effect" not in spec:
        raise BadEffect("an effect needs its name: effect = \"thermal_bias\"; got %r" % (spec,))
    name = spec["effect"]
    if not isinstance(name, str) or name not in EFFECTS:
        raise BadEffect("unknown effect %r, expected one of: %s" % (name, " ".join(NAMES)))
    cls = EFFECTS[name]
    values, shape = {}, {}
    for key in spec:
        if key in cls.keys:
            values[key] = spec[key]
        elif key in cls.shapes:
            shape[key] = spec[key]
        elif key not in ("effect", "sensor"):
            wanted = list(cls.keys) + sorted(cls.shapes)
            raise BadEffect("%s has no %r, expected %s" % (name, key, " ".join(wanted)))
    return cls(spec.get("sensor"), values, shape)
