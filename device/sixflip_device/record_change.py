"""Is a new calibration worth a write to the flash?"""

TIMES = 2.0  # standard errors of the difference


def _same(old, new):
    """P of two sections agrees within TIMES its uncertainty (and has not become surer)."""
    for i in range(len(old["P"])):
        for j in range(3):
            s, t = old["sigma_P"][i][j], new["sigma_P"][i][j]
            if s is None or t is None or t < 0.5 * s:
                return False
            if abs(new["P"][i][j] - old["P"][i][j]) > TIMES * (s * s + t * t) ** 0.5:
                return False
    return True


def unchanged(old, new):
    """True when new says nothing that old does not say as well."""
    if old.measured() != new.measured() or old.g != new.g:
        return False
    for name in ("accel", "gyro"):
        a, b = getattr(old, name), getattr(new, name)
        if a is None:
            continue
        if a["verdict"] != b["verdict"] or not _same(a, b):
            return False
    return True
