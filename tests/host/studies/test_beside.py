"""The table that holds the baselines against the product, on made-up answers."""

from tests.studies.blind.baselines import BASELINES, beside

RIGHT = {"sensor": "accel", "axes": ["z"], "effect": "cubic", "class": ["cubic"], "unit": "",
         "score_nats": 9.0, "interval_90": {}, "value": {"z": 5.0}}
WRONG = dict(RIGHT, effect="creep", **{"class": ["creep"]})
GAP = {"accel": {"before": 2.0, "after": 1.0}}


def label(suite, effects):
    theory = {"visible": 0.5, "distance": 20.0, "aliases": {}, "attainable": 1.0}
    return {"suite": suite, "seed": 1, "chip": "mpu6050", "protocol": "recommended", "habits": {},
            "options": [], "noise_of": "", "new_gyro_offset": False, "judged":
            {"protocol": {"accel": {}}, "effects": [theory] * len(effects)},
            "effects": [{"effect": name, "sensor": "accel", "axes": ["z"], "multiple": 1.0,
                         "parameters": {}, "also": []} for name in effects]}


def outcome(name, product, others):
    def answer(causes):
        return {"verdict": "explained" if causes else "no gap", "causes": causes, "where": [],
                "gap": GAP}
    return {"id": name, "code": 0, "error": "", "seconds": 1.0, "cpu_s": 1.0,
            "answer": answer(product), "baselines": {b: answer(others) for b in BASELINES}}


def test_alarms_classes_names_and_false_names_are_counted():
    labels = {"a": label("null", []), "b": label("single", ["cubic"]),
              "c": label("stranger", ["?what"])}
    outcomes = [outcome("a", [], [WRONG]), outcome("b", [RIGHT], [RIGHT, WRONG]),
                outcome("c", [], [WRONG])]
    lines = beside.report(labels, outcomes).splitlines()
    assert len(lines) == 3 + len(BASELINES)
    # false alarms, right class, right name, false names, unknown explained, closed, on nulls
    assert lines[2].split()[2:] == ["0", "of", "1", "100", "of", "1", "100", "of", "1", "0.00",
                                    "0", "of", "1", "75", "75", "3"]
    assert lines[3].split()[1:] == ["100", "of", "1", "100", "of", "1", "100", "of", "1", "1.00",
                                    "100", "of", "1", "75", "75", "3"]
