"""The capture of a simulated world at numpy's speed: of one session of a scenario, or of all that
is planned in a world."""

import numpy as np

from sixflip import STANDARD_G
from sixflip.chips import probe
from sixflip.poses import faces
from sixflip_sim import noise, worlds
from sixflip_sim.effects import make as make_effects
from sixflip_sim.effects.library import make as make_effect

from ..capture.capture_file import Capture
from . import motion_scenes, simulator

SATURATED = 0.9  # share of samples on a rail at which a scenario saturates throughout
MOST_SAMPLES = 50_000_000
_DROPS = 0x500  # channel of the noise: which samples are lost


def session(plan, number):
    """The Capture of one session of a scenario; ValueError when it saturates throughout."""
    spec = plan.worlds[number]
    world = worlds.make(dict(spec, effects=[]))
    world.model.effects = make_effects(spec["effects"], spec["seed"], number)
    simulator.vectorise(world.model)
    end_us = _scene(plan, world)
    imu, _ = probe.find(world.i2c)
    imu.configure(plan.rate_hz)
    outputs = {o.kind: o for o in simulator.outputs_of(world.chips)}
    t_us, look_us = polls(plan, end_us)
    counts = {}
    for kind, output in outputs.items():
        k = simulator.polled(output, look_us)
        counts[kind] = simulator.counts(world.model, output, k).astype(np.int16)
        if kind != "temp":
            _not_saturated(counts[kind], output, kind)
    meta = dict(imu.metadata())
    meta["g"] = spec.get("g", STANDARD_G)
    meta["simulated"] = {"seed": plan.seed, "session": number, "scene": plan.scene,
                         "effects": plan.effects}
    pose = labels(world, look_us, bool(plan.moving))
    capture = Capture(meta, t_us, counts["accel"].T,
                      counts["gyro"].T if "gyro" in counts else None,
                      counts["temp"][0] if "temp" in counts else None, None, pose)
    return without_lost(capture, plan.effects, spec["seed"])


def capture_of(world, rate_hz=100):
    """Capture of all that is planned in a world, polled at rate_hz; its rests are labelled."""
    imu, _ = probe.find(world.i2c)
    imu.configure(rate_hz)
    n = int(world.scene.end_us() * 1e-6 * rate_hz)
    t_us = np.rint(np.arange(n) * (1e6 / rate_hz)).astype(np.int64)
    counts = {}
    for output in simulator.outputs_of(world.chips):
        k = simulator.polled(output, t_us)
        counts[output.kind] = simulator.counts(world.model, output, k).astype(np.int16)
    meta = dict(imu.metadata(), g=world.scene.g)
    return Capture(meta, t_us, counts["accel"].T, counts["gyro"].T if "gyro" in counts else None,
                   counts["temp"][0] if "temp" in counts else None, None,
                   labels(world, t_us, False))


def _scene(plan, world):
    """Prepare the scene; returns the time at which the capture ends, in us."""
    if plan.moving:
        place = {"g": world.scene.g, "lever_arm": world.scene.lever_arm}
        moving = motion_scenes.Turntable(**place) if plan.moving == "turntable" \
            else motion_scenes.Drive(plan.seconds, **place)
        moving.temperature_c, moving.warm_c, moving.warm_tau_s = (
            world.scene.temperature_c, world.scene.warm_c, world.scene.warm_tau_s)
        world.model.scene = moving
        return int(moving.end_s * 1e6)
    if plan.rest_s:
        world.operator.rest(plan.rest_s)
    return world.scene.end_us()


def polls(plan, end_us):
    """(timestamps, times at which the chip is looked at) of every sample, us."""
    pace = 1.0
    for spec in plan.effects:
        effect = make_effect(spec)
        if effect.name == "sample_rate" and effect.stamped:
            pace = 1.0 / effect.period_us(1.0)
    n = int(end_us * 1e-6 * plan.rate_hz * pace)
    if n > MOST_SAMPLES:
        raise ValueError("%d samples, expected at most %d" % (n, MOST_SAMPLES))
    look = np.rint(np.arange(n) * (1e6 / plan.rate_hz / pace)).astype(np.int64)
    return look, look


def labels(world, look_us, moving):
    """Pose codes (n,): the operator's log, 0 while the box moves."""
    pose = np.zeros(len(look_us), dtype=np.int16)
    if moving:
        return pose
    for segment in world.scene.segments:  # a touch inside a placement is no rest
        inside = slice(*np.searchsorted(look_us, (segment.t0, segment.t1)))
        pose[inside] = 1 if world.scene.resting(world.scene.index_at(segment.t0)) else 0
    rest = pose == 1
    pose[:] = 0
    for name, t0, t1 in world.operator.log:
        inside = slice(*np.searchsorted(look_us, (t0, t1)))
        pose[inside] = faces.pose_code(name)
    pose[~rest] = 0
    return pose


def _not_saturated(counts, output, kind):
    """ValueError when hardly any sample is off the rails of the chip."""
    railed = np.abs(counts.astype(np.int32)) >= output.rail
    share = railed.any(axis=0).mean() if counts.size else 0.0
    if share >= SATURATED:
        raise ValueError("%s saturates throughout (%.0f %% of the samples on a rail), expected "
                         "sizes and biases within its range" % (kind, 100.0 * share))


def without_lost(capture, effects, seed):
    """The capture less the samples that dropped_samples takes away."""
    for spec in effects:
        effect = make_effect(spec)
        if effect.name == "dropped_samples":
            from ..experiment import noise_arrays
            chance = noise_arrays.uniform(noise.key(seed, _DROPS), np.arange(len(capture)))
            keep = ~effect.lost(0.5 * chance + 0.5)
            for name in ("t_us", "accel", "gyro", "temp", "pose"):
                column = getattr(capture, name)
                if column is not None:
                    setattr(capture, name, column[keep])
    return capture
