"""The units of accelerometer and gyro: as they were said, stand in a name, or are told from
gravity; refused where the file contradicts by a factor. A simulator's file is taken at its word:
another unit than it says is a fault of the simulator, which diagnose is there to find."""

import math

from ...errors import BadFile
from ..capture_header import ACCEL, GYRO
from . import chip_steps, column_vocabulary, gravity, gyro_unit, units
from .options import gyro_is_implied, said_units

GRAVITY_FREE = 0.3              # of what gravity would be: it has been taken out
NO_GRAVITY = 0.05               # g, in a known unit: no offset of a part leaves so little of it
TURNS_ALIKE = 0.6               # correlation from which gyro and accelerometer turn together
NOTHING_STAYS = " in the median and no part of it stays for seconds"
FEW_ROWS = 40                   # too few to contradict what was said of a unit


class ToldUnits:
    """The units of one table; what nobody said goes into `assumed`, a list of sentences,
    and what is odd into `remarks`.

    named   {sensor: unit} in the columns' names, or of the format; rows: of the table
    sizes   {group of columns: value_steps.Sizes}; rate_hz: of the rows
    columns {our name: column of the table}
    """

    def __init__(self, path, options, columns, named, rows, sizes, rate_hz, assumed, remarks):
        self.path, self.options, self.named_units = path, options, named
        self.rows, self.sizes, self.rate_hz = rows, sizes, rate_hz
        self.size_of = "|a| of %s" % " ".join(columns.get(name, name) for name in ACCEL)
        self.assumed, self.remarks = assumed, remarks
        self.by_step = {group: chip_steps.told(group, one.step()) for group, one in sizes.items()}
        self.is_gone = False            # gravity, by gravity.stays, where nothing rests
        self._assumed_gyro = None       # where in `assumed` the gyro's unit stands

    def of_accelerometer(self, values):
        """(unit, counts per g or None) of the accelerometer, told or as it was said."""
        options = self.options
        if values is None:
            return None, None
        said = said_units(options.units)[0]
        named = self.named_units.get(column_vocabulary.ACCEL)
        unit = said or named
        whole = units.are_whole(values)
        per_unit = units.ACCEL_UNITS[unit] if unit else None
        seen = gravity.seen(values, (1.0 / per_unit,) if per_unit else gravity.USUAL)
        if unit is None and options.accel_lsb is not None and whole:
            unit = "counts"
        told = gravity.unit(seen.size, whole) if seen else None
        step = self.by_step[ACCEL]
        self.is_gone = bool(seen) and not seen.rests and not gravity.stays(
            values, self.rate_hz, self._one_g(unit or step and step.unit))
        if unit is not None:
            self._contradicted(unit, seen, told, said, values)
            if unit == "counts" and options.accel_lsb is None and told and told[0] == "counts":
                self.assumed.append("the accelerometer has %d counts per g: |a| is %.0f" % (
                    told[1], seen.size))
                return unit, told[1]
            return unit, options.accel_lsb
        if told is None and step is not None and self._may_be(step.unit, seen):
            self.assumed.append("the accelerometer is in %s: %s" % step)
            self._contradicted(step.unit, seen, told, step.unit, values)
            return step.unit, options.accel_lsb
        if told is None or self.is_gone and options.gravity:
            return self._without_gravity(seen, whole), options.accel_lsb
        self.assumed.append("the accelerometer is in %s: |a| is %.4g%s" % (
            told[0], seen.size, " at rest" if seen.rests else " in the median"))
        if told[0] == "counts":
            self.assumed.append("it has %d counts per g" % told[1])
        return told[0], options.accel_lsb or told[1]

    def _one_g(self, unit):
        """What 1 g is in a unit, or infinite where nobody knows."""
        per_unit = units.ACCEL_UNITS.get(unit)
        return 1.0 / per_unit if per_unit else self.options.accel_lsb or math.inf

    def _may_be(self, unit, seen):
        """False where gravity is off by a factor from what it is in a unit."""
        return not self.options.gravity or seen is None or (
            1 / gravity.DISAGREES <= seen.size * units.ACCEL_UNITS[unit] <= gravity.DISAGREES)

    def _contradicted(self, unit, seen, told, said, values):
        """BadFile where gravity is off by a factor from what was said of the unit."""
        options = self.options
        per_unit = 1 / options.accel_lsb if unit == "counts" and options.accel_lsb else \
            units.ACCEL_UNITS[unit]
        if not (options.gravity or said):
            return
        if per_unit is None or seen is None or self.rows < FEW_ROWS:
            return
        if self.is_gone or told is None and unit != "counts" and seen.size * per_unit < (
                NO_GRAVITY if seen.rests else GRAVITY_FREE):
            self._gone(seen.size * per_unit, unit, said)
            return
        if not seen.rests:
            return
        if 1 / gravity.DISAGREES <= seen.size * per_unit <= gravity.DISAGREES:
            self._far_from_1_g(seen.size * per_unit, values, per_unit)
            return
        what = "--accel-lsb %g" % options.accel_lsb if unit == "counts" else \
            "--units %s" % options.units if said else "the unit that the file says, %s," % unit
        looks = "" if told is None else ", expected --units %s%s" % (
            told[0], " --accel-lsb %d" % told[1] if told[1] else "")
        raise BadFile("%s: %s makes |a| at rest %.4g g%s" % (
            self.path, what, seen.size * per_unit, looks or ", expected 1 g"))

    def _gone(self, size, unit, said):
        """BadFile for values without gravity, unless someone said their unit, who is told."""
        words = "%s is %.2g g%s: gravity has been taken out of it, and no scale, offset or " \
            "face can be told from what is left" % (
                self.size_of, size, NOTHING_STAYS * self.is_gone)
        if not said:
            raise BadFile("%s: %s; expected the acceleration with gravity, which phones keep as "
                          "another sensor, or --units %s to take it as it is" % (
                              self.path, words, unit))
        self.remarks.append(words)

    def _far_from_1_g(self, size, values, per_unit):
        """Says so where rests read farther from 1 g than any part that is whole, and whether it is
        the scale or an offset, as far as they lie on different faces."""
        if abs(size - 1) <= gravity.ZERO_G:
            return
        offset, words = gravity.offset(values), "its scale is off, or its unit is another one"
        if offset.nats > gravity.TELLS:
            own = offset.size * per_unit
            words = "it has an offset of %s g, about which gravity is %.3g g%s" % (
                ", ".join("%.2f" % (round(value, 2) + 0.0) for value in offset.about * per_unit),
                own, "; " + words if abs(own - 1) > gravity.ZERO_G else "")
        elif offset.nats > -gravity.TELLS:
            words = "its scale or its offset is off, or its unit is another one"
        self.remarks.append("gravity is %.3g g in the rests of this file: %s" % (size, words))

    def _without_gravity(self, seen, whole):
        """The unit of values that gravity does not tell; BadFile where it was to be told."""
        path = self.path
        if not self.options.gravity and not whole:
            self.assumed.append("the accelerometer is in m/s2: gravity does not tell")
            return "m/s2"
        size = "%.4g" % seen.size if seen else "not to be seen"
        if whole and self.options.accel_lsb is None and seen and seen.size > 50:
            raise BadFile("%s: the accelerometer is in counts, |a| is %s: expected --accel-lsb, "
                          "counts per g" % (path, size))
        if seen and seen.size < GRAVITY_FREE and not whole:
            raise BadFile("%s: %s is %s: gravity has been taken out of it, expected the "
                          "acceleration with gravity, or --units with its unit" % (
                              path, self.size_of, size))
        if self.is_gone:
            raise BadFile("%s: %s is %s%s, as gravity does: expected the acceleration with "
                          "gravity, or --units with its unit" % (
                              path, self.size_of, size, NOTHING_STAYS))
        raise BadFile("%s: %s is %s, which is no gravity in g, m/s2, mm/s2, mg or counts: "
                      "expected --units, such as g,dps" % (path, self.size_of, size))

    def of_gyro(self, values, accel_unit):
        """(unit, counts per deg/s or None) of the gyro: said, in its name, by its values or by the
        accelerometer's."""
        if values is None:
            return None, None
        lsb = self.options.gyro_lsb
        named = self.named_units.get(column_vocabulary.GYRO)
        unit = said_units(self.options.units)[1] or named
        whole = units.are_whole(values)
        if whole and not named and gyro_is_implied(self.options.units) and (
                lsb is not None and unit is None or accel_unit == "counts"
                or self.sizes[GYRO].are_many() or max(values.max(), -values.min()) > 100):
            unit = "counts"
        if unit is None:
            unit, why = self._gyro_by(self.by_step[GYRO], accel_unit)
            self._assumed_gyro = len(self.assumed)
            self.assumed.append("the gyro is in %s%s" % (unit, why))
        return unit, self._only_lsb() if unit == "counts" and lsb is None else lsb

    def _gyro_by(self, step, accel_unit):
        """(unit, words) of a gyro by its step, or by the accelerometer's unit; BadFile where there
        is neither."""
        if step is not None:
            return step.unit, ": " + step.words
        if accel_unit is None:
            raise BadFile("%s: no accelerometer was recognised, which would tell the gyro's unit, "
                          "expected --map ax=NAME,ay=NAME,az=NAME, or --units ,dps or ,rad/s or "
                          ",counts" % self.path)
        unit = {"si": "rad/s", "m/s2": "rad/s", "mm/s2": "rad/s", "g": "dps",
                "mg": "dps"}.get(accel_unit)
        if unit is None:
            raise BadFile("%s: the gyro's unit is not told by anything, expected --units ,dps "
                          "or ,rad/s or ,counts" % self.path)
        return unit, ", as goes with %s" % accel_unit

    def _only_lsb(self):
        """Counts per deg/s of the sensor that was said, where it has one range; else BadFile."""
        sensor = self.options.sensor
        choices = chip_steps.gyro_lsb(sensor)
        if len(choices) != 1:
            raise BadFile("%s: the gyro is in counts, so its LSB must be given (--gyro-lsb, "
                          "counts per deg/s%s)" % (self.path, ": %s of a %s" % (
                              " or ".join("%g" % one for one in choices), sensor)
                              if choices else ""))
        self.assumed.append("the gyro has %g counts per deg/s, as a %s" % (choices[0], sensor))
        return choices[0]

    def turned(self, accel, gyro, unit, lsb, rate_hz):
        """The gyro's unit, held against how gravity turns in the accelerometer, and where nobody
        said it also against what it would make of rests and of the fastest turn."""
        if self._assumed_gyro is not None and unit in ("dps", "rad/s"):
            return self._likelier(unit, gyro_unit.Evidence(accel, gyro, rate_hz))
        per_unit = 1 / lsb if unit == "counts" else units.GYRO_UNITS[unit]
        turned = gravity.turn_factor(accel, gyro, per_unit, rate_hz)
        if turned is None or abs(turned.alike) < TURNS_ALIKE:
            return unit
        other = {True: "rad/s", False: "dps"}[turned.factor > 1]
        ratio = units.GYRO_UNITS[other] / per_unit
        if unit == "counts" or not 0.4 < abs(turned.factor) / ratio < 2.5 \
                or abs(ratio - 1) < 0.1:
            return unit
        if self.options.gravity or said_units(self.options.units)[1]:
            raise BadFile("%s: its gyro in %s turns %.3g times as far as gravity does in the "
                          "accelerometer, expected --units ,%s" % (
                              self.path, unit, 1 / abs(turned.factor), other))
        return unit

    def _likelier(self, unit, evidence):
        """The likelier unit of a gyro that was assumed to be in one, by the Evidence."""
        other = "rad/s" if unit == "dps" else "dps"
        odds = gyro_unit.BY_ITS_STEP if self.by_step[GYRO] else gyro_unit.OF_A_SIMULATOR \
            if not self.options.gravity else gyro_unit.GOES_WITH[
                "g" if other == "rad/s" else "m/s2"]
        nats = (evidence.nats if other == "dps" else -evidence.nats) - math.log(odds)
        if nats > 0.0:
            unit, other = other, unit
            self.assumed[self._assumed_gyro] = "the gyro is in %s: %s" % (
                unit, evidence.why(unit))
        chance = 1.0 / (1.0 + math.exp(min(abs(nats), 500.0)))
        if chance > gyro_unit.DOUBT:
            self.assumed[self._assumed_gyro] += " (%s with a chance of %.0f %%: --units ,%s " \
                "takes it so)" % (other, 100.0 * chance, other)
        return unit
