"""What a real sensor adds of itself to each channel, which its simulator lacks: it is in the
difference of two logs whatever the simulator's conventions are.
"""
import numpy as np

# What a real part does of itself, at three times the size that datasheets give: MPU-6050 PS rev
# 3.4, tables 6.1 and 6.2 (35 mg and 20 deg/s over 60 degC, 0.5 % and 0.2 % nonlinearity, 0.1
# deg/s/g). Scales that differ between the two signs: of a gyro 5.9 %, which were seen on parts
# [GAP.md, "Effects"], of an accelerometer as much as a square. m/s2 and rad/s for each unit of the
# column.
OWN = {"accel": {"celsius": 0.03, "fading": 0.3, "line": 0.15, "pairs": 0.15, "signs": 0.15,
                 "force": 0.0},
       "gyro": {"celsius": 0.017, "fading": 0.017, "line": 0.017, "pairs": 0.006, "signs": 0.06,
                "force": 0.006}}
FADES_S = (30.0, 120.0)  # time constants of what fades: of a minute's log, and of warming up
KNOTS = 8  # of the bent line of an axis: four a side, a front end that levels off has one or two
BENT = 0.03  # of a reading, by which such a line may be off: a bend of 3 % (SHAPE)


def of_everything(kind, t, celsius, force, rate, g):
    """(columns (n, q), prior sizes (q,)): what goes with the time, the temperature and what
    acts."""
    time, motion = of_time(kind, t, celsius), of_motion(kind, force, rate, g)
    return np.concatenate([time[0], motion[0]], 1), np.concatenate([time[1], motion[1]])


def of_time(kind, t, celsius):
    """What goes with the time and the temperature."""
    size = OWN[kind]
    fades = [np.exp(-(t - t[0]) / tau) for tau in FADES_S]
    columns = [x - x.mean() for x in fades] + [(t - t.mean()) / np.ptp(t)]
    sizes = [size["fading"]] * len(FADES_S) + [size["line"]]
    if celsius is not None and np.ptp(celsius) > 0.3:
        columns.append(celsius - celsius.mean())
        sizes.append(size["celsius"])
    return np.stack(columns, 1), np.array(sizes)


def of_motion(kind, force, rate, g):
    """What goes with what acts."""
    size, columns, sizes = OWN[kind], [], []
    f = force / g
    own = f if kind == "accel" else rate
    for name, bent in (("pairs", pairs(own)), ("signs", np.abs(own))):
        columns += list((bent - bent.mean(axis=0)).T)
        sizes += [size[name]] * bent.shape[1]
    if size["force"]:
        columns += list((f - f.mean(axis=0)).T)
        sizes += [size["force"]] * 3
    return np.stack(columns, 1), np.array(sizes)


def bent(readings):
    """(columns (n, 3 KNOTS), sizes): of readings (n, 3) any line of each axis that bends at
    knots evenly apart, by hats."""
    columns, sizes = [], []
    for own in readings.T:
        knots = np.linspace(own.min(), own.max(), KNOTS)
        hats = np.stack([np.interp(own, knots, hat) for hat in np.eye(KNOTS)], 1)
        columns.append(hats - hats.mean(axis=0))
        sizes += [BENT * float(np.abs(own).max())] * KNOTS
    return np.concatenate(columns, 1), np.array(sizes)


def of_products(kind, force, rate, g):
    """(columns (n, 21), sizes): the products of two of all readings, g and rad/s, in each channel
    as large as what drifts."""
    columns = pairs(np.concatenate([force / g, rate], 1))
    return columns - columns.mean(axis=0), np.full(columns.shape[1], OWN[kind]["line"])


def pairs(x):
    """(n, k (k + 1) / 2): the products of two of the columns of x (n, k)."""
    k = x.shape[1]
    return np.stack([x[:, i] * x[:, j] for i in range(k) for j in range(i, k)], 1)
