"""What was found as terms of a correction record, for the board to take out.

Only a single, plausible name goes into a record (never a member of an unresolved class), only an
effect that the board has a term for, and only with a gain on what was held out, shown by the
board's own correction (term_gain.py). The coefficients are refitted without what the board cannot
do: no lag of the thermometer, no bend of a scale or of a g-sensitivity.
"""
import copy
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sixflip.record.record import following

from .. import record_terms
from ..calibrate import term_words
from ..errors import CheckFailed
from . import gap_figures, hypotheses, term_gain

TERMS = {("accel", "thermal_bias"): "accel_thermal_bias",
         ("gyro", "thermal_bias"): "gyro_thermal_bias",
         ("accel", "thermal_scale"): "accel_thermal_scale",
         ("gyro", "thermal_scale"): "gyro_thermal_scale",
         ("gyro", "g_sensitivity"): "g_sensitivity"}
CLOSED = 0.5  # share of what a term says is there that must be there where it was held out
OTHER_PART_G = 0.02  # |a| at rest beyond this: it is not this sensor's record


@dataclass(frozen=True, eq=False)
class Term:
    """name of the section; cause; gap (SensorGap); fields of record_terms.py, gain included,
    where it was shown."""

    gap: object
    cause: object
    name: str
    fields: dict | None = None


@dataclass(frozen=True, eq=False)
class Terms:
    """accepted: tuple of Term; left_out: [(sensor, names, reason)]; record: with the accepted."""

    accepted: tuple
    left_out: list
    record: object


def terms_for(diagnosis, record):
    """Terms of a Diagnosis for a record."""
    candidates, left_out = _candidates(diagnosis, record)
    accepted = []
    for gap in {id(t.gap): t.gap for t in candidates}.values():
        shown, others = _shown(gap, [t for t in candidates if t.gap is gap], record, diagnosis)
        accepted += shown
        left_out += others
    written = copy.deepcopy(record)
    for term in accepted:
        record_terms.put(written, term.name, term.fields)
    if accepted:
        written.sequence = following(written.sequence)
    return Terms(tuple(accepted), left_out, written)


def _candidates(diagnosis, record):
    """([Term] of the causes that can become one, [(sensor, names, reason)] of the others)."""
    candidates = []
    left_out = [(f.sensor, [f.effect], "no term of a record") for f in diagnosis.findings]
    for gap in diagnosis.judged:
        if gap.drift:
            left_out.append((gap.kind, ["drift"], "no term of a record"))
        for cause in gap.causes:
            reason = _reason(gap, cause, record)
            if reason:
                left_out.append((gap.kind, cause.names, reason))
            else:
                candidates.append(Term(gap, cause, TERMS[gap.kind, cause.effect]))
    return candidates, left_out


def _reason(gap, cause, record):
    """"" or why a cause cannot become a term."""
    if not any((gap.kind, name) in TERMS for name in cause.names):
        return "no term of a record"
    if len(cause.names) > 1:
        return "cannot be told apart"
    if not cause.letters:
        return "its axes cannot be told"
    if not cause.plausible:
        return "physically implausible"
    if cause.effect != "g_sensitivity" and record.temp_c is None:
        return "the record does not say at which temperature it was measured"
    return ""


def _shown(gap, terms, record, diagnosis):
    """([Term] of one gap that show a gain, [(sensor, names, reason)] of the others)."""
    gains = term_gain.gains(gap, record, diagnosis.settings.certified)
    if not gains.parts:
        return [], [(gap.kind, t.cause.names, "nothing to hold out: one session, too short to be "
                     "halved") for t in terms]
    kept, left_out = list(terms), []
    while kept:
        fit = fitted(gap, kept, gains.data, diagnosis)
        gain, share = _gained(gains, fit, kept)
        weakest = min(kept, key=share.get)
        if share[weakest] >= CLOSED:
            return [replace(term, fields=dict(fit.fields(term), **gain[term]))
                    for term in kept], left_out
        kept.remove(weakest)
        left_out.append((gap.kind, weakest.cause.names, "no gain on what was held out "
                         "(%(before).3g before, %(after).3g after)" % gain[weakest]))
    return [], left_out


def _gained(gains, fit, terms):
    """({Term: before, after and floor}, {Term: share of what it says is there that is there where
    it was held out})."""
    held = range(len(gains.parts))
    after, gain, share = gains.left([fit.sections(terms, h) for h in held]), {}, {}
    for term in terms:
        rest = [t for t in terms if t is not term]
        before = gains.left([fit.sections(rest, h) for h in held])
        said = before - after
        gain[term] = {"before": rms(before), "after": rms(after), "floor": gains.floor}
        share[term] = (before @ before - after @ after) / max(said @ said, 1e-12)
    return gain, share


def rms(values):
    return float(np.sqrt(np.mean(values ** 2)))


