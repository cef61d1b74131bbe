"""Typical sizes of each effect on each chip, with their sources.

SIZES[effect][chip] = (size, source); one number stands for every coefficient unless a dict of
keys says otherwise. Chips: a sensor's name with "-accel" or "-gyro", and adxl345 and itg3205,
which have one of them. What a data sheet states is in datasheets.py and comes from there for
every chip; what none states is here, said to be so, with what stands in for it.
"""
import math

from sixflip.chips import catalogue
from sixflip_sim import worlds
from sixflip_sim.effects import datasheets

_MPU = "MPU-6050 PS rev 3.4, table 6."
_ADXL = "ADXL345 rev E, table 1"
_ITG = "ITG-3205 PS rev 1.0, table 3.1"
_SEEN = "not stated in the data sheet: seen on recorded units"
_JUDGED = "not stated in the data sheet: judged from the range of published units"

NOISE = {}      # standard deviation a sample at 100 Hz, (x, y, z), mg or deg/s; and its source
# Slow noise is in no sheet: as on recorded units of these four, of the others as much less as
# their white noise is.
FLICKER = {  # level of each of the exponentials of 10...1000 s, mg or deg/s
    "mpu6050-accel": 0.05, "mpu6050-gyro": 0.001, "adxl345": 0.05, "itg3205": 0.004,
}
# Floor of the Allan deviation (bias instability times 0.664) of a typical part, mg or deg/s:
# ADXL345 rev E figure 53; the others as seen on published Allan plots of the parts.
FLOOR = {
    "mpu6050-accel": 0.08, "mpu6050-gyro": 0.002, "adxl345": 0.08, "itg3205": 0.008,
}
# Rate random walk of a gyro, deg/s per root of a second. No data sheet states it: judged, so that
# it reaches the FLOOR of the Allan deviation, which it adds K (t / 3)^1/2 to [IEEE Std 952-1997,
# annex C], after some two minutes. An accelerometer's does so after hours.
WALK = {"mpu6050-gyro": 3e-4, "itg3205": 1.2e-3}
SIZES = {"thermal_bias": {}, "thermal_scale": {}, "quadratic": {}, "cubic": {}, "filter_lag": {}}
STANDS_IN = {
    "warm_up": {
        "mpu6050-accel": (4.0, _JUDGED), "mpu6050-gyro": (0.05, _JUDGED),
        "adxl345": (4.0, _JUDGED), "itg3205": (0.3, _JUDGED)},
    "thermal_rate": {
        "mpu6050-accel": (1.0, _JUDGED), "mpu6050-gyro": (0.02, _JUDGED),
        "adxl345": (1.0, _JUDGED), "itg3205": (0.05, _JUDGED)},
    "cross_quadratic": {
        "mpu6050-accel": (4.0, _JUDGED), "adxl345": (4.0, _JUDGED)},
    "asymmetry": {
        "mpu6050-accel": (3.0, _JUDGED), "mpu6050-gyro": (5.9, _SEEN),
        "adxl345": (3.0, _JUDGED), "itg3205": (5.9, _SEEN)},
    "g_sensitivity": {
        "mpu6050-gyro": (0.1, _MPU + "1"), "itg3205": (0.1, _ITG)},
    "drift": {
        "mpu6050-accel": (0.4, "0.3-0.45 mg at 1 s " + _SEEN), "mpu6050-gyro": (0.005, _JUDGED),
        "adxl345": (0.4, _ADXL + ", figure 53"), "itg3205": (0.01, _JUDGED)},
    "quantisation": {
        "mpu6050-accel": (4, "4 counts on several units"), "mpu6050-gyro": (2, _JUDGED),
        "adxl345": (2, _JUDGED), "itg3205": (2, _JUDGED)},
    "dead_band": {
        "mpu6050-accel": (8, _JUDGED), "mpu6050-gyro": (8, _JUDGED),
        "adxl345": (2, _JUDGED), "itg3205": (4, _JUDGED)},
    "saturation": {
        "mpu6050-accel": (1, "the rail of the range"), "mpu6050-gyro": (1, "the rail"),
        "adxl345": (1, "the rail"), "itg3205": (1, "the rail")},
    "vibration": {
        "mpu6050-accel": (20.0, "a line near 150 Hz " + _SEEN), "mpu6050-gyro": (0.5, _JUDGED),
        "adxl345": (20.0, _JUDGED), "itg3205": (0.5, _JUDGED)},
    "vibration_rectification": {
        "mpu6050-accel": (5.0, "as quadratic: it is the same bend"),
        "adxl345": (5.0, "as quadratic: it is the same bend")},
    "sample_rate": {
        "mpu6050-accel": (0.7, "99.3 and 100.3 Hz seen for 100"),
        "mpu6050-gyro": (0.7, "99.3 and 100.3 Hz seen for 100"),
        "adxl345": (2.0, "2-4 % " + _SEEN), "itg3205": (2.0, _ITG + ": 2 %")},
    "dropped_samples": {
        "mpu6050-accel": (0.1, _JUDGED), "mpu6050-gyro": (0.1, _JUDGED),
        "adxl345": (0.1, _JUDGED), "itg3205": (0.1, _JUDGED)},
    "hysteresis": {
        "mpu6050-accel": (5.0, "as creep: what fades slowly and what stays are one memory"),
        "mpu6050-gyro": (0.01, _JUDGED),
        "adxl345": (5.0, "as creep"), "itg3205": (0.02, _JUDGED)},
    "creep": {
        "mpu6050-accel": (5.0, "5 mg, tau 60-70 s, seen on Z"), "adxl345": (5.0, _JUDGED)},
    "lever_arm": {
        "mpu6050-accel": (3.0, "3 cm at 90 deg/s is 7.5 mg"),
        "adxl345": (3.0, "3 cm at 90 deg/s is 7.5 mg")},
    "box_tilt": {
        "mpu6050-accel": (0.1, "0.1 deg is 1.7 mg"), "adxl345": (0.1, "0.1 deg is 1.7 mg")},
    "table_tilt": {
        "mpu6050-accel": (1.0, _JUDGED), "adxl345": (1.0, _JUDGED)},
    "local_gravity": {
        "mpu6050-accel": (2.6, "half the difference between equator and pole (WGS84)"),
        "adxl345": (2.6, "half the difference between equator and pole (WGS84)")},
    "torn_reads": {
        "mpu6050-accel": (0.1, _JUDGED), "mpu6050-gyro": (0.1, _JUDGED),
        "adxl345": (0.1, _JUDGED), "itg3205": (0.1, _JUDGED)},
    "supply": {
        "mpu6050-accel": (5.0, _JUDGED), "mpu6050-gyro": (2.0, _MPU + "1: 0.2 deg/s per 100 mV"),
        "adxl345": (50.0, _ADXL + ", figures 10 to 15"), "itg3205": (2.0, _ITG)},
    "axis_swap": {
        "mpu6050-accel": (1, "a board soldered or labelled otherwise"),
        "mpu6050-gyro": (1, "a board soldered or labelled otherwise"),
        "adxl345": (1, "a board soldered or labelled otherwise"),
        "itg3205": (1, "a board soldered or labelled otherwise")},
    "earth_rate": {
        "mpu6050-gyro": (0.00295, "0.0042 deg/s at 45 deg of latitude"),
        "itg3205": (0.00295, "0.0042 deg/s at 45 deg of latitude")},
}


