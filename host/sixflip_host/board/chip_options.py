"""Full scales and rates that are asked for, and what a chip has of them."""

import re

from sixflip.chips import catalogue
from sixflip_device import settings

from ..errors import UsageError

UNITS = {"g": "accel_range_g", "dps": "gyro_range_dps"}


def ranges(text):
    """{"accel_range_g": 8, "gyro_range_dps": 2000} of "8g,2000dps"."""
    found = {}
    for part in text.split(","):
        match = re.fullmatch(r"(\d+(?:\.\d+)?)(g|dps)", part.strip())
        if not match or UNITS[match[2]] in found:
            raise UsageError("--range %s: expected a full scale in g, one in dps or both, such as "
                             "8g,2000dps" % text)
        key, value = UNITS[match[2]], float(match[1])
        _, _, low, high = settings.KNOWN[key]
        if not low <= value <= high:
            raise UsageError("--range %s: %s is %g, expected %g to %g" % (text, key, value, low,
                                                                          high))
        found[key] = int(value) if value == int(value) else value
    return found


def what_the_chip_offers(sensor, wanted):
    """(the settings as the chip has them, sentences where that is not what was asked for)."""
    driver, said, had = catalogue.driver(sensor), [], dict(wanted)
    for key, rows, unit in (("accel_range_g", driver.ACCEL_RANGES, "g"),
                            ("gyro_range_dps", driver.GYRO_RANGES, "deg/s")):
        scales = sorted(row[0] for row in rows)
        if key not in wanted or wanted[key] in scales:
            continue
        if not scales:
            del had[key]
            said.append("the %s has no gyro: no range of one" % sensor)
            continue
        had[key] = next((one for one in scales if one >= wanted[key]), scales[-1])
        said.append("the %s has no ±%g %s but %s: ±%g is taken" % (
            sensor, wanted[key], unit, " ".join("%g" % one for one in scales), had[key]))
    if wanted.get("rate_hz", 0) > driver.MOST_HZ:
        had["rate_hz"] = driver.MOST_HZ
        said.append("the %s is polled %d times a second at most: %d are taken"
                    % (sensor, driver.MOST_HZ, driver.MOST_HZ))
    return had, said
