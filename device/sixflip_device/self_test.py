"""Half a second of samples at power-up: does the sensor deliver what it should?"""

from array import array

from sixflip.poses.still_window import StillWindow

from .pacer import pacer

SAMPLES = 50
STILL_G = 0.03  # standard deviation per axis above which nobody calls it at rest


def run(board, sensor, rate_hz):
    """Returns a dict for the selftest event: ok, problems (sentences), rate_hz reached,
    noise (standard deviations in counts, ax ay az gx gy gz), still, temperature_c."""
    imu = sensor.imu
    sample = array("h", [0] * 7)
    window = StillWindow(SAMPLES, imu.accel_rail, imu.gyro_rail, 1000000 // rate_hz)
    paced = pacer(board, sensor, rate_hz)
    full = False
    while not full:
        dt = paced.next(sample)
        if dt >= 0:
            full = window.add(dt, sample)
    reached = SAMPLES * 1e6 / max(1, window.us)
    noise = [window.variance(k) ** 0.5 for k in range(6)]
    problems = []
    if window.stale:
        problems.append("stale: %d identical readings in a row" % window.stale)
    if window.accel_saturated or window.gyro_saturated:
        problems.append("saturated: a reading of %d, full scale"
                        % (window.accel_saturated or window.gyro_saturated))
    if reached < 0.9 * rate_hz:
        problems.append("too slow: %.0f samples a second, expected %d" % (reached, rate_hz))
    temp_c = None
    if imu.has_temp:
        temp_c = window.total(6) / SAMPLES / imu.temp_lsb_per_c + imu.temp_offset_c
    return {"ok": not problems, "problems": problems, "rate_hz": reached, "noise": noise,
            "still": max(noise[:3]) < STILL_G * imu.accel_lsb_per_g,
            "temperature_c": temp_c, "bus_errors": sensor.errors}
