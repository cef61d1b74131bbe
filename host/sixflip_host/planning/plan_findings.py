"""What a protocol can say about each effect: silent, in a class, or seen from which size on."""
import math
from dataclasses import dataclass, field, replace

from sixflip_sim.effects import datasheets, typical
from sixflip_sim.effects.library import EFFECTS, NAMES

from ..board import events_seen
from ..experiment import projection
from . import alias, detectable
from .protocols import rows_of

SAME_CLASS = 0.9  # alias index above which two effects get one name (GAP stage 4)
# Rests of a protocol up to which each is cut into three blocks, of more into two: the design's
# matrices grow with the square of the rows. The paper's protocol has 12, the recommended one 78.
FEW_RESTS = 40
NOT_DETERMINED = "too little of it happens for a size to be determined"
# What takes up an effect that leaves no residual, by sensor.
TAKEN_UP_BY = {
    "accel": {"local_gravity": "scale", "cubic": "scale", "saturation": "scale",
              "supply": "bias", "cross_quadratic": "misalignment, box", "quadratic": "box",
              "asymmetry": "box", "vibration_rectification": "box", "box_tilt": "scale, bias",
              "thermal_scale": "scale", "table_tilt": "bias, misalignment"},
    "gyro": {"supply": "bias", "cubic": "scale", "saturation": "scale", "quadratic": "bias",
             "asymmetry": "scale", "thermal_scale": "scale"},
}


@dataclass(frozen=True)
class Finding:
    """What a protocol says of one effect of one sensor. smallest: the size seen at 80 % power, in
    unit (inf: silent); typical: the usual size or None, by its source; aliases: {effect: alias
    index} of those that reproduce more than SAME_CLASS of it; absorbed: what takes it up, if it is
    silent; how: by what it shows, or why it does not, in words."""

    effect: str
    sensor: str
    unit: str
    smallest: float
    typical: float | None
    source: str
    aliases: dict = field(default_factory=dict)
    absorbed: str = ""
    how: str = ""

    @property
    def silent(self):
        return math.isinf(self.smallest)

    @property
    def seen(self):
        """Whether the typical size would be told from nothing."""
        return not self.silent and self.typical is not None and self.smallest <= self.typical


@dataclass(frozen=True)
class Findings:
    """What a protocol says of every effect: list of Finding in the order of the library, and
    matrices {sensor: (names, alias index (k, k))} for a square box."""

    list: list
    matrices: dict


def findings_of(protocol, sensor="mpu6050", certified_box=False, rate_hz=100.0,
                ranges=(None, None), prior=None):
    """Findings of a Protocol for a sensor's name. rate_hz: of the samples; ranges: full scales in
    g and deg/s, None: the chip's usual ones; prior: FleetPrior, whose sizes stand for the data
    sheets'."""
    findings, matrices = [], {}
    blocks = 3 if sum(len(s.rests) for s in protocol.sessions) <= FEW_RESTS else 2
    rows = rows_of(protocol, blocks)
    for kind in kinds_of(sensor):
        if kind == "gyro":
            rows = rows_of(protocol, 1, turns=True)
        design = alias.PlannedModel(rows, kind, certified_box)
        more, matrices[kind] = _of_rests(design, sensor, kind, rate_hz, ranges[kind == "gyro"])
        findings += more
    for name in NAMES:
        findings += events_seen.findings(name, protocol, sensor, rate_hz, Finding, ranges)
    if prior:
        findings = [_by_fleet(finding, prior) for finding in findings]
    return Findings(sorted(findings, key=lambda f: (NAMES.index(f.effect), f.sensor)), matrices)


def _by_fleet(finding, prior):
    """The Finding with the typical size that a FleetPrior has, where it has one."""
    size = prior.size(finding.sensor, finding.effect)
    return finding if size is None else replace(finding, typical=size, source=prior.source)


def _of_rests(design, sensor, kind, rate_hz, full_scale):
    """([Finding], (names, alias index (k, k)) for a square box) of the effects of one kind of a
    sensor that show in the means of rests and turns."""
    power = detectable.power_of(design, typical.chip_of(sensor, kind), rate_hz,
                                step=typical.step_of(sensor, kind, full_scale))
    names = alias.ACCEL if kind == "accel" else alias.GYRO
    tables = [projection.alias_matrix({name: design.signature(name) for name in names})]
    if "box_tilt" in design.own:  # the box as one effect among others, too
        square = design.without_own("box_tilt")
        tables.append(projection.alias_matrix({name: square.signature(name) for name in names}))
    findings = [_of_effect(design, power, name, sensor, tables) for name in names]
    size, source = typical.size("drift", sensor, kind)
    findings.append(Finding("drift", kind, EFFECTS["drift"].units[kind], power.smallest_flicker(),
                            size, source))
    return findings, tables[-1]


def _of_effect(design, power, name, sensor, tables):
    """Finding of one effect that shows in the means of rests and turns."""
    kind = design.sensor
    size, source = typical.size(name, sensor, kind)
    sizes = power.smallest(name)
    # Of the Earth rate only the vertical part is an effect, the rest a nuisance.
    smallest = sizes["up"] if name == "earth_rate" else detectable.middle(sizes)
    if name not in tables[0][0]:
        smallest = detectable.SILENT
    known = typical.determined(smallest, size)
    absorbed = how = ""
    if not known and smallest < detectable.SILENT:
        absorbed = how = NOT_DETERMINED
    elif not known:
        absorbed = taken_up(design, name)
    return Finding(name, kind, EFFECTS[name].units[kind], smallest if known else detectable.SILENT,
                   size, source, aliased_with(name, tables), absorbed, how)


def aliased_with(name, tables):
    """{other: alias index} of those that reproduce more than SAME_CLASS of an effect in any of the
    tables [(names, index), ...]."""
    aliases = {}
    for names, index in tables:
        if name in names:
            for other, share in zip(names, index[names.index(name)]):
                if other != name and share > SAME_CLASS:
                    aliases[other] = max(float(share), aliases.get(other, 0.0))
    return aliases


def kinds_of(sensor):
    """The kinds of sensor a chip name holds."""
    return tuple([kind for kind, chip in zip(("accel", "gyro"), datasheets.chips(sensor))
                  if chip is not None])


def taken_up(design, name):
    """In words, what reproduces a silent effect completely."""
    if design.sensor == "accel" and not design.certified_box:
        if design.without_own("box_tilt").signature(name) is not None:
            return "box"
        if "box" in TAKEN_UP_BY["accel"].get(name, ""):
            return "scale, bias"
    return TAKEN_UP_BY[design.sensor].get(name, "bias, scale")
