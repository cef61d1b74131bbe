"""What may stand in a scenario: every mistake is a ValueError with one sentence."""
import math

from sixflip_sim import worlds

from ..did_you_mean import instead

# Limits of the world's numbers; what is not here is a list, a word or a flag.
LIMITS = {"tilt_deg": (0, 45), "tilt_dir_deg": (-360, 360), "flip_error_deg": (0, 45),
          "placement_scatter_deg": (0, 10), "g": (9.7, 9.9), "accel_noise_mg": (0, 1000),
          "gyro_noise_dps": (0, 1000), "accel_step": (1, 4096), "gyro_step": (1, 4096),
          "temperature_c": (-60, 150), "warm_c": (-150, 150), "warm_tau_s": (1, 1e5),
          "dwell_s": (0.5, 86400), "move_s": (0.1, 3600), "first_rest_s": (0, 86400)}
OURS = ("sensor", "seed", "effects", "order", "flavour", "freq", "faults", "mishaps", "address",
        "magnetometer", "who_am_i", "stranger")


def check_world(table):
    """A copy of the [world] table; ValueError names the key and what was expected."""
    keys = [k for k in worlds.DEFAULTS if k not in OURS]
    known(table, keys, "[world]")
    for key, (low, high) in LIMITS.items():
        if key in table:
            number(table[key], low, high, "[world] " + key, key.endswith("_step"))
    for key in ("accel_matrix", "gyro_matrix"):
        _matrix(table.get(key), "[world] " + key)
    for key in ("accel_bias_mg", "gyro_bias_dps", "lever_arm_m"):
        if key in table:
            _three(table[key], "[world] " + key)
    if table.get("turn", "left") not in ("left", "right", "alternate"):
        raise ValueError("[world] turn is %r, expected alternate, left or right" % table["turn"])
    if not isinstance(table.get("ideal", False), bool):
        raise ValueError("[world] ideal is %r, expected true or false" % (table["ideal"],))
    return dict(table)


def _matrix(rows, what):
    if rows is None:
        return
    if not isinstance(rows, list) or len(rows) != 3:
        raise ValueError("%s is %r, expected three rows of three numbers" % (what, rows))
    for row in rows:
        _three(row, what)


def _three(values, what):
    if not isinstance(values, list) or len(values) != 3:
        raise ValueError("%s is %r, expected three numbers" % (what, values))
    for value in values:
        number(value, -1e5, 1e5, what)


def number(value, low, high, what, whole=False):
    """value, or ValueError with what was expected."""
    wrong = isinstance(value, bool) or not isinstance(value, (int, float))
    if wrong or not low <= value <= high or not math.isfinite(value) or (
            whole and int(value) != value):
        raise ValueError("%s is %r, expected a %snumber from %g to %g"
                         % (what, value, "whole " if whole else "", low, high))
    return int(value) if whole else value


def known(table, keys, what):
    """ValueError for a key that means nothing here."""
    if not isinstance(table, dict):
        raise ValueError("%s is %r, expected a table" % (what, table))
    for key in table:
        if key not in keys:
            raise ValueError("%s has an unknown key %r, %s"
                             % (what, key, instead(key, sorted(keys))))
