"""A record's terms come in force: before the rest at power-up, in a small heap before the stream.

There one thing is loaded after the other.
"""

from ..power_up import free
from .activate import small


def _refused(unit, reason, expected):
    unit.events.error("the record's terms are not in force: " + reason, expected)


def _teller(unit):
    def tell(temp_c, low_c, high_c):
        unit.events.emit("term_range", temp_c=temp_c, low_c=low_c, high_c=high_c,
                         note="outside of what the terms were measured at; the edge holds")
    return tell


def _taken_apart(record):
    from sixflip.record.term_correction import numbers
    return numbers(record)


def _begun(unit):
    from sixflip.record.term_correction import TermCorrection
    return TermCorrection(unit.record, _teller(unit))


def _fill(correction, found):
    from sixflip.record.term_correction import fill
    fill(correction, found)


def bring(unit):
    """unit.correction is that of unit.record: from now on with its terms, the rest it had kept.
    Terms that cannot be are told and left out."""
    try:
        found = _taken_apart(unit.record)
    except ValueError as e:
        _refused(unit, str(e), "sections as sixflip.record.term_correction has them")
        return
    means = unit.correction.rest
    unit.correction = None
    if small():
        free(("sixflip.record.term_correction",))
    correction = _begun(unit)
    if small():
        free(("sixflip.record.term_correction", "sixflip.record.correction"))
    _fill(correction, found)
    if means is not None:
        correction.set_rest(means)
    unit.correction = correction


def beside_stream(unit):
    """Likewise, after another record or mounting was taken."""
    if not small():
        bring(unit)
    else:
        _refused(unit, "the heap has no room for their code beside the stream", "a power-up")


def run(unit):
    bring(unit)
    return "stream"
