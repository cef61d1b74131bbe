"""One blind case: from a specification and a seed to capture files and a label."""

from dataclasses import dataclass, field, replace

import numpy as np

from . import noise
from .capture_writer import write
from .chips import CHIPS
from .effect import STAGES
from .hand import Habits, Scene
from .held_out import HELD_OUT
from .library import KNOWN
from .protocols import PROTOCOLS
from .signals import Signals
from .strangers import STRANGERS

RATE = 100.0
MAKERS = {**KNOWN, **STRANGERS, **HELD_OUT}


@dataclass
class Specification:
    """What a case is made of. effects: [(name, sensor, multiple of the typical size)]."""

    seed: int
    chip: str = "mpu6050"
    protocol: str = "recommended"
    effects: list = field(default_factory=list)
    habits: dict = field(default_factory=dict)
    certified: bool = False
    new_gyro_offset: bool = False       # a power-up between the sessions
    no_thermometer: bool = False
    no_labels: bool = False
    noise_of: str = ""                  # what recorded noise it carries, in words
    twin: bool = False                  # the same noise once more without the effects
    options: list = field(default_factory=list)     # more words for the command


def part_of(rng, chip, sessions, spec):
    """The nominal 12 parameters, gyro's included, of this case's chip."""
    lag = rng.uniform(*chip.thermometer_lag_s) if chip.thermometer_lag_s[1] else 0.0
    offset = rng.normal(0, chip.offset_dps, 3)
    # from a source of its own: one session more must not change the part
    again = np.random.default_rng([spec.seed, 7]).normal(0, 0.03, (sessions, 3))
    again *= spec.new_gyro_offset
    again[0] = 0
    return {"accel_matrix": np.eye(3) + rng.normal(0, 0.01, (3, 3)),
            "accel_offset": rng.normal(0, chip.offset_g, 3),
            "gyro_matrix": np.eye(3) + rng.normal(0, 0.01, (3, 3)),
            "gyro_offset": offset + again, "thermometer_lag_s": lag}


class Case:
    """The sessions of a specification, and each of its effects."""

    def __init__(self, spec):
        self.spec, self.chip = spec, CHIPS[spec.chip]
        rng = np.random.default_rng([spec.seed, 0])
        habits = dict(table_tilt_deg=abs(rng.normal(0, 1.0)),
                      flip_error_deg=rng.uniform(0.2, 1.0))
        habits.update(spec.habits)
        if spec.certified:
            habits["box_tilt_deg"] = 0.0
        scene = Scene(np.random.default_rng([spec.seed, 1]), Habits(**habits))
        self.sessions = PROTOCOLS[spec.protocol](np.random.default_rng([spec.seed, 2]), scene)
        self.part = part_of(rng, self.chip, len(self.sessions), spec)
        self.latitude = rng.uniform(-60, 60)
        self._kept = {}
        made = np.random.default_rng([spec.seed, 3])
        self.effects = [MAKERS[name][0](made, self.chip, sensor, times)
                        for name, sensor, times in spec.effects]
        for effect in self.effects:
            if effect.name == "dead_band":      # offsets within the band, or it never shows
                key = effect.sensor + "_offset"
                lsb = getattr(self.chip, {"accel": "accel_lsb_per_g",
                                          "gyro": "gyro_lsb_per_dps"}[effect.sensor])
                reach = 0.5 * effect.parameters["counts"] / lsb
                self.part[key] = np.clip(self.part[key], -reach, reach)

    def signals(self, number, without=()):
        """The Signals of a session through the analogue stages, free of noise.

        without: indices of effects left out.
        """
        signals = self._nominal(number).again()
        for stage in STAGES[:3]:
            for index, effect in enumerate(self.effects):
                if effect.stage == stage and index not in without:
                    effect.act(signals, np.random.default_rng([self.spec.seed, 4, index, number]))
        return signals

    def _nominal(self, number):
        """The Signals of a session with no effect, worked out once."""
        if number not in self._kept:
            clock = next((e.clock for e in self.effects if e.clock), None)
            path, warmth = self.sessions[number]
            signals = Signals(path, warmth, self.chip, RATE, self.latitude, number, self.part,
                              clock)
            signals.sessions = len(self.sessions)
            self._kept[number] = signals
        return self._kept[number]

    def counts(self, number, noise_source=noise.synthetic):
        """Signals with counts (n, 6) int, temp (n,) counts and t_us (n,) of what is written."""
        signals = self.signals(number)
        rng = np.random.default_rng([self.spec.seed, 5, number])
        n = len(signals.t)
        accel, gyro = noise_source(rng, self.chip, n, RATE)
        chip = self.chip
        raw = np.concatenate([(signals.accel + accel) * chip.accel_lsb_per_g,
                              (signals.gyro + gyro) * chip.gyro_lsb_per_dps], axis=1)
        signals.counts = np.rint(raw).astype(int)
        signals.kept = np.ones(n, bool)
        for stage in STAGES[3:]:
            for index, effect in enumerate(self.effects):
                if effect.stage == stage:
                    effect.act(signals, np.random.default_rng([self.spec.seed, 6, index, number]))
        limits = np.array([chip.accel_range_g * chip.accel_lsb_per_g] * 3
                          + [chip.gyro_range_dps * chip.gyro_lsb_per_dps] * 3)
        limits = np.minimum(limits, 32768).astype(int)
        signals.counts = np.clip(signals.counts, -limits, limits - 1)
        celsius = signals.temp + rng.normal(0, 0.03, n)
        signals.temp_counts = np.rint((celsius - chip.temp_offset_c) * chip.temp_lsb_per_c)
        crystal = 1 + rng.normal(0, 20e-6)
        t_us = signals.t * crystal * 1e6 + rng.uniform(0, 40, n)
        if any(e.hides_clock for e in self.effects):
            t_us = np.arange(n) * 1e6 / RATE
        signals.t_us = np.rint(t_us - t_us[0]).astype(np.int64)
        return signals

    def write(self, stem, noise_source=noise.synthetic):
        """Write every session to stem-1.csv, ...; returns the paths."""
        paths = []
        for number in range(len(self.sessions)):
            signals = self.counts(number, noise_source)
            kept = signals.kept
            paths.append("%s-%d.csv" % (stem, number + 1))
            write(paths[-1], self.chip, signals.t_us[kept], signals.counts[kept],
                  None if self.spec.no_thermometer else signals.temp_counts[kept].astype(int),
                  None if self.spec.no_labels else signals.names[kept], int(RATE))
        return paths

    def write_twin(self, stem, noise_source=noise.synthetic):
        """The same sessions, part and noise without any effect; returns the paths."""
        return Case(replace(self.spec, effects=[])).write(stem, noise_source)

    def label(self):
        """What the sealed file keeps: causes as they are, JSON-ready."""
        spec = self.spec
        return {"seed": spec.seed, "chip": spec.chip, "protocol": spec.protocol,
                "certified": spec.certified, "habits": spec.habits,
                "new_gyro_offset": spec.new_gyro_offset, "noise_of": spec.noise_of,
                "options": spec.options,
                "effects": [{"effect": e.name, "sensor": e.sensor, "axes": e.axes,
                             "multiple": times, "parameters": _plain(e.parameters),
                             "also": [list(a) for a in e.also]}
                            for e, (_, _, times) in zip(self.effects, spec.effects)]}


def _plain(value):
    """Numpy scalars as Python's own, for JSON."""
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    return value.item() if isinstance(value, np.generic) else value
