"""Every claim of a diagnosis beside a figure of plain_figures, and what was left unsaid."""
import numpy as np

from . import plain_figures as figures

FIVE = 5.0  # standard errors at which something has to be said
AGREES = 3.0  # and within which a size has to lie
ALLOWED = {"accel": 0.4, "gyro": 0.01}  # mg, deg/s: what parts wander by themselves in a rest


class Row:
    """claim or omission (words), figure (words), right (True, False, None: no figure)."""

    def __init__(self, claim, figure, right):
        self.claim, self.figure, self.right = claim, figure, right


def rows(plain, answer, others=()):
    """list of Row: all causes and damages, then what the plain figures show and nobody says.
    others: recordings diagnosed together with it."""
    rest = figures.rests(plain)
    found = [_judged(plain, cause, rest) for cause in answer["causes"]]
    if others:
        found = [_together([plain, *others], cause) or row
                 for cause, row in zip(answer["causes"], found)]
    found += [Row(one["words"], *_damage(plain, one, rest)) for one in answer["damage"]]
    return found + _verdict(answer, rest) + _unsaid(plain, answer, rest)


def _together(recordings, cause):
    """Row of a slope over the temperature by the rests of several files, or None."""
    if "thermal_bias" not in cause["class"]:
        return None
    words, right = [], True
    for key, value in cause["value"].items():
        one = figures.between_files(recordings, cause["sensor"], "xyz".index(key[0]))
        low, high = cause["interval_90"][key]
        words.append("%s %.3g ± %.2g between files" % (key, one.value, one.error))
        right &= abs(value - one.value) < AGREES * one.error + (high - low)
    return Row("%s %s %s" % (" or ".join(cause["class"]), cause["sensor"], " ".join(
        "%s=%.3g" % pair for pair in cause["value"].items())), "; ".join(words), bool(right))


def _damage(plain, damage, rest):
    """A plain figure of what a recording is said to have suffered."""
    sensor = damage["sensor"]
    if damage["kind"] == "repeats":
        share = figures.repeated(plain, sensor)
        return "%.3f of its rows repeat" % share, abs(
            share - 1.0 + 1.0 / damage["value"]["times"]) < 0.1
    if damage["kind"] in ("full_scale", "gravity") and sensor == "accel":
        size = figures.gravity(plain, rest)
        return "|a| is %.3f g" % size, abs(size - damage["value"]["factor"]) < 0.1
    return "no recording here has any", False


def _judged(plain, cause, rest):
    name = cause["effect"] or " or ".join(cause["class"])
    claim = "%s %s %s" % (name, cause["sensor"], " ".join(
        "%s=%.3g" % (k, v) for k, v in cause["value"].items() if v is not None))
    for effect in cause["class"]:
        if effect in JUDGES:
            return Row(claim, *JUDGES[effect](plain, cause, rest))
    return Row(claim, "no figure of its own", None)


def _steps(plain, cause, rest):
    seen = {k: figures.steps(plain, cause["sensor"], "xyz".index(k)) for k in cause["value"]} \
        if plain.counts else {}
    return "divisor %s" % seen, all(cause["value"][k] == v for k, v in seen.items()) and seen


def _band(plain, cause, rest):
    right, words = bool(plain.counts), []
    for key in cause["value"] if plain.counts else ():
        size = np.abs(plain.counts[cause["sensor"]][:, "xyz".index(key)])
        least = size[size > 0].min()
        words.append("%s: %d zeros, then %d" % (key, (size == 0).sum(), least))
        usual = figures.steps(plain, cause["sensor"], "xyz".index(key))
        right &= least > 2 * usual and (size == 0).sum() > 2 * (size < 2 * least).sum() / least
    return "; ".join(words), bool(right)


def _rails(plain, cause, rest):
    seen = {}
    for key in cause["value"]:
        axis = "xyz".index(key)
        x = plain.counts[cause["sensor"]][:, axis]
        top = max(int((x == x.max()).sum()), int((x == x.min()).sum()))
        seen[key] = figures.railed(plain, cause["sensor"], axis) or (top if top >= 5 else 0)
    return "samples at the rail %s" % seen, all(seen.values())


def _torn(plain, cause, rest):
    number = figures.near_256(plain, cause["sensor"])
    return "%d samples 256 m off" % number, number >= 3


def _rate(plain, cause, rest):
    return "%.4f Hz by count over time; a measured rate is no claim" % plain.rate, False


def _dropped(plain, cause, rest):
    lost = figures.missing(plain) if plain.stamped else 0
    percent = 100.0 * lost / (len(plain.t) + lost)
    low, _ = cause["interval_90"]["chance"]
    # Late stamps are in this figure as well: it is the most that can be missing.
    return "at most %d of %d missing, %.3g %%" % (lost, len(plain.t), percent), \
        lost > 0 and low <= 1.5 * percent