def noise_at(chip, rate_hz, step=0.0):
    """Standard deviations of a sample, (x, y, z), mg or deg/s: NOISE is at 100 Hz, and the filter
    that the drivers choose is as much wider as the samples come faster. step: of a count, whose
    rounding is noise of its own (a step / sqrt(12))."""
    return tuple([math.sqrt(sigma * sigma * rate_hz / 100.0 + step * step / 12.0)
                  for sigma in NOISE[chip][0]])


def step_of(sensor, kind, full_scale=None):
    """What a count is, mg or deg/s, at a full scale (g, deg/s); None: the chip's usual one."""
    name = datasheets.chips(sensor)[kind == "gyro"]
    driver = catalogue.driver(name)
    rows = driver.GYRO_RANGES if kind == "gyro" else driver.ACCEL_RANGES
    usual = getattr(driver, "RANGES", None)
    wanted = full_scale or (usual[kind == "gyro"] if usual else rows[-1][0])
    counts = [row[1] for row in rows if row[0] == wanted]
    return (1.0 if kind == "gyro" else 1000.0) / counts[0]


def noise_of(sensor, kind, rate_hz, full_scale=None):
    """Standard deviations of a sample of a sensor at a rate and a full scale, its counts' rounding
    among them."""
    return noise_at(chip_of(sensor, kind), rate_hz, step_of(sensor, kind, full_scale))


