"""What a diagnosis is asked for, and what the registers and the thermometer say that all of its
stages have to know."""
import os
from dataclasses import dataclass, field


@dataclass(frozen=True, eq=False)
class Settings:
    """certified: the box is square; without: effects left out of the library; reference: {sensor:
    flicker level of a noise capture}; jobs: processors, 0: all; simulated: {sensor: [(effect,
    variant, key, coefficient)]} that the simulator compared with has already; prior: FleetPrior
    of boards of this kind, or None."""

    certified: bool = False
    without: tuple = ()
    reference: dict = field(default_factory=dict)
    jobs: int = 1
    simulated: dict = field(default_factory=dict)
    prior: object = None

    @property
    def processors(self):
        return self.jobs or os.cpu_count() or 1


@dataclass(frozen=True, eq=False)
class Conditions:
    """reference_c: temperature that slopes are taken about; coarse: registers move what the
    accelerometer reads near zero; shaken, banded: {sensor: axes (0..2) that a line of the spectrum
    is on, that have a dead band}; stale: rows of a sensor come again later, so that in motion it
    reads what was before; hidden: share of the samples that are missing under a steady clock."""

    reference_c: float = 25.0
    coarse: bool = False
    shaken: dict = field(default_factory=dict)
    banded: dict = field(default_factory=dict)
    stale: bool = False
    hidden: float = 0.0
