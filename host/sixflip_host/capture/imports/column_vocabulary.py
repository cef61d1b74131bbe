"""The words in which the columns of many people's tables speak of sensors, units and times."""

ACCEL, GYRO, MAG, TEMP = "a", "g", "m", "t"
WORDS = {
    ACCEL: {"a", "f", "acc", "acce", "accel", "accelerometer", "acceleration", "accelerations",
            "accels", "accelerometers", "linacc", "gf",
            "fb"},      # the last two: g-force, and NaveGo's force in the body's frame
    GYRO: {"g", "w", "gyr", "gyro", "gyros", "gyroscope", "gyroscopes", "omega", "angvel",
           "rotationrate", "angrate", "wb"},        # the last one: NaveGo's
    MAG: {"m", "mag", "magnetometer", "magnetic"},
}
PAIRS = {ACCEL: (("lin", "acc"), ("linear", "acceleration"), ("linear", "accel"),
                 ("specific", "force"), ("acc", "smooth"), ("acc", "adc")),
         GYRO: (("ang", "vel"), ("angular", "velocity"), ("angular", "rate"), ("angular", "vel"),
                ("rotation", "rate"), ("gyro", "adc"), ("gyro", "unfilt"))}
# What is made out of readings, or says something about them, is no reading.
DERIVED = {"covariance", "cov", "orientation", "quaternion", "quat", "bias", "offset", "std",
           "sigma", "var", "variance", "magnitude", "norm", "abs", "total", "user", "cmd",
           "setpoint", "error", "reference", "world", "enu", "ned", "clipping", "debug", "motor",
           "calibrated", "corrected", "integral", "peak", "max", "min", "mean"}
# What is read from the sensor is better than what a filter made of it, which a phone calls linear
# acceleration where it has taken gravity out, and ROS where it has not.
ESTIMATES = {"est", "estimated", "estimate", "filtered", "filt", "ekf", "fused", "linear", "lin",
             "linacc", "free", "comp", "compensated"}
# The axis before the sensor, linear acceleration and angular velocity, as mavros' topics in a CSV.
AXIS_FIRST = {"la": ACCEL, "av": GYRO}
FILLERS = {"raw", "lsb", "counts", "count", "b", "body", "imu", "field", "data", "readings",
           "reading", "values", "value", "sensor", "measured", "meas", "x", "y", "z", "chip",
           "mps2", "ms2", "radps", "rps", "dps", "mdps", "mg",
           "rs", "s"}       # the last two: a_RS_S_x of EuRoC and its followers
TIMES = {"t", "ts", "time", "times", "timestamp", "timestamps", "stamp", "seconds", "millis",
         "micros", "tick", "ticks", "clock", "datetime", "date", "utc"}
# What a row's time of arrival is called: a board's own is better, and a T alone, which is as often
# a temperature, is worse.
ARRIVALS = {"date", "server", "host", "pc", "system", "arrival", "arrived", "received", "recv",
            "rx"}
TIME_UNITS = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}     # microseconds
LONG_UNITS = {"min": 6e7, "h": 3.6e9}       # of times whose name says so, and of no others
TICKS = {"100us": 100.0}        # of those that the columns below count
# What makers count under a name that says no unit: Xsens ticks of 10 kHz [MT Low Level
# Communication Protocol, MT0101P, XDI_SampleTimeFine], its DOT whole µs [BLE Services
# Specification, table 8].
COUNTED = {"sampletimefine": {**TICKS, "us": 1.0}}
UNIT_OF_TIME = {"s": "s", "sec": "s", "secs": "s", "second": "s", "seconds": "s", "ms": "ms",
                "msec": "ms", "millis": "ms", "milliseconds": "ms", "us": "us", "µs": "us",
                "usec": "us", "micros": "us", "microseconds": "us", "ns": "ns", "nsec": "ns",
                "nanos": "ns", "nanoseconds": "ns", "min": "min", "mins": "min",
                "minutes": "min", "h": "h", "hr": "h", "hrs": "h", "hours": "h"}
# A time and its unit in one word, ustime or timems; a letter alone, as in times, is no unit.
FUSED_TIMES = {word: unit for said, unit in UNIT_OF_TIME.items()
               if unit in TIME_UNITS and len(said) > 1
               for time in ("time", "timestamp", "stamp") for word in (said + time, time + said)}
UNIT = {"m/s2": "m/s2", "m/s^2": "m/s2", "m/s²": "m/s2", "m/s/s": "m/s2", "ms-2": "m/s2",
        "m/(s^2)": "m/s2",
        "m/sec2": "m/s2", "m/sec^2": "m/s2", "mps2": "m/s2", "m_s2": "m/s2", "ms2": "m/s2",
        "mm/s2": "mm/s2", "mm/s^2": "mm/s2", "mm/s²": "mm/s2", "mm/sec^2": "mm/s2",
        "g": "g", "g's": "g", "mg": "mg", "rad/s": "rad/s", "rad/sec": "rad/s", "rads": "rad/s",
        "rad": "rad/s", "deg/s": "dps", "°/s": "dps", "deg/sec": "dps", "dps": "dps",
        "rad s^-1": "rad/s", "m s^-2": "m/s2", "mdps": "mdps",
        "radps": "rad/s", "m/s 2": "m/s2",
        "lsb": "counts", "counts": "counts", "raw": "counts"}
DEGREES = {"c": ("c", "°c", "degc", "deg c", "celsius", "centigrade"),
           "f": ("f", "°f", "degf", "deg f", "fahrenheit"), "k": ("k", "kelvin")}
KINDS = {ACCEL: ("g", "mg", "m/s2", "mm/s2", "counts"), GYRO: ("rad/s", "dps", "mdps", "counts")}
