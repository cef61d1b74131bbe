"""The correction of a record: with its terms where it has some."""

from sixflip.correction import Correction


def correction_of(record, tell=None):
    """Correction or TermCorrection, see there for tell; ValueError, a sentence, for terms that
    cannot be."""
    if not record.terms:
        return Correction(record)
    from sixflip.term_correction import TermCorrection
    from sixflip.term_numbers import numbers
    from sixflip.term_units import fill
    correction = TermCorrection(record, tell)
    fill(correction, numbers(record))
    return correction
