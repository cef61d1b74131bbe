"""A power-up with a whole session on the emulated board, the firmware compiled as provision sends
it: in less than the port's heap, nothing allocated while sampling, and the outcome of double
precision."""

import io
import json
import os

import numpy as np
import pytest

from sixflip.chips import catalogue
from sixflip.record import correction_record
from sixflip_device import power_up, settings
from sixflip_host import record_terms
from sixflip_sim.tape import open_tape
from sixflip_sim.worlds import SEEN
from tests.on_micropython.test_term_memory import ALL, with_terms
from tests.on_qemu.on_board.taped_board import TapedBoard

from .firmware import ALL_CHIPS, POSE_SAMPLES, tape_bursts
from .simulated_sums import vector_error_mg

HEAP = 140032  # what the port leaves of its 140 KB
SMALL_HEAP = 100 * 1024  # the limit for a whole session, what the test itself holds not counted
SMALL = {"heap": SMALL_HEAP, "pose_samples": POSE_SAMPLES}


def session(board, sensor, record=None, **how):
    """(events, their bytes in use, newest record, {word: value} of the rest that it printed);
    record: bytes of one that is active already."""
    pieces = ["import whole_session"]
    if record is not None:
        pieces.append("whole_session.give(bytes.fromhex(%r))" % record.hex())
    pieces.append("whole_session.run(%r, **%r)" % (sensor, how))
    events, used, said = [], [], {}
    for line in board.exec(*pieces).splitlines():
        if "{" in line:
            used.append(int(line[: line.index("{")] or 0))
            events.append(json.loads(line[line.index("{") :]))
        else:
            words = line.split()
            said.update(zip(words[::2], words[1::2]))
    record = said.pop("record", None)
    return events, used, record and correction_record.decode(bytes.fromhex(record)), said


def in_double_precision(sensor, folder, monkeypatch):
    """(events, record) of the same tape on CPython."""
    monkeypatch.setattr(os, "urandom", lambda n: bytes(range(1, n + 1)))
    events = []
    i2c = open_tape(sensor, [io.BytesIO(data) for data in tape_bursts()[sensor]])
    values, problems = settings.merge({"grace_ms": 0, "pose_samples": POSE_SAMPLES})
    power_up.run(TapedBoard(i2c, str(folder) + "/", lambda text: events.append(json.loads(text))),
                 values, problems)
    return events, correction_record.decode((folder / "record_a.bin").read_bytes())


def named(events, name):
    return [event for event in events if event["event"] == name]


def far(a, b):
    return float(np.max(np.abs(np.asarray(a) - np.asarray(b))))


def differing(one, other):
    """Names of the fields in which two records differ."""
    found = []
    for name, value in vars(one).items():
        beside = vars(other)[name]
        if isinstance(value, dict) and isinstance(beside, dict):
            found += ["%s.%s" % (name, key) for key in value if value[key] != beside[key]]
        elif value != beside:
            found.append(name)
    return found


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85"] + ["lsm6dsox"] * ALL_CHIPS)
def test_a_whole_session_with_the_heap_locked_while_sampling(powered_up, sensor, tmp_path,
                                                             monkeypatch):
    events, used, record, said = session(powered_up, sensor, mode="locked_loop", **SMALL)
    harness = int(said["harness"])
    assert int(said["heap"]) <= SMALL_HEAP
    assert named(events, "hello")[0]["float_bits"] == 32
    assert len(named(events, "pose")) == 12
    assert named(events, "solved")[0]["verdict"] == "good"
    assert named(events, "saved")[0]["written"]
    assert named(events, "ready")[0]["corrected"]
    locked = named(events, "locked")[0]
    assert locked["of"] >= named(events, "capture")[0]["samples"] > 5000
    assert locked["turns"] > 0.9 * locked["of"]

    there, double = in_double_precision(sensor, tmp_path, monkeypatch)
    # every decision is the same: which samples became which pose, and the verdict
    for here, other in zip(named(events, "pose"), named(there, "pose")):
        assert here["pose"] == other["pose"]
        assert far(here["mean"], other["mean"]) < 0.03  # counts; another sample would show
    for name, key in (("capture", "samples"), ("capture", "kept"), ("solved", "verdict"),
                      ("solved", "level")):
        assert named(events, name)[0][key] == named(there, name)[0][key]
    P, Q = [np.array(r.accel["P"])[:, :3] for r in (record, double)]
    vector_mg = vector_error_mg(P, Q)
    gyro = far(record.gyro["P"], double.gyro["P"])
    apart = differing(record, double)
    assert "float_bits" in apart
    assert not {"chip", "who_am_i", "session", "accel.level", "accel.verdict", "gyro.verdict",
                "gyro.missing"} & set(apart)
    print("\n%s: the records differ in %s, so their CRCs do" % (sensor, ", ".join(apart)))
    print("%s: at most %d bytes in use of %d, the harness's %d not counted; %d of %d turns of the "
          "sampling loop with the heap locked; against double precision on the same samples "
          "%.5f mg, gyro matrix %.1e" % (sensor, max(used), SMALL_HEAP, harness, locked["turns"],
                                         locked["of"], vector_mg, gyro))
    assert vector_mg < 0.01
    assert gyro < 1e-5


