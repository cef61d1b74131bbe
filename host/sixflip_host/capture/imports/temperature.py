"""The thermometer's column of somebody's table: degrees or counts, by what a chip can have."""

from typing import NamedTuple

import numpy as np

from sixflip import RAIL
from sixflip.chips import catalogue

from ...errors import BadFile, UsageError
from . import column_names

OF_CHIP = {row[0]: catalogue.driver(row[0]).TEMPERATURE for row in catalogue.CHIPS
           if row[1] and catalogue.driver(row[0]).TEMPERATURE}
CELSIUS = (100, 0.0)            # counts per °C and offset, of a chip whose own are not known
COLD_C, HOT_C = -60.0, 150.0    # what a chip can have
TO_CELSIUS = {"f": ("°F", lambda values: (values - 32.0) / 1.8),
              "k": ("K", lambda values: values - 273.15)}


class Temperature(NamedTuple):
    """counts int16 (n,), or None where the column is no temperature; meta: the header's keys of
    their scale; assumed, remarks: sentences."""

    counts: object
    meta: dict
    assumed: list
    remarks: list


def counts(path, options, column, values):
    """Temperature of a column's values (n,), with the unit in its name. BadFile for those beyond
    16 bits."""
    lsb, offset = OF_CHIP.get(options.sensor, CELSIUS)
    kind, assumed = options.temp_units, []
    told = column_names.column(column)
    if kind is None and told and told.unit in TO_CELSIUS:
        unit, celsius = TO_CELSIUS[told.unit]
        values = celsius(values.astype(float))
        if COLD_C <= values.min() and values.max() <= HOT_C:
            kind = "c"
            assumed.append("%s is in %s" % (column, unit))
    if kind is None:
        celsius = bool(values.min() >= COLD_C and values.max() <= HOT_C)
        kind = "c" if celsius else "counts" if options.sensor in OF_CHIP else None
        if kind == "c":
            assumed.append("%s is in °C" % column)
        elif kind is None:
            return Temperature(None, {}, [], ["%s goes from %g to %g, which is no °C: left out" % (
                column, values.min(), values.max())])
    if kind == "counts" and options.sensor not in OF_CHIP:
        raise UsageError("--temp-units counts needs --sensor %s" % " or ".join(OF_CHIP))
    whole = np.rint((values.astype(float) - offset) * lsb if kind == "c" else values)
    if np.abs(whole).max() > RAIL:
        raise BadFile("%s: the temperature reaches %g, expected %s" % (
            path, values[np.argmax(np.abs(whole))],
            "°C" if kind == "c" else "16 bit counts (or --temp-units c)"))
    return Temperature(whole.astype(np.int16), {"temp_lsb_per_c": lsb, "temp_offset_c": offset},
                       assumed, [])
