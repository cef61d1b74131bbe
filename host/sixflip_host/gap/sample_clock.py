"""The times of the samples: the true rate, samples that are missing, pauses of the recorder."""
import math

import numpy as np

from ..capture.capture_binary import lost_on_the_way, write_pauses
from .finding import CERTAIN, Finding

RATE_OFF, JITTER_SHARE, MISSING, SPAN = 1e-3, 1.5, 0.7, 20
FEWEST_DROPS = 2


def rate(sessions):
    """The clock against the header's rate_hz: span by span, and over the whole capture."""
    errors, widths = [], []
    for session in sessions:
        t = without_pauses(session.capture)
        if len(t) < 10 * SPAN:
            return []
        usual, scatter = period(t)
        total = float(t[-1] - t[0]) / (len(t) - 1)
        if usual <= 0 or total <= 0:
            return []
        nominal = 1e6 / session.rate
        error = min((nominal / usual - 1.0, nominal / total - 1.0), key=abs)
        if (usual > nominal) != (total > nominal):
            error = 0.0
        errors.append(error)
        widths.append((scatter + 1.0) / usual / math.sqrt(len(t) / SPAN))
    worst = min(abs(e) / (RATE_OFF + 5.0 * s) for e, s in zip(errors, widths))
    if worst < 1.0 or len({e > 0 for e in errors}) > 1:
        return []
    percent = 100.0 * float(np.mean(errors))
    half = 100.0 * max(float(np.ptp(errors)) / 2, 2.0 * max(widths), 1e-4)
    return [Finding("sample_rate", "device", [], {"rate": round(percent, 4)}, "%", CERTAIN,
                    "timing", "the samples come at %.2f Hz, not %g" % (
                        sessions[0].rate * (1 + percent / 100.0), sessions[0].rate),
                    {"rate": (percent - half, percent + half)})]


def drops(sessions):
    """Gaps that hide samples: wide, and not made up for by the samples around them."""
    lost = rows = 0
    longest = 0.0
    for session in sessions:
        t = without_pauses(session.capture).astype(float)
        if len(t) < 10 * SPAN:
            continue
        usual, _ = period(t)
        if usual <= 0:
            return []
        gaps = np.diff(t)
        wide = np.flatnonzero(gaps > JITTER_SHARE * usual)
        before = np.maximum(wide - SPAN // 2, 0)
        after = np.minimum(wide + 1 + SPAN // 2, len(t) - 1)
        late = (t[after] - t[before]) / usual - (after - before)
        real = np.minimum(late, gaps[wide] / usual - 1.0) > MISSING
        lost += int(np.rint(gaps[wide][real] / usual - 1.0).sum())
        rows += len(t)
        longest = max(longest, float(gaps[wide][real].max()) / 1e3 if real.any() else 0.0)
    if lost < FEWEST_DROPS:
        return []
    chance = 100.0 * lost / (rows + lost)
    half = 100.0 * 1.645 * math.sqrt(lost) / (rows + lost)
    return [Finding("dropped_samples", "device", [], {"chance": round(chance, 4)}, "%", CERTAIN,
                    "timing", "%d samples are missing, the longest gap lasts %.0f ms"
                    % (lost, longest), {"chance": (max(0.0, chance - half), chance + half)})]


def without_pauses(capture):
    """t_us (n,) as if every pause of the recorder, and every gap that the link tore into what
    it recorded, had lasted a usual interval."""
    found = np.union1d(write_pauses(capture), lost_on_the_way(capture)[1])
    if not len(found):
        return capture.t_us
    gaps = np.diff(capture.t_us)
    gaps[found] = np.median(gaps)
    return capture.t_us[0] + np.concatenate([[0], np.cumsum(gaps)])


def remarks(sessions):
    """A sentence for every capture whose recorder paused."""
    said = []
    for session in sessions:
        found = write_pauses(session.capture)
        if len(found):
            said.append("%s: the board wrote to its flash %d times, the longest took %.0f ms "
                        "without a sample; that is the recorder's doing, not the sensor's" % (
                            session.name, len(found),
                            np.diff(session.capture.t_us)[found].max() / 1e3))
        lost, places = lost_on_the_way(session.capture)
        if lost:
            said.append("%s: %d samples were lost on the way from the board, in %d place%s; that "
                        "is the link's doing, not the sensor's" % (
                            session.name, lost, len(places), "s" if len(places) > 1 else ""))
    return said


def period(t_us):
    """(usual time between two samples in us, its scatter over spans): the median over spans
    of SPAN samples, so that rounded or jittering timestamps do not matter."""
    spans = (t_us[SPAN:] - t_us[:-SPAN]) / float(SPAN)
    return float(np.median(spans)), float(1.4826 * np.median(np.abs(spans - np.median(spans))))
