"""A correction record as a JSON object, units in the names."""

from .. import record_terms
from ..json_numbers import finite


def record_json(record):
    """dict of a Record; sections that were not measured are null, terms {name: fields of
    sixflip_host.record_terms} those that were found."""
    return finite({
        "format": 1, "kind": "sixflip correction record", "sequence": record.sequence,
        "session": record.session, "float_bits": record.float_bits, "chip": record.chip,
        "who_am_i": list(record.who_am_i), "accel_range_g": record.accel_range_g,
        "gyro_range_dps": record.gyro_range_dps, "accel_lsb_per_g": record.accel_lsb_per_g,
        "gyro_lsb_per_dps": record.gyro_lsb_per_dps, "temp_c": record.temp_c,
        "g": record.g, "unix_time": record.time or None, "accel": record.accel,
        "gyro": record.gyro, "gyro_bias": record.gyro_bias, "mounting": record.mounting,
        "flips": record.flips, "terms": record_terms.terms(record)})
