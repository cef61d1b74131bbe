"""Effects that can be seen in the real recordings, fitted and simulated again.

Rows are (what, unit, real, simulated). Misalignment and g-sensitivity: Xsens, 38 poses.
Vibration, rail hits and thermal slope: MPU6050 on a tree.
"""
import numpy as np

from sixflip import STANDARD_G

from ..calibrate import multiposition
from ..capture import recordings
from ..experiment import signal_measures as measures
from . import replica

G_XSENS = 9.81744  # where it was recorded (imu_tk's own test program)
FIRST_REST = 5001
LSB_ACCEL, LSB_RATE = 415.0, 4778.0
LSB_G = 16384.0
POSE_S = 4.0


def rows(place):
    return xsens(place) + vibration(place) + rails(place) + thermal(place)


def thermal(place):
    """Slope of the Z axis over temperature: fitted to the coldest and the warmest file, and
    the mean of the one in between predicted."""
    files = [recordings.tree(place, "non_event_far_new_sd_" + v) for v in ("v3", "v10", "v24")]
    temps = np.array([t.mean() for _, t, _ in files])
    means = np.array([c.mean(axis=0) for c, _, _ in files])
    slope = (means[2] - means[0]) / (temps[2] - temps[0]) / (LSB_G / 1000.0)  # mg/degC
    spec = dict(zip("xyz", slope.tolist()), effect="thermal_bias", reference_c=float(temps[0]))
    noise = replica.Noise(files[0][0], LSB_G / 1000.0, files[0][2])
    simulated = []
    for number, t in enumerate(temps):
        scene = replica.HeldScene(means[0] / LSB_G * STANDARD_G, 1e9, float(t))
        model = replica.accel_model(scene, replica.UNIT, [0.0] * 3, noise.white, [spec],
                                    number + 1)
        simulated.append(replica.counted(model, "accel", LSB_G, 333.0, 3996).mean(axis=0))
    simulated = np.array(simulated)
    refit = np.polyfit(temps, simulated[:, 2], 1)[0]
    real = np.polyfit(temps, means[:, 2], 1)[0]
    return [("tree Z over temperature", "counts/degC", float(real), float(refit)),
            ("tree Z at the temperature left out", "counts", float(means[1, 2]),
             float(simulated[1, 2]))]


def vibration(place):
    """The chainsaw's line near Nyquist: fitted to the first half, looked for in the second."""
    counts, _, rate = recordings.tree(place, "chainsaw_1")
    half = len(counts) // 2
    first, second = counts[:half], counts[half:]
    frequency, amplitude, phase = measures.line(first[:, 0], rate, 100.0)
    spec = {"effect": "vibration", "x": amplitude / (LSB_G / 1000.0),
            "frequency_hz": float(frequency), "phase": phase}
    twin = replica.accel_at_rest(first, LSB_G, rate, len(second), more=[spec])
    real_line, twin_line = (measures.line(x[:, 0], rate, 100.0) for x in (second, twin))
    return [("tree chainsaw line", "Hz", real_line[0], twin_line[0]),
            ("tree chainsaw line amplitude", "mg", real_line[1] / 16.384,
             twin_line[1] / 16.384),
            ("tree chainsaw X, all of it, rms", "mg", float(second[:, 0].std()) / 16.384,
             float(twin[:, 0].std()) / 16.384)]


def rails(place):
    """Shocks to the rail: noise as large as in the recording, and how often it hits. The saw
    comes and goes and the hits are few, so here all of the recording is fitted and judged."""
    counts, _, rate = recordings.tree(place, "chain_far_new_sd_c39")
    twin = replica.accel_at_rest(counts, LSB_G, rate, len(counts))
    return [("tree chain far, samples on a rail", "%",
             100.0 * float(measures.railed(counts).mean()),
             100.0 * float(measures.railed(twin).mean())),
            ("tree chain far, rms", "mg", float(counts.std(axis=0).mean()) / 16.384,
             float(twin.std(axis=0).mean()) / 16.384)]


def xsens(place):
    """Misalignment and g-sensitivity out of 38 poses, put into the simulator and found again."""
    accel, gyro = recordings.xsens(place)
    fit = multiposition.search(accel / LSB_ACCEL, G_XSENS, FIRST_REST)
    poses = np.array([accel[run.first:run.end].mean(axis=0) for run in fit.rests]) / LSB_ACCEL
    rates = np.array([gyro[run.first:run.end].mean(axis=0) for run in fit.rests]) / LSB_RATE
    true, inverse = fit.correct(poses), np.linalg.inv(fit.U)
    scene = replica.HeldScene(true, POSE_S)
    n = int(POSE_S * 100 * len(true))
    noise = replica.Noise(accel[100:5000], LSB_ACCEL * STANDARD_G / 1000.0, 100.0)
    model = replica.accel_model(scene, inverse.tolist(), -inverse @ fit.offset, noise.white,
                                noise.effects("accel", 1), 1)
    counts = replica.counted(model, "accel", LSB_ACCEL * STANDARD_G, 100.0, n)
    twin = counts.reshape(len(true), -1, 3).mean(axis=1) / LSB_ACCEL
    rows = [("xsens misalignment", "mg", misalignment(poses), misalignment(twin))]
    return rows + g_sensitivity(scene, true, rates, gyro, n)


def misalignment(poses):
    """Root mean square of |a| - g in mg when only scales and biases are fitted."""
    def residual(p):
        return np.linalg.norm(poses * p[:3] + p[3:], axis=1) - G_XSENS
    from scipy.optimize import least_squares
    fit = least_squares(residual, [1.0] * 3 + [0.0] * 3, x_scale=[1e-2] * 3 + [0.1] * 3)
    return float(np.sqrt(np.mean(fit.fun ** 2)) / STANDARD_G * 1000.0)


def g_sensitivity(scene, true, rates, gyro, n):
    """Largest entry and norm of the 3x3 matrix, deg/s/g, by regression over the poses."""
    def regressed(means):
        columns = np.hstack([true / STANDARD_G, np.ones((len(true), 1))])
        return np.linalg.lstsq(columns, means, rcond=None)[0][:3].T
    matrix = regressed(np.degrees(rates))
    spec = {"effect": "g_sensitivity"}
    for i in range(3):
        for j in range(3):
            spec["xyz"[i] + "xyz"[j]] = float(matrix[i, j])
    lsb = LSB_RATE * np.pi / 180.0
    noise = replica.Noise(gyro[100:5000], lsb, 100.0)
    model = replica.gyro_model(scene, [0.0] * 3, noise.white,
                               [spec] + noise.effects("gyro", 1), 2)
    counts = replica.counted(model, "gyro", lsb, 100.0, n)
    refitted = regressed(counts.reshape(len(true), -1, 3).mean(axis=1) / lsb)
    return [("xsens g-sensitivity, largest", "deg/s/g", float(np.abs(matrix).max()),
             float(np.abs(refitted).max())),
            ("xsens g-sensitivity, norm", "deg/s/g", float(np.linalg.norm(matrix)),
             float(np.linalg.norm(refitted)))]
