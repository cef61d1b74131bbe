"""A recording's clock in words and for --json: the rate first, then losses, pauses, late rows,
changes of the rate and jitter, each with its number."""
import math


def as_json(measured):
    """The SampleClock for --json."""
    return {"rows": measured.rows, "expected": measured.expected, "rate_hz": measured.rate_hz,
            "interval_95_hz": list(measured.interval_hz),
            "losses": {"samples": measured.losses, "places": measured.loss_gaps,
                       "longest_ms": measured.longest_loss_ms,
                       "by_the_link": measured.losses_known},
            "pauses": {"number": measured.pauses, "seconds": measured.pause_s,
                       "longest_s": measured.longest_pause_s},
            "late": {"rows": measured.late, "bursts": measured.bursts,
                     "longest_ms": measured.longest_late_ms},
            "paces": [{"from_row": row + 1, "rate_hz": rate} for row, rate in measured.paces],
            "jitter_ms": measured.jitter_ms, "resolution_ms": measured.resolution_ms}


def words(measured):
    """Sentences: the rate first, then what there is of the other four."""
    lines = ["%.6g Hz (%.6g to %.6g) by count over time: %d rows and %d lost are the %d expected"
             % (measured.rate_hz, *measured.interval_hz, measured.rows, measured.losses,
                measured.expected)]
    return lines + [line for line in (loss_words(measured), pause_words(measured),
                                      burst_words(measured), pace_words(measured),
                                     jitter_words(measured)) if line]


def loss_words(measured):
    """A sentence on losses, or ""."""
    if not measured.losses:
        return ""
    return "losses: %s missing in %s under a clock that went on, %.4g ms at most" % (
        _number(measured.losses, "sample"), _number(measured.loss_gaps, "place"),
        measured.longest_loss_ms)


def pause_words(measured):
    """A sentence on pauses, or ""."""
    if not measured.pauses:
        return ""
    return ("pauses: the recorder stood still %s, %.3g s together, %.3g s at most; nothing is "
            "taken as lost there" % (_number(measured.pauses, "time"), measured.pause_s,
                                     measured.longest_pause_s))


def burst_words(measured):
    """A sentence on rows that came late, or ""."""
    if not measured.late:
        return ""
    return "bursts: %s came late and %s caught up, in %s, %.3g ms at most; none is lost" % (
        _number(measured.late, "row"), "was" if measured.late == 1 else "were",
        _number(measured.bursts, "burst"), measured.longest_late_ms)


def pace_words(measured):
    """A sentence on a rate that changed on the way, or ""."""
    if not measured.paces:
        return ""
    return "the rate changed on the way: %s" % ", ".join(
        "%.4g Hz from row %d on" % (rate, row + 1) for row, rate in measured.paces)


def jitter_words(measured):
    """A sentence on jitter of more than a hundredth of a period and of more than stamps scatter
    by that are whole multiples of their resolution, or ""."""
    rounding_ms = measured.resolution_ms / math.sqrt(12.0)
    if measured.jitter_ms * measured.rate_hz <= 10 or measured.jitter_ms <= rounding_ms:
        return ""
    return "jitter: the stamps scatter by %.3g ms" % measured.jitter_ms


def _number(number, what):
    return "%d %s%s" % (number, what, "" if number == 1 else "s")
