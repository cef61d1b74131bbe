"""What was said of a file that is to be imported, and whether it can be."""

from dataclasses import dataclass, replace

from ...errors import UsageError
from ..capture_header import STANDARD_G
from . import column_vocabulary, units

LSB_MAX = 1e9


@dataclass(frozen=True)
class Options:
    """What was said about a file; None: told from its names and values.

    The fields are the options of `sixflip import`, whose --help says what they mean; `gravity`
    is False for a file that may leave gravity out, such as a simulator's.
    """

    file: str
    preset: str = None
    sensor: str = "other"
    rate: float = None
    time_column: str = None
    time_unit: str = None
    sort: bool = False
    columns: str = None
    map: tuple = ()
    delimiter: str = "auto"
    skip: int = None
    units: str = None
    topic: str = None
    accel_lsb: float = None
    gyro_lsb: float = None
    mag_lsb: float = None
    temp_units: str = None
    g: float = STANDARD_G
    label_column: str = None
    sections: str = None
    label: tuple = ()
    gravity: bool = True


def check_options(options):
    """UsageError for numbers that cannot be, before anything is read."""
    for name in ("accel_lsb", "gyro_lsb", "mag_lsb", "g"):
        value = getattr(options, name)
        if value is not None and not 0 < value < LSB_MAX:
            raise UsageError("--%s %g: expected a number above 0" % (
                name.replace("_", "-"), value))
    if options.rate is not None and not 0 < options.rate < 1e6:
        raise UsageError("--rate %g: expected samples per second" % options.rate)
    if options.delimiter not in ("auto", "blank") and len(options.delimiter) != 1:
        raise UsageError("--delimiter %r: expected one character, auto or blank"
                         % options.delimiter)
    if options.skip is not None and options.skip < 0:
        raise UsageError("--skip %d: expected a number of lines" % options.skip)
    if options.time_unit == "samples" and options.rate is None:
        raise UsageError("--time-unit samples needs --rate HZ")
    if options.time_unit and options.time_unit != "samples" \
            and options.time_unit not in column_vocabulary.TIME_UNITS | column_vocabulary.TICKS:
        raise UsageError("--time-unit %s: expected one of %s" % (options.time_unit, " ".join(
            [*column_vocabulary.TIME_UNITS, *column_vocabulary.TICKS, "samples"])))
    if options.label_column and options.sections:
        raise UsageError("--label-column and --sections: expected one of the two")
    said_units(options.units)


def said_units(text):
    """`si` or `g,dps` -> (unit of the accelerometer, of the gyro), each None where not said."""
    if text is None:
        return None, None
    words = text.split(",")
    if len(words) > 2:
        raise _unknown_units(text)
    if len(words) == 2:
        accel, gyro = (word or None for word in words)
    elif words[0] in ("si", "counts"):
        accel = gyro = words[0]
    elif words[0] in ("g", "mg"):
        accel, gyro = words[0], "dps"
    else:
        accel = words[0] if words[0] in units.ACCEL_UNITS else None
        gyro = words[0] if accel is None else None
    if accel not in (None, *units.ACCEL_UNITS) or gyro not in (None, *units.GYRO_UNITS):
        raise _unknown_units(text)
    return accel, gyro


def gyro_is_implied(text):
    """True where nobody said the gyro's unit, or one word that is the accelerometer's as well."""
    return text is None or text in ("si", "g", "mg")


def _unknown_units(text):
    return UsageError("--units %s: expected one of %s, a comma, one of %s" % (
        text, " ".join(units.ACCEL_UNITS), " ".join(units.GYRO_UNITS)))


def with_the_file(options, table):
    """The options, with what the file itself says in the place of what nobody said."""
    said = {name: getattr(table, name, None) for name in ("accel_lsb", "time_unit")
            if getattr(options, name) is None}
    return replace(options, **{name: value for name, value in said.items() if value is not None})
