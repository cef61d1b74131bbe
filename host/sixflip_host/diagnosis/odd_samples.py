"""Codes and noise at rest that no effect of the library makes, and the findings that give way to
them: steps of which many are missing, lines that pulses have at each multiple."""
from dataclasses import replace

import numpy as np

from ..capture import registers
from .detect import codes, noise_shape, spectral_lines
from .detect.detection import RANGE, present

OWN_SHAPE = {"torn_reads", "dead_band", "saturation"}  # what makes samples anything but normal


def uneven(sessions, findings, stuck):
    """(findings that stay, [(sensor, axis letter, nats)] whose codes are uneven) of Sessions;
    stuck: sensors with a bit that is, which leaves codes out."""
    odd = _uneven(sessions, findings, stuck)
    return [f for f in (_full_grids(f, odd) for f in findings) if f], odd


def not_normal(sessions, findings, leaping):
    """(findings that stay, [(sensor, axis letter, nats, times the variance, skewness)] whose noise
    is not normal) of Sessions without spikes; leaping: sensors whose codes leap anyhow."""
    odd = _not_normal(sessions, findings, leaping)
    rate = sessions[0].rate
    return [f for f in (_lines_alone(f, odd, rate) for f in findings) if f], odd


def _uneven(sessions, findings, stuck):
    """Axes whose codes at rest, counted in the steps that were found, are by far not as frequent
    as those around them."""
    uneven = []
    sizes = {(f.effect, f.sensor, axis): f.value[axis] for f in findings
             if f.effect in ("quantisation", "dead_band") for axis in f.axes}
    for sensor in (kind for kind in registers.SENSORS if kind not in stuck):
        read = [s for s in registers.of_counts(sessions, sensor)
                if getattr(s.capture, sensor) is not None]
        for k, axis in enumerate("xyz"):
            step = sizes.get(("quantisation", sensor, axis), 1)
            band = sizes.get(("dead_band", sensor, axis), 0)
            rests = []
            for session in read:
                column = getattr(session.capture, sensor)[:, k].astype(np.int32)
                about = codes.resting(column) if band else 0
                rests += [(column[run.first:run.end] - about) // step for run in session.runs]
            nats = codes.uneven_nats(rests, 1 + band // step)
            if present(nats):
                uneven.append((sensor, axis, nats))
    return uneven


def _not_normal(sessions, findings, leaping):
    """Axes whose noise is not normal where neither its codes nor what is found in single samples
    make it so; leaping: sensors whose codes do."""
    odd = []
    for sensor in (kind for kind in registers.SENSORS if kind not in leaping):
        own = {f.effect: f for f in findings if f.sensor == sensor}
        if OWN_SHAPE.intersection(own):
            continue
        powers = {}
        if "vibration" in own:
            unit = registers.unit_of_count(sessions[0].capture.meta, sensor)
            powers = {axis: 0.5 * (size / unit) ** 2
                      for axis, size in own["vibration"].value.items()}
        odd += [(sensor, *axis) for axis in noise_shape.odd(sessions, sensor, powers)]
    return odd


def _full_grids(finding, uneven):
    """The Finding without axes whose codes are `uneven`: steps that are not all there are none,
    codes that are missing near 0 as elsewhere are no dead band, and where a sensor leaves codes
    out many peaks end at one below its rail, and many low bytes are that of the sample before.
    None where none is left."""
    odd = _axes_of(finding, uneven)
    if any(sensor == finding.sensor for sensor, *_ in uneven):
        if finding.effect == "torn_reads":
            return None
        if finding.effect == "saturation":
            odd = {axis for axis, limit in finding.limits.items() if limit != RANGE}
    if finding.effect not in ("quantisation", "dead_band", "saturation") or not odd:
        return finding
    axes = [axis for axis in finding.axes if axis not in odd]
    return replace(finding, axes=axes, place=None, **{
        name: {a: size for a, size in getattr(finding, name).items() if a in axes}
        for name in ("value", "interval", "limits", "levels")},
        **{name: getattr(finding, name) * len(axes) / len(finding.axes)
           for name in ("score", "number")}) if axes else None


def _lines_alone(finding, shaped, rate):
    """The Finding without lines of axes of which far more is not normal: what comes again as a
    pulse has a line at each multiple. None where none is left."""
    odd = _axes_of(finding, shaped)
    if finding.effect != "vibration" or not odd:
        return finding
    lines = [line for line in finding.lines if line.letter not in odd]
    return spectral_lines.told(lines, finding.sensor, rate) if lines else None


def _axes_of(finding, odd):
    """Those letters of a Finding's axes that are odd, [(sensor, axis letter, ...)]."""
    return {axis for sensor, axis, *_ in odd if sensor == finding.sensor}.intersection(
        finding.axes)
