"""What every effect has in common. Runs on MicroPython (floats) and under numpy (arrays).

An effect of the sensor is written once, as its terms: (key, axis, value) for each coefficient,
where `value` is what one unit of the coefficient adds to that axis. The simulator sums
coefficient * value (forward form); the diagnosis takes the values as columns (regressor form).
What cannot be written as terms (registers, timing, a noise) has a forward method of its own.

Additions are in mg for the accelerometer and in deg/s for the gyro.
"""

AXES = ("x", "y", "z")
SENSOR = "sensor"  # adds to what the sensing element feels
REGISTER = "register"  # changes counts
TIMING = "timing"  # changes when or whether a sample is taken
WORLD = "world"  # changes what happens around the sensor


class BadEffect(ValueError):
    """An effect that cannot be made from what was asked; the text says what was expected."""


class Effect:
    """One effect with its sizes.

    values: {key: number} in the unit of `units[sensor]`; missing keys are 0.
    shape: the parameters that do not enter linearly (time constants, levels), see `shapes`.
    """

    name = ""
    stage = SENSOR
    units = {}  # sensor -> unit of the coefficients; the sensors it exists in
    keys = AXES
    shapes = {}  # parameter -> (default, smallest, largest, unit)
    largest = {}  # sensor -> largest size that is possible at all
    smallest = None  # None: as large as the largest, with the other sign
    aliases = ()  # effects a session of rests can mistake it for, see GAP finding 1
    whole = False  # sizes are whole numbers

    def __init__(self, sensor=None, values=None, shape=None):
        self.sensor = self._sensor(sensor)
        self.values = {}
        for key in values or {}:
            self.values[key] = self._size(key, values[key])
        for parameter in self.shapes:
            setattr(self, parameter, self.shapes[parameter][0])
        for parameter in shape or {}:
            setattr(self, parameter, self._shape(parameter, shape[parameter]))

    def _sensor(self, sensor):
        """The sensor asked for, or the only one there is."""
        if sensor is None:
            return "accel" if "accel" in self.units else sorted(self.units)[0]
        if not isinstance(sensor, str) or sensor not in self.units:
            raise BadEffect("%s: sensor is %r, expected one of %s"
                            % (self.name, sensor, ", ".join(sorted(self.units))))
        return sensor

    def _size(self, key, value):
        if key not in self.keys:
            raise BadEffect("%s: no size named %r, expected %s"
                            % (self.name, key, " ".join(self.keys)))
        top = self.largest[self.sensor]
        bottom = -top if self.smallest is None else self.smallest
        return number("%s %s" % (self.name, key), value, bottom, top,
                      self.units[self.sensor], self.whole)

    def _shape(self, parameter, value):
        if parameter not in self.shapes:
            raise BadEffect("%s: no parameter named %r, expected one of %s"
                            % (self.name, parameter, " ".join(sorted(self.shapes)) or "none"))
        _, low, high, unit = self.shapes[parameter]
        return number("%s %s" % (self.name, parameter), value, low, high, unit)

    def terms(self, m):
        """Yield (key, axis 0..2, value) at the moment(s) m; nothing for effects without terms."""
        return ()

    def add(self, m, out):
        """Forward form: add to out, a list of three (floats or arrays), in mg or deg/s."""
        for key, axis, value in self.terms(m):
            size = self.values.get(key)
            if size:
                out[axis] = out[axis] + size * value


def number(what, value, low, high, unit, whole=False):
    """value as a number within [low, high], or BadEffect with what was expected."""
    expected = "%s is %r, expected a %snumber from %g to %g %s" % (
        what, value, "whole " if whole else "", low, high, unit)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise BadEffect(expected)
    if not low <= value <= high or (whole and int(value) != value):
        raise BadEffect(expected)
    return value


def per_axis(values):
    """The terms of an effect with one coefficient an axis; values is a sequence of three."""
    return ((AXES[i], i, values[i]) for i in range(3))