@dataclass(frozen=True, eq=False)
class Fit:
    """Coefficients of the terms of one gap as the board can apply them: columns (k,) with theta
    and sigma (k,) of all sessions, held: a theta for each one that is held out, of the others;
    candidates {Term: its Forms}."""

    gap: object
    diagnosis: object
    candidates: dict
    columns: np.ndarray
    theta: np.ndarray
    sigma: np.ndarray
    held: list

    def sections(self, terms, held):
        """{name: fields} as the other sessions have them."""
        return {term.name: self.fields(term, self.held[held]) for term in terms}

    def fields(self, term, theta=None):
        """Fields of record_terms.py but the gain."""
        theta = self.theta if theta is None else theta
        sizes, sigmas = {}, {}
        for candidate in self.candidates[term]:
            for key, power, axis, column in zip(candidate.keys, candidate.powers, candidate.axes,
                                                candidate.columns):
                if "xyz"[axis] in term.cause.letters:
                    place = int(np.flatnonzero(self.columns == column)[0])
                    sizes[key, power] = float(theta[place])
                    sigmas[key, power] = float(self.sigma[place])
        sessions = self.gap.sessions
        fields = {"axes": ["xyz".index(letter) for letter in term.cause.letters],
                  "origin": record_terms.ORIGINS[self.gap.same_session],
                  "source": " ".join(Path(s.name).name for s in sessions),
                  "before": None, "after": None, "floor": None}
        if term.name == "g_sensitivity":
            for name, values in (("k", sizes), ("sigma", sigmas)):
                fields[name] = [[values.get((a + b, 1), 0.0) for b in "xyz"] for a in "xyz"]
            return fields
        meta = sessions[0].capture.meta
        celsius = np.concatenate([s.temperature for s in sessions])
        fields.update(t0_c=self.diagnosis.conditions.reference_c, low_c=float(celsius.min()),
                      high_c=float(celsius.max()), temp_lsb_per_c=float(meta["temp_lsb_per_c"]),
                      temp_offset_c=float(meta["temp_offset_c"]))
        for name, power in (("k1", 1), ("k2", 2)):
            fields[name] = [sizes.get((a, power), 0.0) for a in "xyz"]
            fields["sigma_" + name] = [sigmas.get((a, power), 0.0) for a in "xyz"]
        return fields


def fitted(gap, terms, data, diagnosis):
    """Fit of the Terms of a gap, those held out being the units of a gap_figures.Data."""
    candidates = {term: plain(gap, term.cause) for term in terms}
    named = {id(c) for term in terms for c in term.cause.chosen}
    chosen = [c for term in terms for c in candidates[term]]
    for candidate in gap.chosen:
        taken = hypotheses.columns_of(chosen).index
        if id(candidate) not in named and not np.isin(candidate.columns, taken).any():
            chosen.append(candidate)
    shared = hypotheses.columns_of(chosen)
    theta, covariance = gap_figures.coefficients(
        gap_figures.fits(gap.data, shared), shared)
    fits = gap_figures.fits(data, shared)
    between, held = [bool(u.between) for u in data.units], []
    for place in range(between.count(False)):
        # What lies between the sessions knows of the one held out.
        others = [f for k, f in enumerate(fits) if k != place and not between[k]]
        held.append(gap_figures.coefficients(others, shared)[0][0])
    return Fit(gap, diagnosis, candidates, shared.index, theta[0],
               np.sqrt(np.diag(covariance[0])), held)


def plain(gap, cause):
    """The candidates of a cause in the form that the board can take out."""
    forms = []
    for c in (c for c in cause.chosen if c.effect == cause.effect):
        bent = c.discrepancy and cause.effect == "thermal_bias"
        forms += [o for o in gap.options
                  if (o.effect, o.axis, o.variant, o.record) == (c.effect, c.axis, "", bent)
                  and not any(np.isin(o.columns, form.columns).any() for form in forms)]
    return forms


def fitting(sessions, record, path):
    """CheckFailed unless the record is of the sensor that was captured."""
    for session in sessions:
        if not session.n:
            continue
        off = rms(np.linalg.norm(term_gain.corrected(session, record).accel, axis=1) * 1e-3 - 1.0)
        if not off <= OTHER_PART_G:
            raise CheckFailed("%s: at rest |a| of %s comes out %.0f mg off, expected at most "
                              "%.0f: it is the record of another part" % (
                                  path, session.name, off * 1e3, OTHER_PART_G * 1e3))


def answer(terms, output):
    """dict of Terms for the JSON answer; output: the file they are written to."""
    return {"written": output if terms.accepted else None,
            "found": [dict(term_words.facts(t.name, t.fields), term=t.name)
                      for t in terms.accepted],
            "left_out": [{"sensor": sensor, "effects": names, "reason": reason}
                         for sensor, names, reason in terms.left_out]}
