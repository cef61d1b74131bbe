"""A steady turn about the vertical looks like gyro bias; how far the stored bias tells them apart.

Across the vertical gravity has shown already that nothing turns (quiet_run.py), so a bias may
have changed there by any amount. Along it a change is believed as far as switching on and
ageing (SWITCHED_ON_DPS) and temperature explain it; without a stored bias, as far as the data
sheet's zero-rate output goes.
"""

SWITCHED_ON_DPS = 1.0
# Zero-rate output over the whole range of 125 K: +-20 deg/s (MPU-6050 specification rev. 3.4,
# table 6.1), +-40 deg/s (ITG-3205 data sheet rev. 1.0, table 3.1); and at 25 degrees C.
DPS_PER_C = {"mpu6050": 0.16, "gy85": 0.32}
UNKNOWN_TEMPERATURE_C = 15.0
LARGEST_DPS = {"mpu6050": 20.0, "gy85": 40.0}
ANY_DPS = 40.0


def judge(rest, imu, stored):
    """Sets rest.unseen_dps, and rest.reason when it turns. stored: {"bias_dps", "temp_c"}."""
    bias = rest.bias_dps(imu)
    for x in bias:
        if abs(x) > ANY_DPS:
            rest.reason = "turning: %.0f deg/s are no bias" % x
            return
    if stored is None:
        rest.unseen_dps = LARGEST_DPS.get(imu.sensor, ANY_DPS)
        return
    warmer = UNKNOWN_TEMPERATURE_C
    if imu.has_temp and stored["temp_c"] is not None:
        warmer = abs(rest.means[6] / imu.temp_lsb_per_c + imu.temp_offset_c - stored["temp_c"])
    limit = SWITCHED_ON_DPS + DPS_PER_C.get(imu.sensor, 0.32) * warmer
    up = rest.means[:3]
    size = sum([x * x for x in up]) ** 0.5
    change = sum([(bias[k] - stored["bias_dps"][k]) * up[k] for k in range(3)]) / size
    rest.unseen_dps = limit
    if not abs(change) <= limit:
        rest.reason = ("turning about the vertical, or the gyro's bias has jumped: by %.1f deg/s, "
                       "limit %.1f" % (change, limit))