def _vibration(plain, cause, rest):
    """A line is one in the mean spectrum of all stretches, and goes on in phase over the longest;
    what is shaken at no steady frequency has a bump there."""
    sensor, words, right = cause["sensor"], [], True
    stretches = rest or [(0, len(plain.t))]
    lines = cause.get("lines") or {}
    if not lines:
        ratio = figures.shaken(plain)
        return "third differences %.1f %.1f %.1f times the quietest" % tuple(ratio), \
            all(ratio["xyz".index(k)] > 2.0 for k in cause["value"])
    for key, line in lines.items():
        p, at, bump = figures.line_at(plain, sensor, "xyz".index(key), line["hz"], stretches)
        if line["steady"]:
            share = figures.in_phase(plain, sensor, "xyz".index(key), line["hz"], stretches[0])
            words.append("%s p %.0e at %.3f Hz, %.2f of it in phase" % (key, p, at, share))
            right &= p < 1e-3 and share > 0.4
        else:
            words.append("%s %.1f times its neighbourhood about %.3g Hz" % (
                key, bump, line["hz"]))
            right &= bump > 2.0
    return "; ".join(words), right


def _slope(plain, cause, rest):
    """A slope over the temperature, by the longest rest."""
    words, right = [], True
    for key, value in cause["value"].items():
        one = figures.temperature(plain, cause["sensor"], "xyz".index(key[0]), rest[0]) \
            if rest and value is not None else None
        if one is None:
            return "no rest whose temperature moved", None
        low, high = cause["interval_90"][key]
        before, after = figures.cubic_share(plain, cause["sensor"], "xyz".index(key[0]), rest[0])
        words.append("%s %.3g ± %.2g, %.3g -> %.3g after a cubic" % (
            key, one.value, one.error, before, after))
        apart = abs(value - one.value)
        right &= apart < AGREES * one.error + 0.25 * abs(one.value) + (high - low)
        right &= one.t > 2.0 or after < 0.7 * before
    return "; ".join(words), bool(right)


def _time(plain, cause, rest):
    words, right = [], True
    for key in cause["axes"] or "xyz":
        if not rest:
            return "no rest", None
        one = figures.in_time(plain, cause["sensor"], "xyz".index(key), rest[0])
        times = figures.wander(plain, cause["sensor"], "xyz".index(key), rest[0])
        words.append("%s t = %.1f, Allan %.1f times white" % (key, one.t, times))
        right &= one.t > 3.0 or times > 1.6
    return "; ".join(words), right


def _gravity(plain, cause, rest):
    theta, error = figures.g_sensitivity(plain)
    words, right = [], True
    for key, value in cause["value"].items():
        i, j = ("xyz".index(k) for k in key)
        words.append("%s %.3f ± %.3f" % (key, theta[i, j], error[i, j]))
        right &= abs(value - theta[i, j]) < AGREES * error[i, j] + 0.4 * abs(theta[i, j])
    return ", ".join(words), right


def _lag(plain, cause, rest):
    seen = figures.lag_ms(plain)
    if seen is None:
        return "too few moves", None
    value = cause["value"]["tau"] * (-1.0 if cause["sensor"] == "accel" else 1.0)
    low, high = cause["interval_90"]["tau"]
    return "gyro %.1f ± %.1f ms late" % seen, bool(
        seen[0] * value > 0.0 and abs(value - seen[0]) < AGREES * seen[1] + (high - low))


def _rate_of_temperature(plain, cause, rest):
    if not rest or plain.temp is None:
        return "no rest with a temperature", None
    words, right = [], True
    for key, value in cause["value"].items():
        one = figures.temperature_rate(plain, cause["sensor"], "xyz".index(key[0]), rest[0])
        low, high = cause["interval_90"][key]
        words.append("%s %.3g ± %.2g beside a cubic" % (key, one.value, one.error))
        right &= one.t > 2.0 and abs(value - one.value) < AGREES * one.error + 0.25 * abs(
            one.value) + (high - low)
    return "; ".join(words), bool(right)


JUDGES = {"thermal_rate": _rate_of_temperature, "quantisation": _steps, "dead_band": _band,
          "saturation": _rails, "torn_reads": _torn,
          "sample_rate": _rate, "dropped_samples": _dropped, "vibration": _vibration,
          "thermal_bias": _slope, "warm_up": _time, "drift": _time, "g_sensitivity": _gravity,
          "filter_lag": _lag}


