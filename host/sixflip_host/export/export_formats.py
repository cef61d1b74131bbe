"""A correction in the conventions of other programs, the formula written into each file."""

import json
import math

import numpy as np

from sixflip import STANDARD_G

from ..errors import BadFile
from .affine_correction import AffineCorrection

IMUCAL_VERSION = "2.0.0"        # of its file format


def imu_calib_yaml(path, record, temp_c=None):
    """Text for the ROS node apply_calib (dpkoch/imu_calib): SM row by row, and bias."""
    affine = AffineCorrection(path, record, temp_c)
    A, o = affine.accel
    lines = affine.origin() + affine.left_out() + [
        "formula of imu_calib: corrected = SM * raw - bias, SM row by row",
        "units: m/s^2 in and out, the bias too; SM has none",
        "the node knows no gyro scale: it subtracts the mean of its first samples"]
    return "%sSM:\n%sbias:\n%s" % (_comment(lines), _items(A.ravel()), _items(-o))


def _comment(lines):
    return "".join("# %s\n" % line for line in lines)


def _items(values):
    return "".join("  - %.17g\n" % value for value in values)


def imufusion_python(path, record, temp_c=None):
    """Text of a Python module for imufusion (x-io Fusion): misalignment, sensitivity, offset."""
    affine = AffineCorrection(path, record, temp_c)
    lines = affine.origin() + affine.left_out() + [
        "formula of imufusion: calibrated = misalignment * (sensitivity o (raw - offset)),",
        "o: element by element, misalignment after sensitivity (model_inertial of imufusion,",
        "FusionModelInertial or FusionCalibrationInertial in C)",
        "units: raw and offset in counts of the chip; calibrated in g (1 g = the gravity above)",
        "and in deg/s, as the AHRS of Fusion expects them"]
    text = _comment(lines) + "import numpy as np\n"
    for name, part, lsb, unit in _fusion_parts(affine):
        A, o = part
        A, o = A / lsb * unit[0], o * unit[1]
        size = np.linalg.norm(A, axis=0)
        offset = -np.linalg.solve(A, o)
        text += "\n%s_misalignment = np.array(%s)\n%s_sensitivity = np.array(%s)\n" \
            "%s_offset = np.array(%s)\n" % (name, _array(A / size), name, _array(size), name,
                                           _array(offset))
    return text


def _fusion_parts(affine):
    """Name, (A, o), counts per unit in, factors (of A, of o) to Fusion's units."""
    record = affine.record
    g = 1 / record.g
    parts = [("accelerometer", affine.accel, record.accel_lsb_per_g, (STANDARD_G * g, g))]
    if affine.gyro:
        parts.append(("gyroscope", affine.gyro, record.gyro_lsb_per_dps, (1.0, 1.0)))
    return parts


def _array(values):
    if values.ndim == 1:
        return "[%s]" % ", ".join("%.17g" % x for x in values)
    return "[%s]" % (",\n    ".join(_array(row) for row in values))


def imucal_json(path, record, temp_c=None):
    """Text that imucal loads as a FerrarisCalibrationInfo."""
    affine = AffineCorrection(path, record, temp_c)
    if affine.gyro is None:
        raise BadFile("%s is of a sensor without a gyro: imucal needs both, expected another "
                      "format" % path)
    lines = affine.origin() + affine.left_out(coupled=True) + [
        "formula of imucal: acc = R_a^-1 K_a^-1 (raw - b_a), "
        "gyr = R_g^-1 K_g^-1 (raw - K_ga acc - b_g)",
        "units: m/s^2 and deg/s in and out"]
    answer = {"acc_unit": "m/s^2", "gyr_unit": "deg/s", "from_acc_unit": "m/s^2",
              "from_gyr_unit": "deg/s", "comment": "; ".join(lines)}
    for letter, (A, o) in (("a", affine.accel), ("g", affine.gyro)):
        inverse = np.linalg.inv(A)
        size = np.linalg.norm(inverse, axis=1)
        answer["K_" + letter] = np.diag(size).tolist()
        answer["R_" + letter] = (inverse / size[:, None]).tolist()
        answer["b_" + letter] = (-inverse @ o).tolist()
    K_ga = np.zeros((3, 3)) if affine.coupling is None else np.linalg.solve(
        affine.gyro[0], affine.coupling)
    answer.update(K_ga=K_ga.tolist(), cal_type="Ferraris", _format_version=IMUCAL_VERSION)
    if not all(math.isfinite(x) for x in answer["b_a"] + answer["b_g"]):
        raise BadFile("%s: its matrices cannot be inverted" % path)
    return json.dumps(answer, indent=1) + "\n"
