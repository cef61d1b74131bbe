"""What a protocol can say about each effect: silent, in a class, or seen from which size on."""
import math

from sixflip_sim.effects import datasheets, typical
from sixflip_sim.effects.library import EFFECTS, NAMES

from ..board import events_seen
from ..experiment import projection
from ..experiment.session_rows import rows_of
from . import alias, detectable

SAME_CLASS = 0.9  # alias index above which two effects get one name (GAP stage 4)
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


class Finding:
    """One effect of one sensor. smallest: at 80 % power (inf: silent); members: {effect:
    index} of those that reproduce more than 0.9 of it; absorbed: what takes it up, if silent."""

    def __init__(self, effect, sensor, unit, smallest, typical_size, source):
        self.effect, self.sensor, self.unit = effect, sensor, unit
        self.smallest, self.typical, self.source = smallest, typical_size, source
        self.members, self.absorbed, self.how = {}, "", ""

    @property
    def silent(self):
        return math.isinf(self.smallest)

    @property
    def seen(self):
        """Whether the typical size would be told from nothing."""
        return not self.silent and self.typical is not None and self.smallest <= self.typical


class Findings:
    """All of a protocol: .list of Finding, .matrices {sensor: (names, A)} for a square box."""

    def __init__(self, protocol, sensor="mpu6050", certified_box=False, rate_hz=100.0,
                 ranges=(None, None), prior=None):
        self.list, self.matrices = [], {}
        blocks = 3 if sum(len(s.rests) for s in protocol.sessions) <= 40 else 2
        rows = rows_of(protocol, blocks)
        for kind in kinds_of(sensor):
            if kind == "gyro":
                rows = rows_of(protocol, 1, turns=True)
            design = alias.PlannedModel(rows, kind, certified_box)
            self._of_rests(design, sensor, kind, rate_hz, ranges[kind == "gyro"])
        self.list += [found for name in NAMES
                      for found in events_seen.findings(name, protocol, sensor, rate_hz,
                                                        Finding, ranges)]
        for found in self.list if prior else ():
            size = prior.size(found.sensor, found.effect)
            if size is not None:
                found.typical, found.source = size, prior.source
        self.list.sort(key=lambda f: (NAMES.index(f.effect), f.sensor))

    def _of_rests(self, design, sensor, kind, rate_hz, full_scale):
        power = detectable.Power(design, typical.chip_of(sensor, kind), rate_hz,
                                 step=typical.step_of(sensor, kind, full_scale))
        names = alias.ACCEL if kind == "accel" else alias.GYRO
        matrix = projection.alias_matrix({name: design.signature(name) for name in names})
        tables = [matrix]
        if "box_tilt" in design.own:  # the box as one effect among others, too
            square = design.without_own("box_tilt")
            tables.append(projection.alias_matrix(
                {name: square.signature(name) for name in names}))
        self.matrices[kind] = tables[-1]
        for name in names:
            size, source = typical.size(name, sensor, kind)
            sizes = power.smallest(name)
            # Of the Earth rate only the vertical part is an effect, the rest a nuisance.
            smallest = sizes["up"] if name == "earth_rate" else detectable.middle(sizes)
            if name not in matrix[0]:
                smallest = detectable.SILENT
            known = typical.determined(smallest, size)
            finding = Finding(name, kind, EFFECTS[name].units[kind],
                              smallest if known else detectable.SILENT, size, source)
            if not known and smallest < detectable.SILENT:
                finding.absorbed = finding.how = NOT_DETERMINED
            elif not known:
                finding.absorbed = taken_up(design, name)
            finding.members = members(name, tables)
            self.list.append(finding)
        size, source = typical.size("drift", sensor, kind)
        self.list.append(Finding("drift", kind, EFFECTS["drift"].units[kind],
                                 power.smallest_flicker(), size, source))


def members(name, tables):
    """{other: index} of those that reproduce more than 0.9 of it in any of the tables."""
    found = {}
    for names, index in tables:
        if name in names:
            for other, share in zip(names, index[names.index(name)]):
                if other != name and share > SAME_CLASS:
                    found[other] = max(float(share), found.get(other, 0.0))
    return found


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