def _verdict(answer, rest):
    """Verdicts that cannot stand whatever the data are."""
    found = []
    sized = any(c["interval_90"] for c in answer["causes"]) or any(
        g["interval_90"] for g in answer["gap"].values())
    if answer["verdict"] == "explained" and not sized:
        found.append(Row("explained", "no size and no share with an interval", False))
    named = {n for c in answer["causes"] for n in c["class"]}
    for one in answer["unseen"]:
        if one["effect"] in named and "several poses" in one["reason"]:
            same = [c for c in answer["causes"] if one["effect"] in c["class"]
                    and c["sensor"] == one["sensor"]]
            if same:
                found.append(Row("%s %s named and unseen" % (one["effect"], one["sensor"]),
                                 one["reason"], False))
    if not rest and answer["verdict"] == "no gap":
        found.append(Row("no gap", "no rest in the recording", False))
    return found


def _said(answer, sensor, effects, axis=None):
    letter = None if axis is None else "xyz"[axis]
    causes = any(c["sensor"] in (sensor, "device") and set(c["class"]) & set(effects)
                 and (letter is None or not c["axes"] or letter in c["axes"])
                 for c in answer["causes"])
    domains = {"drift": "time", "thermal_bias": "temperature", "vibration": "frequency",
               "quantisation": "amplitude", "saturation": "amplitude",
               "dropped_samples": "timing"}
    return causes or any(w["sensor"] == sensor and w["axis"] in (None, letter)
                         and w["domain"] in {domains.get(e) for e in effects}
                         for w in answer["where"])


def _unsaid(plain, answer, rest):
    """What the plain figures show at FIVE standard errors and the answer has no word for."""
    found = []
    sensors = ("accel",) if plain.gyro is None else ("accel", "gyro")

    def need(sensor, axis, effects, figure):
        if not _said(answer, sensor, effects, axis):
            found.append(Row("NOT SAID: %s %s %s" % (
                sensor, "-" if axis is None else "xyz"[axis], "/".join(effects)), figure, False))
    for sensor in sensors:
        if plain.counts and figures.repeated(plain, sensor) > 0.3 and min(
                figures.noise(plain, sensor, rest)) > 2.0 and not answer["damage"]:
            found.append(Row("NOT SAID: %s repeats" % sensor, "%.2f of its rows" % (
                figures.repeated(plain, sensor)), False))
        for axis in range(3):
            if plain.counts and figures.steps(plain, sensor, axis) > 1:
                need(sensor, axis, ("quantisation",), "common divisor %d" % figures.steps(
                    plain, sensor, axis))
            if plain.counts and figures.railed(plain, sensor, axis) >= 3:
                need(sensor, axis, ("saturation",), "%d samples at the rail" % figures.railed(
                    plain, sensor, axis))
            if not rest:
                continue
            for hertz, size, p in figures.lines(plain, sensor, axis, rest[0]):
                need(sensor, axis, ("vibration",), "%.3f Hz, %.3g, p %.0e" % (hertz, size, p))
            _trend(plain, sensor, axis, rest[0], need)
    if rest and abs(figures.gravity(plain, rest) - 1.0) > 0.5 and not answer["damage"]:
        found.append(Row("NOT SAID: |a|", "%.3f g at rest" %
                         figures.gravity(plain, rest), False))
    found += _late(plain, answer)
    return found        # missing samples are an upper bound there: late stamps look the same


def _late(plain, answer):
    """A gyro that is behind by five standard errors, where nothing says why it is not seen."""
    number = len(figures.rests(plain, 2.0)) if plain.gyro is not None else 0
    if number < 12 or any(u["effect"] == "filter_lag" and u["sensor"] == "gyro"
                          for u in answer["unseen"]):
        return []
    seen = figures.lag_ms(plain)
    if seen is None:
        return []
    mean, error = seen
    if abs(mean) < FIVE * error or _said(answer, "gyro", ("filter_lag",)) or _said(
            answer, "accel", ("filter_lag",)):
        return []
    return [Row("NOT SAID: filter_lag", "%.1f ± %.1f ms" % (mean, error), False)]


def _trend(plain, sensor, axis, rest, need):
    if rest[1] - rest[0] < 8 * figures.BLOCKS or plain.t[rest[1] - 1] - plain.t[rest[0]] < 20.0:
        return
    y = figures.means(plain.of(sensor)[rest[0]:rest[1], axis])
    one, warm = figures.in_time(plain, sensor, axis, rest), figures.temperature(
        plain, sensor, axis, rest)
    best = max([s for s in (one, warm) if s], key=lambda s: s.t)
    if best.t > FIVE and best.share > 0.5 and np.ptp(y) > ALLOWED[sensor]:
        need(sensor, axis, ("thermal_bias", "warm_up", "drift", "thermal_scale"),
             "%s, t = %.1f, share %.2f" % (
                 "over temperature" if best is warm else "over time", best.t, best.share))
