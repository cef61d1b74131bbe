"""The diagnosis of one board from its summaries: the model of the rests, the same as `sixflip
diagnose` has, with the samples' verdicts as the summaries keep them.

Turns and motion need the samples of the moves, so they are not looked at, and the verdict is that
of the rests.
"""
from ..capture.registers import SENSORS
from ..diagnosis import answer, diagnosis, localisation, rests_judged, samples_judged
from ..diagnosis.detect.detection import Finding
from ..diagnosis.rest_model import RestModel
from ..diagnosis.settings import Conditions, Settings


def diagnose_board(kept, sessions, settings=None):
    """(dict, UsableRests, gaps) of the [Summary] of one board and their sessions: verdict; causes
    as in the answer of diagnose; gap {sensor: before, after and floor}; beside it what it was
    found in, {sensor: SensorGap}."""
    settings = settings or Settings(jobs=1)
    findings, nameless = [], []
    for summary in kept:
        samples = summary.about["samples"]
        findings += [_finding(f) for f in samples["findings"]]
        nameless += [localisation.Place(p["sensor"], p["axis"], p["domain"], 1.0, p["p"])
                     for p in samples["nameless"]]
    scaled = any(one.about["samples"]["scaled"] for one in kept)
    # Rests on a rail were left out when the summaries were made.
    sound = [f for f in findings if f.effect != "saturation"]
    rests = rests_judged.usable_rests(sessions, sound, [], scaled)
    conditions = Conditions(rests.reference_c, any(
        f.sensor == "accel" and f.effect in samples_judged.COARSE for f in findings), {
        f.sensor: ["xyz".index(a) for a in f.axes] for f in findings if f.effect == "vibration"})
    gaps = {}
    if rests.nominal:
        for sensor in ("accel", "gyro"):
            if all(getattr(s, sensor) is not None for s in rests.sessions):
                model = RestModel(sensor, kept[0].meta["sensor"], settings, conditions)
                gaps[sensor] = model.fit(rests.sessions, rests.nominal)
    told = diagnosis.Diagnosis(
        rests.everything, settings, conditions, (None,) * len(kept), tuple(findings), gaps, {},
        None, None, tuple(nameless), False, list(rests.remarks), (), (), {})
    return {"verdict": told.verdict if gaps else "cannot tell", "causes": answer.causes(told),
            "gap": {kind: answer._gap(kind, gap) for kind, gap in gaps.items()}}, rests, gaps


def _finding(f):
    return Finding(f["effect"], f["sensor"], list(f["axes"]), dict(f["value"]), f["unit"],
                   f["score_nats"], f["domain"], f["words"], plausible=f["plausible"],
                   share=f["share"], number=f["number"], place=dict(f["place"]))


def words(gap):
    """The sentence on a board's diagnosis."""
    said = []
    for cause in gap["causes"]:
        names = cause["effect"] or " or ".join(cause["class"])
        sensor = SENSORS.get(cause["sensor"], cause["sensor"])
        said.append("%s of the %s%s" % (names, sensor, " " + "".join(cause["axes"])
                                        if cause["axes"] else ""))
    return gap["verdict"] + (": " + ", ".join(dict.fromkeys(said)) if said else "")
