"""The parts of the C header that are the same for every record."""

FORMULA = """Formula: corrected_j = c_x M[0][j] + c_y M[1][j] + c_z M[2][j] + M[3][j],
c raw counts; m/s^2 for the accelerometer, rad/s for the gyro. M holds scale,
misalignment and bias, and the mounting where nothing below says otherwise."""
TERM_FORMULA = """and of these terms: %s
    a = (a - shift(T)) / scale(T)
    w = (w - shift(T) - coupling a) / scale(T), then both are turned by the mounting;
shift and scale are base + (k1 + k2 d) d, d = T - t0, T kept within low ... high,
T = count / lsb + offset: rows base, k1, k2 and t0, low, high, lsb, offset below."""
USE = """Use, with the counts in the order in which the chip has its axes:
    int16_t counts[3];                  from the chip, at the ranges below
    float accel[3];
    sixflip_accel(counts, accel);       m/s^2"""
USE_GYRO = """Use, with the counts in the order in which the chip has its axes:
    int16_t sample[7];      ax ay az gx gy gz temperature, at the ranges below
    float offset[3], accel[3], rate[3];
    sixflip_gyro_offset(offset);        bias as calibrated; or, better, at every power-up
    sixflip_gyro_rest(mean, offset);    mean[7]: of some seconds at rest
    sixflip_correct(sample, offset, accel, rate);       m/s^2, rad/s"""

ACCEL = """/* counts: raw x y z; out: specific force in m/s^2 */
static inline void sixflip_accel(const int16_t counts[3], float out[3])
{
    int j;
    for (j = 0; j < 3; j++)
        out[j] = (float)counts[0] * sixflip_accel_table[0][j]
            + (float)counts[1] * sixflip_accel_table[1][j]
            + (float)counts[2] * sixflip_accel_table[2][j] + sixflip_accel_table[3][j];
}
"""
PLAIN = """static inline void sixflip_all(const float c[7], const float offset[3], float accel[3],
    float rate[3])
{
    int j;
    for (j = 0; j < 3; j++) {
        accel[j] = c[0] * sixflip_accel_table[0][j] + c[1] * sixflip_accel_table[1][j]
            + c[2] * sixflip_accel_table[2][j] + sixflip_accel_table[3][j];
        rate[j] = c[3] * sixflip_gyro_table[0][j] + c[4] * sixflip_gyro_table[1][j]
            + c[5] * sixflip_gyro_table[2][j] + offset[j];
    }
}
"""
THERMAL = """static inline void sixflip_thermal(const float curve[3][3], const float range[5],
    float temp, float out[3])
{
    int j;
    float d = temp / range[3] + range[4];
    if (d < range[1])
        d = range[1];
    if (d > range[2])
        d = range[2];
    d -= range[0];
    for (j = 0; j < 3; j++)
        out[j] = curve[0][j] + (curve[1][j] + curve[2][j] * d) * d;
}
"""
TERMS = """/* In the sensor's axes; gyro_scale: what rate was divided by. */
static inline void sixflip_in_sensor(const float c[7], const float offset[3], float accel[3],
    float rate[3], float gyro_scale[3])
{
    int j;
    float temp = c[6];
    float shift[6] = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
    float scale[6] = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f};
    (void)temp;
CALLS    for (j = 0; j < 3; j++)
        accel[j] = (c[0] * sixflip_accel_table[0][j] + c[1] * sixflip_accel_table[1][j]
            + c[2] * sixflip_accel_table[2][j] + sixflip_accel_table[3][j] - shift[j])
            / scale[j];
    for (j = 0; j < 3; j++) {
        rate[j] = (c[3] * sixflip_gyro_table[0][j] + c[4] * sixflip_gyro_table[1][j]
            + c[5] * sixflip_gyro_table[2][j] + offset[j] - shift[3 + j]
            - sixflip_coupling[j][0] * accel[0] - sixflip_coupling[j][1] * accel[1]
            - sixflip_coupling[j][2] * accel[2]) / scale[3 + j];
        gyro_scale[j] = scale[3 + j];
    }
}

static inline void sixflip_all(const float c[7], const float offset[3], float accel[3],
    float rate[3])
{
    int j;
    float a[3], w[3], scale[3];
    sixflip_in_sensor(c, offset, a, w, scale);
    for (j = 0; j < 3; j++) {
        accel[j] = sixflip_turn[j][0] * a[0] + sixflip_turn[j][1] * a[1]
            + sixflip_turn[j][2] * a[2];
        rate[j] = sixflip_turn[j][0] * w[0] + sixflip_turn[j][1] * w[1]
            + sixflip_turn[j][2] * w[2];
    }
}
"""
GYRO_OFFSET = """/* offset: the bias as it was calibrated, for sixflip_correct() */
static inline void sixflip_gyro_offset(float offset[3])
{
    int j;
    for (j = 0; j < 3; j++)
        offset[j] = sixflip_gyro_table[3][j];
}
"""
REST_PLAIN = """\
/* mean: seven mean counts of some seconds at rest; offset: the bias measured there */
static inline void sixflip_gyro_rest(const float mean[7], float offset[3])
{
    const float none[3] = {0.0f, 0.0f, 0.0f};
    int j;
    float accel[3], rate[3];
    sixflip_all(mean, none, accel, rate);
    for (j = 0; j < 3; j++)
        offset[j] = -rate[j];
}
"""
REST_TERMS = """\
/* mean: seven mean counts of some seconds at rest; offset: the bias measured there */
static inline void sixflip_gyro_rest(const float mean[7], float offset[3])
{
    const float none[3] = {0.0f, 0.0f, 0.0f};
    int j;
    float accel[3], rate[3], scale[3];
    sixflip_in_sensor(mean, none, accel, rate, scale);
    for (j = 0; j < 3; j++)
        offset[j] = -rate[j] * scale[j];
}
"""
CORRECT = """/* sample: raw ax ay az gx gy gz temperature; accel in m/s^2, rate in rad/s */
static inline void sixflip_correct(const int16_t sample[7], const float offset[3],
    float accel[3], float rate[3])
{
    int k;
    float c[7];
    for (k = 0; k < 7; k++)
        c[k] = (float)sample[k];
    sixflip_all(c, offset, accel, rate);
}
"""
TAIL = """
#ifdef __cplusplus
}
#endif

#endif
"""
