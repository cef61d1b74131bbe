"""Whole captures through the board's own correction, all samples of one temperature at once."""

import numpy as np

from sixflip.record.correction import correction_of

from ..errors import BadFile


def corrected_rows(correction, capture):
    """(n, 6) m/s² and rad/s of a sixflip.record.correction.Correction; the last three are
    meaningless where there is no gyro. BadFile where a term needs a temperature that the
    capture does not have."""
    n = len(capture)
    gyro = np.zeros((n, 3)) if capture.gyro is None else capture.gyro
    counts = np.hstack([capture.accel, gyro]).astype(float)
    corrected = np.empty((n, 6))
    for rows, temp in _by_temperature(correction, capture):
        sample = list(counts[rows].T) + [temp]
        corrected[rows] = np.array(correction.apply(sample, [None] * 6)).T
    return corrected


def _by_temperature(correction, capture):
    """[(rows, temperature count)]; all rows at once where the temperature does not matter."""
    if not getattr(correction, "thermal", None):
        return [(slice(None), 0)] if len(capture) else []
    if capture.temp is None:
        raise BadFile("the record takes out a drift with temperature: expected a capture with a "
                      "temp column")
    order = np.argsort(capture.temp, kind="stable")
    values, starts = np.unique(capture.temp[order], return_index=True)
    return list(zip(np.split(order, starts[1:]), values.tolist()))


def corrected(record, capture, tell=None):
    """Array (n, columns) and the names of its columns: m/s², rad/s, °C. tell: as correction_of."""
    rows = corrected_rows(correction_of(record, tell), capture)
    blocks, names = [rows[:, :3]], ["ax_mps2", "ay_mps2", "az_mps2"]
    if capture.gyro is not None:
        blocks.append(rows[:, 3:])
        names += ["gx_radps", "gy_radps", "gz_radps"]
    if capture.temp is not None:
        celsius = capture.temp / capture.meta["temp_lsb_per_c"] + capture.meta["temp_offset_c"]
        blocks.append(celsius[:, None])
        names.append("temp_c")
    return np.hstack(blocks), names
