"""How far corrected vectors are from the truth, against what others do: `make bench-accuracy`.

Simulated sessions on a tilted table: six faces, each captured twice (the second time turned by
180 degrees), 400 samples a capture. The error of one session is the RMS length of (corrected
minus true) over all directions of gravity, in mg; a cell is the median of 100 sessions.

imucal runs from its own package. imu_calib (ROS, C++) is its algorithm written down again:
every sample of the six faces three rows, one SVD for nine matrix elements and three offsets.
Exits with 1 when a claim of the README does not hold.
"""

import argparse
import math
import sys

import numpy as np

from sixflip.accelerometer import solver as accelerometer
from sixflip.chips import catalogue
from sixflip.poses.faces import AXIS, SIGN
from sixflip.poses.placement import Placement
from sixflip_sim import worlds

G = 9.80665
SAMPLES = 400
TILTS = (0, 1, 2, 3, 5)

# counts per g, white noise of one sample in mg, the largest median our method may have in mg.
# GY-85: ADXL345, 4 mg noise, 3.9 mg steps. MPU6050: 400 µg/sqrt(Hz) (datasheet 3.4, table 6.2)
# through the 44 Hz filter, whose noise bandwidth is 1.57 times that.
SENSORS = {
    "GY-85": (256, 4.0, 0.23),
    "MPU6050": (16384, 0.4 * math.sqrt(1.57 * 44), None),
}
# The others: counts of the range the driver sets, the data sheet's density behind its filter.
CHIPS = tuple(name for name in catalogue.SENSORS if name not in worlds.SEEN)
SENSORS.update({name: ({row[0]: row[1] for row in catalogue.driver(name).ACCEL_RANGES}[
    catalogue.driver(name).RANGES[0]], worlds.usual_noise(name)[0], None) for name in CHIPS})
WORST_RATIO = 1.10


class Sensor:
    """A sensor with a random matrix and offset: measured = A t + b, noise, whole counts."""

    def __init__(self, lsb, noise_mg, rng):
        self.lsb = lsb
        self.noise = noise_mg / 1e3
        self.rng = rng
        self.A = np.eye(3) + rng.normal(0, 0.02, (3, 3))
        self.b = rng.normal(0, 0.04, 3)

    def capture(self, gravity):
        """SAMPLES rows of counts of a true gravity in g."""
        clean = self.A @ gravity + self.b
        return np.rint((clean + self.rng.normal(0, self.noise, (SAMPLES, 3))) * self.lsb)


def session(sensor, tilt_deg, rng):
    """{pose code: counts (SAMPLES, 3)} of all twelve poses on a table tilted by tilt_deg."""
    captures = {}
    for face in range(6):
        k, heading = AXIS[face], rng.uniform(0, 2 * np.pi)
        for flip in (0, 1):
            gravity = np.zeros(3)
            gravity[k] = SIGN[face] * math.cos(math.radians(tilt_deg))
            across = (1 - 2 * flip) * math.sin(math.radians(tilt_deg))
            gravity[(k + 1) % 3] = across * math.cos(heading)
            gravity[(k + 2) % 3] = across * math.sin(heading)
            captures[1 + 2 * face + flip] = sensor.capture(gravity)
    return captures


def imu_calib(captures, lsb):
    """Its accel_calib: a_true = SM a - b by one SVD over every sample of six faces, (C, d)."""
    rows, truths = [], []
    for face in range(6):
        a = captures[1 + 2 * face] / lsb
        for axis in range(3):
            block = np.zeros((len(a), 12))
            block[:, 3 * axis:3 * axis + 3] = a
            block[:, 9 + axis] = -1
            rows.append(block)
            truths.append(np.full(len(a), SIGN[face] if axis == AXIS[face] else 0.0))
    x = np.linalg.lstsq(np.vstack(rows), np.concatenate(truths), rcond=None)[0]
    return x[:9].reshape(3, 3), -x[9:]


def imucal_package(captures, lsb):
    """imucal's Ferraris calibration of the six faces; the gyro's part gets an ideal gyro."""
    from imucal import FerrarisCalibration, FerrarisSignalRegions
    sections = {}
    for axis, first in (("x", 5), ("y", 9), ("z", 1)):
        for sign, pose in (("p", first), ("a", first + 2)):
            sections["acc_%s_%s" % (axis, sign)] = captures[pose] / lsb * G
            sections["gyr_%s_%s" % (axis, sign)] = np.zeros((SAMPLES, 3))
        turn = np.zeros((100, 3))
        turn[:, "xyz".index(axis)] = -360
        sections["gyr_%s_rot" % axis] = turn
        sections["acc_%s_rot" % axis] = np.zeros((100, 3))
    found = FerrarisCalibration(grav=G).compute(
        FerrarisSignalRegions(**sections), 100, from_acc_unit="m/s^2", from_gyr_unit="deg/s")
    C = np.linalg.inv(found.R_a) @ np.linalg.inv(found.K_a)
    return C, -C @ found.b_a / G


