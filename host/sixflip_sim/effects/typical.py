"""Typical sizes of each effect on each chip, with their sources.

SIZES[effect][chip] = (size, source); one number stands for every coefficient unless a dict of
keys says otherwise. Chips: mpu6050-accel mpu6050-gyro adxl345 itg3205, and "-accel" and "-gyro"
of every other sensor, whose figures are those of datasheets.py; where that has none, the
MPU6050's stands in its place, and the source says so.
"""
import math

from sixflip.chips import catalogue
from sixflip_sim import worlds
from sixflip_sim.effects import datasheets

_MPU = "MPU-6050 PS rev 3.4, table 6."
_ADXL = "ADXL345 rev E, table 1"
_ITG = "ITG-3205 PS rev 1.0, table 3.1"
_SEEN = "seen on recorded units"
_JUDGED = "judged from the range of published units"

NOISE = {  # standard deviation a sample at 100 Hz, (x, y, z); mg or deg/s
    "mpu6050-accel": ((3.3, 3.0, 4.6), _SEEN + "; " + _MPU + "2: 0.4 mg/sqrt(Hz)"),
    "mpu6050-gyro": ((0.05, 0.05, 0.05), _MPU + "1: 0.05 deg/s rms"),
    "adxl345": ((2.9, 2.9, 4.3), _ADXL + ": 0.75 LSB rms XY, 1.1 Z"),
    "itg3205": ((0.38, 0.38, 0.38), _ITG + ": 0.38 deg/s rms"),
}
FLICKER = {  # level of each of the exponentials of 10...1000 s, mg or deg/s
    "mpu6050-accel": 0.05, "mpu6050-gyro": 0.001, "adxl345": 0.05, "itg3205": 0.004,
}
# Floor of the Allan deviation (bias instability times 0.664) of a typical part, mg or deg/s:
# ADXL345 rev E figure 53; the others as seen on published Allan plots of the parts.
FLOOR = {
    "mpu6050-accel": 0.08, "mpu6050-gyro": 0.002, "adxl345": 0.08, "itg3205": 0.008,
}
# White noise density, mg or deg/s per sqrt(Hz), (x, y, z).
DENSITY = {
    "mpu6050-accel": ((0.4, 0.4, 0.4), _MPU + "2"), "mpu6050-gyro": ((0.005,) * 3, _MPU + "1"),
    "adxl345": ((0.29, 0.29, 0.43), _ADXL + ": 0.75 and 1.1 LSB rms at 100 Hz"),
    "itg3205": ((0.03, 0.03, 0.03), _ITG),
}
SIZES = {
    "thermal_bias": {
        "mpu6050-accel": ({"x": 0.5, "y": 0.5, "z": 0.9}, _MPU + "2: 35 and 60 mg over 70 degC"),
        "mpu6050-gyro": (0.1, "0.04-0.3 " + _SEEN),
        "adxl345": ({"x": 0.4, "y": 0.4, "z": 1.2}, _ADXL),
        "itg3205": (0.3, _ITG + ": 40 deg/s over 125 degC")},
    "thermal_scale": {
        "mpu6050-accel": (0.02, _MPU + "2"), "mpu6050-gyro": (0.02, _MPU + "1: 2 % over 125 degC"),
        "adxl345": (0.01, _ADXL), "itg3205": (0.1, _ITG + ": 10 %")},
    "warm_up": {
        "mpu6050-accel": (4.0, _JUDGED), "mpu6050-gyro": (0.05, _JUDGED),
        "adxl345": (4.0, _JUDGED), "itg3205": (0.3, _JUDGED)},
    "thermal_rate": {
        "mpu6050-accel": (1.0, _JUDGED), "mpu6050-gyro": (0.02, _JUDGED),
        "adxl345": (1.0, _JUDGED), "itg3205": (0.05, _JUDGED)},
    "quadratic": {
        "mpu6050-accel": (5.0, _MPU + "2: 0.5 % nonlinearity"), "mpu6050-gyro": (0.2, _MPU + "1"),
        "adxl345": (5.0, _ADXL + ": 0.5 % of full scale"), "itg3205": (0.2, _ITG + ": 0.2 %")},
    "cross_quadratic": {
        "mpu6050-accel": (4.0, _JUDGED), "adxl345": (4.0, _JUDGED)},
    "cubic": {
        "mpu6050-accel": (5.0, _MPU + "2: 0.5 % nonlinearity"), "mpu6050-gyro": (0.2, _MPU + "1"),
        "adxl345": (5.0, _ADXL + ": 0.5 % of full scale"), "itg3205": (0.2, _ITG + ": 0.2 %")},
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
    "filter_lag": {
        "mpu6050-accel": (4.9, "MPU-6050 RM rev 4.2, register 26"),
        "mpu6050-gyro": (4.8, "MPU-6050 RM rev 4.2, register 26"),
        "adxl345": (5.0, _JUDGED), "itg3205": (5.0, _JUDGED)},
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
    chip = "%s-%s" % (sensor, kind)
    return chip if chip in NOISE else "mpu6050-" + kind


def _of_the_data_sheet(sensor, kind, bandwidth_hz):
    """{effect: size} of what a data sheet has figures for."""
    bend = datasheets.figure(sensor, kind, "bend")
    found = {"thermal_bias": datasheets.figure(sensor, kind, "offset_per_c"),
             "thermal_scale": datasheets.figure(sensor, kind, "scale_per_c"),
             "filter_lag": 1000.0 / (2.0 * math.pi * bandwidth_hz)}
    if bend is not None:    # of full scale, at 1 g and at 100 °/s: mg and °/s
        found["quadratic"] = found["cubic"] = 10.0 * bend if kind == "accel" else bend
    return found


def _add(sensor):
    """The entries of a sensor that stands in datasheets.py."""
    bandwidths = worlds.simulated(sensor).nominal_hz
    noise = datasheets.noise(sensor, bandwidths)
    for kind, hz, sigma in zip(("accel", "gyro"), bandwidths, noise):
        chip, source = "%s-%s" % (sensor, kind), datasheets.source(sensor, kind)
        density = datasheets.figure(sensor, kind, "density")
        NOISE[chip] = (sigma,) * 3, source
        DENSITY[chip] = (density,) * 3, source
        # slow noise has no figure in these sheets: as much less than the MPU6050's as the white
        quieter = density / DENSITY["mpu6050-" + kind][0][0]
        FLICKER[chip] = quieter * FLICKER["mpu6050-" + kind]
        FLOOR[chip] = quieter * FLOOR["mpu6050-" + kind]
        sizes = _of_the_data_sheet(sensor, kind, hz)
        for effect, known in SIZES.items():
            if effect in sizes:
                known[chip] = sizes[effect], source
            elif "mpu6050-" + kind in known:
                size_, said = known["mpu6050-" + kind]
                known[chip] = size_, "as the MPU6050: " + said


for _sensor in catalogue.SENSORS:
    if _sensor not in worlds.SEEN:
        _add(_sensor)


def size(effect, sensor, kind, key=None):
    """(typical size, source) of an effect on a chip, or (None, "") where it has none."""
    value, source = SIZES.get(effect, {}).get(chip_of(sensor, kind), (None, ""))
    if isinstance(value, dict):
        value = value.get(key) if key is not None else sorted(value.values())[1]
    return value, source
