"""How much a record's terms take away on what was held out: the raw counts go through the code
that the board runs (sixflip.record.correction), what comes out is judged as any capture is."""
import copy

import numpy as np

from sixflip.record.correction import correction_of

from .. import record_terms
from ..experiment import attitude_fit, nominal_rows
from ..export.corrected_rows import corrected_rows
from . import coefficient_fits, rest_model, turn_model


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


class Gains:
    """parts [(whole Session, its placements or None for all)]; data (which.Data) with one unit
    for each; floor: RMS a contrast of noise alone, mg or deg/s. No parts: nothing to hold out."""

    def __init__(self, gap, record, certified):
        self.gap, self.record, self.certified = gap, record, certified
        self.turning = isinstance(gap.model, turn_model.TurnModel)
        self.parts = [(s, None) for s, _ in gap.parts]
        self.data, index = gap.data, gap.adequacy.index
        if gap.same_session:
            session, model = gap.parts[0]
            # of turns there are no halves: they lie between the placements
            halves = [] if self.turning else rest_model.halves(gap.kind, session, model, certified)
            self.parts = [(session, set(p.placement.tolist())) for p, _ in halves]
            if not halves:
                return
            self.data = coefficient_fits.Data([gap.unit(p, m, certified) for p, m in halves])
            index = gap.halved_levels(self.data)
        self.units = [u for u in self.data.units if not getattr(u, "between", False)]
        self.floor = float(np.sqrt(sum(u.noise_energy(*u.grid[k])
                                       for u, k in zip(self.units, index))
                                   / sum(u.freedom for u in self.units)))

    def left(self, sections):
        """All contrasts (m,) with the terms {name: fields} of each part in the record."""
        out = []
        for (session, placements), unit, terms in zip(self.parts, self.units, sections):
            record = copy.deepcopy(self.record)
            for name, fields in terms.items():
                record_terms.put(record, name, fields)
            out.append(self._contrasts(corrected(session, record), placements, unit))
        return np.concatenate(out)

    def _contrasts(self, session, placements, unit):
        model = attitude_fit.fit(session)
        part = session if placements is None else session.part(placements)
        if self.turning:
            return self.gap.unit(part, model, self.certified).z
        y = nominal_rows.accel_rows(part, model) if self.gap.kind == "accel" \
            else part.gyro.reshape(-1)
        return unit.contrasts(y)
