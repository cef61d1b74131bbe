"""Captures as CAPTURE.md has them, written without the product's own writer."""

import gzip
import io
import json


def write(path, chip, t_us, counts, temp, names, rate, truth_free=None):
    """One capture file. counts (n, 6) int, temp (n,) int or None, names (n,) of str or None."""
    head = {"sensor": chip.sensor, "rate_hz": rate, "g": 9.80665,
            "accel_lsb_per_g": chip.accel_lsb_per_g, "accel_range_g": chip.accel_range_g,
            "gyro_lsb_per_dps": chip.gyro_lsb_per_dps, "gyro_range_dps": chip.gyro_range_dps}
    columns = ["t_us", "ax", "ay", "az", "gx", "gy", "gz"]
    series = [t_us.tolist()] + [column.tolist() for column in counts.T]
    if temp is not None:
        head.update(temp_lsb_per_c=chip.temp_lsb_per_c, temp_offset_c=chip.temp_offset_c)
        columns.append("temp")
        series.append(temp.tolist())
    if names is not None:
        columns.append("pose")
        series.append(names.tolist())
    head.update(truth_free or {})
    head["samples"] = len(t_us)
    form = ",".join(["%d"] * (len(columns) - (names is not None)) + ["%s"] * (names is not None))
    text = io.StringIO()
    text.write("# sixflip-capture 1\n# %s\n%s\n" % (json.dumps(head), ",".join(columns)))
    text.write("\n".join(form % row for row in zip(*series)))
    text.write("\n")
    data = text.getvalue().encode()
    if str(path).endswith(".gz"):
        data = gzip.compress(data, 1)
    with open(path, "wb") as out:
        out.write(data)
