"""A steady turn about the vertical looks like gyro bias; how far the stored bias tells them apart.

Across the vertical gravity has shown already that nothing turns (quiet_run.py), so a bias may
have changed there by any amount. Along it a change is believed as far as switching on and
ageing (SWITCHED_ON_DPS) and temperature explain it; without a stored bias, as far as the data
sheet's zero-rate output goes.
"""

SWITCHED_ON_DPS = 1.0
UNKNOWN_TEMPERATURE_C = 15.0
ANY_DPS = 40.0  # the largest zero-rate output of a data sheet (ITG-3205 rev. 1.0, table 3.1)


def judge(rest, imu, stored):
    """Sets rest.unseen_dps, and rest.reason when it turns. stored: {"bias_dps", "temp_c"}."""
    bias = rest.bias_dps(imu)
    for x in bias:
        if abs(x) > ANY_DPS:
            rest.reason = "turning: %.0f deg/s are no bias" % x
            return
    if stored is None:
        rest.unseen_dps = imu.zero_rate_dps
        return
    warmer = UNKNOWN_TEMPERATURE_C
    if imu.has_temp and stored["temp_c"] is not None:
        warmer = abs(rest.means[6] / imu.temp_lsb_per_c + imu.temp_offset_c - stored["temp_c"])
    limit = SWITCHED_ON_DPS + imu.zero_rate_dps_per_c * warmer
    up = rest.means[:3]
    size = sum([x * x for x in up]) ** 0.5
    change = sum([(bias[k] - stored["bias_dps"][k]) * up[k] for k in range(3)]) / size
    rest.unseen_dps = limit
    if not abs(change) <= limit:
        rest.reason = ("turning about the vertical, or the gyro's bias has jumped: by %.1f deg/s, "
                       "limit %.1f" % (change, limit))