@pytest.mark.long
@pytest.mark.parametrize("sensor", ["gy85"])  # two chips take the more
def test_a_late_redo_costs_no_session(powered_up, sensor):
    """The tape has no more of the face that is taken again: the session ends without it."""
    events, used, _, said = session(powered_up, sensor, mode="redo_late", timeout_s=30, **SMALL)
    assert int(said["heap"]) <= SMALL_HEAP
    assert [event["face"] for event in named(events, "redo")] == ["X-"]
    assert named(events, "capture")[0]["kept"] > 5000
    assert "still missing: X-a X-b" in named(events, "solved")[0]["reason"]
    assert named(events, "ready")
    print("\n%s: at most %d bytes in use of %d with a late redo" % (sensor, max(used), SMALL_HEAP))


@pytest.mark.parametrize("sensor", ["gy85"])  # two chips take the more
def test_every_term_in_force_and_kept_through_a_session(powered_up, sensor, tmp_path, monkeypatch):
    _, record = in_double_precision(sensor, tmp_path, monkeypatch)
    record.accel["P"][3][0] += 0.02  # so that the session has something new to say
    events, used, record, said = session(
        powered_up, sensor, record=bytes(correction_record.encode(with_terms(record))), **SMALL)
    assert int(said["heap"]) <= SMALL_HEAP
    assert named(events, "record")[0]["terms"] == [16, 17, 18, 19, 20]
    assert len(named(events, "pose")) == 12
    assert named(events, "solved")[0]["verdict"] == "good", named(events, "solved")[0]["reason"]
    assert named(events, "ready")[0]["corrected"]
    assert (named(events, "saved")[0]["slot"], record.sequence) == ("b", 2)
    assert record_terms.names_of(record) == ALL
    print("\n%s: at most %d bytes in use of %d with five terms" % (sensor, max(used), SMALL_HEAP))


LIVE = {"tilt_deg": 2.0, "first_rest_s": 8.0, "dwell_s": 4.5, "move_s": 2.0, "seed": 3}


# one of them in `make test`, every chip in `make test-qemu`
@pytest.mark.parametrize("sensor", [name for name in catalogue.SENSORS if name not in SEEN]
                         + ["mpu6050"] if ALL_CHIPS else ["lsm6dsox"])
def test_a_whole_session_with_the_simulated_chip_inside(board, sensor):
    events, used, record, said = session(board, sensor, world=LIVE, pose_samples=50, rate_hz=25)
    assert len(named(events, "pose")) == 12
    solved = named(events, "solved")[0]
    assert solved["verdict"] in ("good", "doubtful"), solved["reason"]
    assert solved["tilt_deg"] == pytest.approx(2.0, abs=0.1)
    assert record.accel["level"] == "tilt solved"
    print("\nsimulated %s inside: at most %d bytes in use of %d" % (sensor, max(used), HEAP))