def ours(captures, lsb, level):
    """The shared core, from placements with exact integer sums, as on the board."""
    placements = []
    for pose, counts in captures.items():
        sums = counts.sum(axis=0).astype(int).tolist() + [0, 0, 0, 0]
        noise = counts.std(axis=0, ddof=1).tolist() + [0.0] * 3
        placements.append(Placement(pose, 0, SAMPLES, sums, noise, SAMPLES * 10000))
    P = np.array(accelerometer.solve(placements, lsb, G, level).P)
    return P[:3, :3].T, P[3, :3] / G


def vector_error_mg(sensor, correction):
    """RMS over all directions of gravity of |corrected - true|, mg."""
    C, d = correction
    E = C @ sensor.A - np.eye(3)
    return 1e3 * math.sqrt((E ** 2).sum() / 3 + ((C @ sensor.b + d) ** 2).sum())


def bound_mg(lsb, noise_mg):
    """Cramér-Rao bound of that error with the tilt known: 12 means, 12 parameters, gain 1.

    Twelve means on six faces give every axis a slope variance of s²/4 and an offset variance of
    s²/12; over all directions that is s²/3 per component, s² for the vector, s² the variance
    of one mean: noise and rounding (lsb²/12) over SAMPLES. That is an RMS over sessions; the
    median of so many Gaussian errors is 0.97 of it, so a ratio a little below 1 is no miracle.
    """
    return math.sqrt((noise_mg ** 2 + (1e3 / lsb) ** 2 / 12) / SAMPLES)


METHODS = (
    ("imu_calib", imu_calib),
    ("imucal 2.6", imucal_package),
    ("flip average", lambda captures, lsb: ours(captures, lsb, "flip average")),
    ("ours", lambda captures, lsb: ours(captures, lsb, "tilt solved")),
)


def medians(name, tilt, trials, methods):
    """Median error of each of the methods at one tilt, mg."""
    lsb, noise, _ = SENSORS[name]
    errors = []
    for trial in range(trials):
        rng = np.random.default_rng([trial, 10 * tilt, len(name)])
        sensor = Sensor(lsb, noise, rng)
        captures = session(sensor, tilt, rng)
        errors.append([vector_error_mg(sensor, method(captures, lsb)) for _, method in methods])
    return np.median(errors, axis=0)


def table(name, trials, methods=METHODS):
    """Print one sensor's table; returns the claims that do not hold. The last of the methods is
    the one that is claimed of."""
    lsb, noise, limit = SENSORS[name]
    bound = bound_mg(lsb, noise)
    print("%s-like: %.1f mg noise, %.2g mg steps, %d samples a capture, median of %d sessions, mg"
          % (name, noise, 1e3 / lsb, SAMPLES, trials))
    print("%10s" % "table tilt" + "".join("%14s" % title for title, _ in methods)
          + "%14s%14s" % ("bound", "ours / bound"))
    broken = []
    for tilt in TILTS:
        row = medians(name, tilt, trials, methods)
        print("%9d°" % tilt + "".join("%14.2f" % value for value in row)
              + "%14.3f%14.2f" % (bound, row[-1] / bound), flush=True)
        if limit and row[-1] > limit:
            broken.append("%s at %d°: %.3f mg, claimed %.2f" % (name, tilt, row[-1], limit))
        if row[-1] > WORST_RATIO * bound:
            broken.append("%s at %d°: %.2f times the bound, claimed %.2f"
                          % (name, tilt, row[-1] / bound, WORST_RATIO))
    print()
    return broken


def main():
    """The tables; exit code 1 when a claim does not hold."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--sensor", choices=SENSORS, help="only this one (default: all)")
    parser.add_argument("--chips", action="store_true",
                        help="only the chips that are known by their data sheets, and only our "
                        "method beside the bound: a minute instead of many")
    args = parser.parse_args()
    names = [args.sensor] if args.sensor else CHIPS if args.chips else list(SENSORS)
    methods = METHODS[-1:] if args.chips else METHODS
    broken = [claim for name in names for claim in table(name, args.trials, methods)]
    for claim in broken:
        print("claim does not hold:", claim)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
