"""Captures in, a Diagnosis out: the one way in for the verb, the report and Python programs."""
from dataclasses import replace

import numpy as np

from .. import progress
from ..capture import capture_file
from ..errors import BadFile
from ..experiment import blocks, long_rest
from ..experiment.signal_measures import allan
from . import diagnosis, samples_judged
from .settings import Settings

MOST_ROUNDS = 3  # times that what is in both logs is taken off
SHORTEST_REST_S = 20.0  # flicker shows from some seconds on


def diagnose(captures, simulator=(), reference=(), certified_box=False, without=(), jobs=1,
             prior=None):
    """The diagnosis.Diagnosis of captures.

    captures, simulator   [(name, Capture)], one a session
    reference  [(name, Capture)] of one capture at rest, to know the noise by, or empty
    certified_box  the box is known to be square; without: effects left out of the library
    jobs       processors, 0: all
    prior      fleet_prior.FleetPrior of boards of this kind, None: the data sheets' sizes

    BadFile where one beside a simulator is a gyro's alone or of a few rows, or a reference does
    not rest.
    """
    for each in (*captures, *simulator) if simulator else ():
        capture_file.with_accelerometer(*each)  # two logs are held together by gravity
    noise = {}
    for name, capture in reference:
        noise = flicker_levels(capture, name)
    settings = Settings(certified_box, tuple(without), noise, jobs, prior=prior)
    captures, damages = samples_judged.without_damage(captures, settings.processors)
    own, comparisons, rested = None, [], lambda session: session
    if simulator:
        from .simulator import against_simulator, comparison, convention_findings, traces
        for each in (*captures, *simulator):
            traces.check_rows(*each)
        progress.doing("conventions and parameters of the simulator")
        simulator = list(simulator)
        for k, (name, log) in enumerate(simulator):
            compared = comparison.compare(captures, name, log)
            comparisons.append(compared)
            right = compared.put_right
            if right is not None:  # what else is said is said of the right times
                captures = [(real, right.real if real == compared.against else capture)
                            for real, capture in captures]
                simulator[k] = name, right.sim
        # The rests of one motion are those of both logs, which each finds in the same way.
        if not any(compared.motion_judged for compared in comparisons):
            rested = blocks.with_whole_rests
        # What a log with another convention reads is no effect of a sensor.
        mended = [(name, convention_findings.capture_put_right(log, compared.conventions))
                  for (name, log), compared in zip(simulator, comparisons)]
        sound = [log for log in mended if log[1] is not None]
        if sound:
            progress.doing("the simulator's own captures")
            own = against_simulator.read(
                [rested(blocks.session_of(*log)) for log in sound], settings)
            settings = replace(settings, simulated=against_simulator.not_compared(
                own.known, comparisons))
    sessions = [rested(blocks.session_of(name, capture)) for name, capture in captures]
    result = diagnosis.diagnose_sessions(sessions, settings, own, comparisons, damages)
    return _beyond(result, own, sessions, damages) if comparisons else result


def _beyond(result, own, sessions, damages):
    """The Diagnosis without what two logs of one motion show to be in both, with what they alone
    show, and with the simulator's parameters beside the effects that it lacks."""
    from .simulator import (
        against_simulator,
        dead_zone,
        effects_beside,
        lacking_courses,
        lacking_effects,
    )
    progress.doing("parameters beside the effects")
    for _ in range(MOST_ROUNDS):
        both = against_simulator.in_both(result)
        if not both:
            break
        known = result.settings.simulated
        settings = replace(result.settings, simulated={
            **known, **{kind: [*known.get(kind, ()), *more] for kind, more in both.items()}})
        result = diagnosis.diagnose_sessions(sessions, settings, own, result.comparisons, damages)
    progress.doing("effects that the motion shows")
    result = lacking_courses.added(dead_zone.added(result))
    return effects_beside.beyond(lacking_effects.added(result))


def flicker_levels(capture, path):
    """{sensor: flicker level (mg or deg/s)} of a capture's longest rest: what the sensor has when
    nothing else acts. BadFile when there is no such rest."""
    session = blocks.session_of(path, capture)
    rest = long_rest.longest(session)
    if rest is None or (rest[1] - rest[0]) / session.rate < SHORTEST_REST_S:
        raise BadFile("%s: no rest of %g s or more to know the noise by" % (path, SHORTEST_REST_S))
    levels = {}
    for sensor in ("accel", "gyro"):
        if getattr(capture, sensor) is None:
            continue
        x = long_rest.scaled(session, sensor)[rest[0]:rest[1]]
        noise = session.noise_accel if sensor == "accel" else session.noise_gyro
        m = max(1, len(x) // 12)
        tau = m / session.rate
        excess = np.maximum(allan(x, m) ** 2 - noise ** 2 / tau, 0.0)
        levels[sensor] = float(np.sqrt(excess.mean()))
    return levels