# ms and share of a sample's interval: a chip's own filters are up to 0.98 ms apart (RM-MPU-6000A,
# DLPF_CFG), two chips are read in turn, a simulator's rates are those of a part of a step before.
FILTERS_APART_MS, READ_WITHIN = 0.98, 0.1


def read_apart(rate_hz):
    """ms: standard deviation of the time between the moments at which the two sensors of a row
    are read, in any log: what is less is no delay of one of them."""
    return max(FILTERS_APART_MS, 1000.0 * READ_WITHIN / rate_hz)


# The widest range of sizes that the diagnosis believes is 20 times the typical one (a crooked
# box); where only far larger ones would show, a capture says nothing about the effect at all.
DETERMINED_TIMES = 100.0


def determined(smallest, usual):
    """Whether a capture that shows sizes from `smallest` on says anything about an effect."""
    return math.isfinite(smallest) and (
        usual is None or smallest <= DETERMINED_TIMES * abs(usual))


def chip_of(sensor, kind):
    """The chip behind a sensor for kind accel or gyro; of one that we do not know, an MPU6050."""
    if sensor in ("gy85", "adxl345", "itg3205"):
        return "adxl345" if kind == "accel" else "itg3205"
    return "%s-%s" % (sensor if sensor in catalogue.SENSORS else "mpu6050", kind)


def _by_axis(values):
    """Three figures as one number where they are the same."""
    return values[0] if len(set(values)) == 1 else dict(zip("xyz", values))


def _of_the_data_sheet(sensor, kind, bandwidth_hz):
    """{effect: size} of what a data sheet has figures for."""
    bend = datasheets.figure(sensor, kind, "bend")
    delay = datasheets.figure(sensor, kind, "delay_ms")
    found = {"thermal_bias": _by_axis(datasheets.figures(sensor, kind, "offset_per_c")),
             "thermal_scale": datasheets.figure(sensor, kind, "scale_per_c"),
             "filter_lag": delay or 1000.0 / (2.0 * math.pi * bandwidth_hz)}
    if bend is not None:    # of full scale, at 1 g and at 100 °/s: mg and °/s
        found["quadratic"] = found["cubic"] = 10.0 * bend if kind == "accel" else bend
    return found


def _bandwidths(sensor):
    """(accelerometer, gyro) Hz with the filters that the driver takes for 100 samples a second."""
    if sensor == "gy85":
        return 100.0, 42.0      # ADXL345 table 7, 200 Hz output; ITG-3205 section 8.4, DLPF_CFG 3
    return worlds.simulated(sensor).nominal_hz


def _add(sensor):
    """The entries of a sensor."""
    seen = sensor in worlds.SEEN
    for kind, hz, sigma in zip(("accel", "gyro"), _bandwidths(sensor), worlds.usual_noise(sensor)):
        if datasheets.chips(sensor)[kind == "gyro"] is None:
            continue
        chip, source = chip_of(sensor, kind), datasheets.source(sensor, kind)
        like = chip if chip in FLICKER else "mpu6050-" + kind
        density = datasheets.figures(sensor, kind, "density")
        NOISE[chip] = (sigma,) * 3, "recorded units; " * seen + source
        quieter = max(density) / datasheets.figure("mpu6050", kind, "density")
        FLICKER.setdefault(chip, quieter * FLICKER[like])
        FLOOR.setdefault(chip, quieter * FLOOR[like])
        if kind == "gyro":
            WALK.setdefault(chip, quieter * WALK[like])
        for effect, size_ in _of_the_data_sheet(sensor, kind, hz).items():
            SIZES[effect][chip] = size_, source
        for effect, known in STANDS_IN.items():
            if like in known:
                size_, said = known[like]
                SIZES.setdefault(effect, {})[chip] = (
                    size_, said if chip == like else "as the MPU6050: " + said)
        for effect in ("quadratic", "cubic"):
            if chip not in SIZES[effect]:
                size_, said = SIZES[effect]["mpu6050-" + kind]
                SIZES[effect][chip] = size_, "no figure in %s, as the MPU6050: %s" % (source, said)


for _sensor in catalogue.SENSORS:
    if _sensor != "adxl345":    # half of a GY-85
        _add(_sensor)


def size(effect, sensor, kind, key=None):
    """(typical size, source) of an effect on a chip, or (None, "") where it has none."""
    value, source = SIZES.get(effect, {}).get(chip_of(sensor, kind), (None, ""))
    if isinstance(value, dict):
        value = value.get(key) if key is not None else sorted(value.values())[1]
    return value, source
