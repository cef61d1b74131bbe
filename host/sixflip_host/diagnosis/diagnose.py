"""Captures in, a Diagnosis out: the one way in for the verb, the report and Python programs."""
from dataclasses import replace

from .. import progress
from ..experiment import blocks
from . import diagnosis, noise_reference
from .detect import byte_faults
from .settings import Settings


def diagnose(captures, simulator=(), reference=(), certified_box=False, without=(), jobs=0,
             prior=None):
    """The diagnosis.Diagnosis of captures.

    captures, simulator   [(name, Capture)], one a session
    reference  [(name, Capture)] of one capture at rest, to know the noise by, or empty
    certified_box  the box is known to be square; without: effects left out of the library
    jobs       threads, 0: one a core
    prior      fleet_prior.FleetPrior of boards of this kind, None: the data sheets' sizes
    """
    captures, damages = byte_faults.repaired(captures)
    sessions = [blocks.of(name, capture) for name, capture in captures]
    noise = {}
    for name, capture in reference:
        noise = noise_reference.levels(capture, name)
    settings = Settings(certified_box, tuple(without), noise, jobs, prior=prior)
    own, comparisons = None, []
    if simulator:
        from .simulator import against_simulator, comparison, put_right
        progress.doing("conventions and parameters of the simulator")
        comparisons = [comparison.compare(captures, *log) for log in simulator]
        # What a log with another convention reads is no effect of a sensor.
        mended = [(name, put_right.capture(log, found.conventions))
                  for (name, log), found in zip(simulator, comparisons)]
        sound = [log for log in mended if log[1] is not None]
        if sound:
            names, simulated = zip(*sound)
            progress.doing("the simulator's own captures")
            own = against_simulator.read(list(simulated), list(names), settings)
            settings = replace(settings, simulated=own.known)
    return diagnosis.of(sessions, settings, own, comparisons, damages)
