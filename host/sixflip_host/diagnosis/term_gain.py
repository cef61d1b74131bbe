"""How much a record's terms take away on what was held out: the raw counts go through the code
that the board runs (sixflip.record.correction), what comes out is judged as any capture is."""
import copy
from dataclasses import dataclass, replace

import numpy as np

from sixflip.record.correction import correction_of

from .. import record_terms
from ..experiment import attitude_fit, nominal_rows
from ..export.corrected_rows import corrected_rows
from . import gap_figures, holdout_gain, turn_model


def corrected(session, record):
    """The Session as it reads after a record's correction, in the sensor's axes; counts as if
    they were whole numbers no longer."""
    record = copy.copy(record)
    record.mounting = None
    capture = copy.copy(session.capture)
    meta = capture.meta
    rows = corrected_rows(correction_of(record), capture)
    capture.accel = rows[:, :3] / record.g * meta["accel_lsb_per_g"]
    if session.gyro is not None:
        capture.gyro = np.degrees(rows[:, 3:]) * meta["gyro_lsb_per_dps"]
    return session.reading(capture)


@dataclass(frozen=True, eq=False)
class Gains:
    """What is left of the parts held out: gap, record; parts [(whole Session, its placements or
    None for all)], none where there is nothing to hold out; data (gap_figures.Data) with one
    unit for each; floor: RMS a contrast of noise alone, mg or deg/s."""

    gap: object
    record: object
    certified: bool
    parts: list
    data: object
    floor: float

    @property
    def units(self):
        """The units of the parts, without what lies between the sessions."""
        return [u for u in self.data.units if not getattr(u, "between", False)]

    def left(self, sections):
        """All contrasts (m,) with the terms {name: fields} of each part in the record."""
        contrasts = []
        for (session, placements), unit, terms in zip(self.parts, self.units, sections):
            record = copy.deepcopy(self.record)
            for name, fields in terms.items():
                record_terms.put(record, name, fields)
            contrasts.append(self._contrasts(corrected(session, record), placements, unit))
        return np.concatenate(contrasts)

    def _contrasts(self, session, placements, unit):
        model = attitude_fit.fit(session)
        part = session if placements is None else session.part(placements)
        if _turning(self.gap):
            return self.gap.unit(part, model, self.certified).z
        y = nominal_rows.accel_rows(part, model) if self.gap.kind == "accel" \
            else part.gyro.reshape(-1)
        return unit.contrasts(y)


def gains(gap, record, certified):
    """Gains of a SensorGap: whole sessions, each held out in turn, or the halves of the only one;
    of turns there are no halves, since they lie between the placements."""
    parts, data, index = [(s, None) for s, _ in gap.parts], gap.data, gap.adequacy.index
    if gap.same_session:
        session, model = gap.parts[0]
        halves = [] if _turning(gap) else holdout_gain.halves(gap.kind, session, model, certified)
        if not halves:
            return Gains(gap, record, certified, [], data, 0.0)
        parts = [(session, set(p.placement.tolist())) for p, _ in halves]
        data = gap_figures.data_of([gap.unit(p, m, certified) for p, m in halves])
        index = gap.halved_levels(data)
    held = Gains(gap, record, certified, parts, data, 0.0)
    energy = sum(u.noise_energy(*u.grid[k]) for u, k in zip(held.units, index))
    return replace(held, floor=float(np.sqrt(energy / sum(u.freedom for u in held.units))))


def _turning(gap):
    return isinstance(gap.model, turn_model.TurnModel)
