"""The whole guided session, import of the firmware included, in a small heap, and a second one.

Simulated chip and board are not counted: what the harness holds of the heap before the first
line of firmware is imported is measured, and just as much is added.
"""

import json
from pathlib import Path

import pytest

from sixflip.capture.reader import read as read_blocks
from sixflip_host.board.stream_reader import decode_piece

from . import session_tape

ROOT = Path(__file__).resolve().parents[2]
# For every kind of session: this shows what is never let go of, and is no board's limit. That one,
# 100 KB of a 32-bit heap, is held by a Cortex-M3 in tests/on_qemu/test_whole_session.py.
HEAP = 512 * 1024
SCRIPT = "firmware_in_a_small_heap.py"


def power_up(micropython, folder, heap, *more):
    """Events of a power-up, (bytes in use, event) where it says so, and the harness's bytes."""
    done = micropython(SCRIPT, str(folder), *more, heap=str(heap))
    assert done.returncode == 0, done.stdout[-300:] + done.stderr[-1500:]
    lines = done.stdout.splitlines()
    harness = int(lines[0].split()[1])
    events = []
    for line in lines[1:]:
        at = line.index("{")
        event = json.loads(line[at:])
        event["live"] = int(line[:at].split()[1]) - harness if at else None
        events.append(event)
    return events, harness


def flash(folder, sensor):
    """The board's flash with the firmware on it, and the chips' tapes."""
    session_tape.write(folder, sensor)
    (folder / "sixflip").symlink_to(ROOT / "shared" / "sixflip")
    (folder / "sixflip_device").symlink_to(ROOT / "device" / "sixflip_device")


def bare(micropython, folder):
    """What the interpreter itself holds before a script does anything."""
    script = folder / "bare.py"
    script.write_text("import gc\ngc.collect()\nprint(gc.mem_alloc())\n")
    return int(micropython(str(script)).stdout)


def only(events, name):
    found = [e for e in events if e["event"] == name]
    assert len(found) == 1, (name, found)
    return found[0]


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85", "lsm6dsox"])
def test_a_whole_session_in_a_small_heap(micropython, tmp_path, sensor):
    flash(tmp_path, sensor)
    events, harness = power_up(micropython, tmp_path, 1 << 20, "live")
    most = {}
    for event in events:
        most[event["event"]] = max(event["live"], most.get(event["event"], 0))
    print("\n%s: harness %d; in use, without it, at %s" % (sensor, harness, ", ".join(
        ["%s %d" % (name, most[name]) for name in most])))
    (tmp_path / "record_a.bin").unlink()

    heap = HEAP + harness - bare(micropython, tmp_path)
    events, _ = power_up(micropython, tmp_path, heap)
    assert only(events, "hello")["sensor"] == sensor
    assert len([e for e in events if e["event"] == "pose"]) == 12
    assert only(events, "solved")["verdict"] == "good", only(events, "solved")["reason"]
    assert only(events, "saved")["written"]
    assert only(events, "ready")["corrected"]
    assert (tmp_path / "record_a.bin").exists() and (tmp_path / "capture.bin").exists()

    # a second session, with a record in force and its capture on the flash
    (tmp_path / "calibrate.flag").write_text("")
    events, _ = power_up(micropython, tmp_path, heap)
    assert only(events, "record")["slot"] == "a"
    assert only(events, "saved")
    assert only(events, "ready")["corrected"]


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85"])
def test_a_bus_that_hangs_before_the_last_pose_is_recovered(
        micropython, tmp_path, sensor):
    """Nothing accepted is lost, and the chip, its registers at zero, is set up anew."""
    flash(tmp_path, sensor)
    _, harness = power_up(micropython, tmp_path, 1 << 20, "hanging_bus")
    (tmp_path / "record_a.bin").unlink()
    heap = HEAP + harness - bare(micropython, tmp_path)
    events, _ = power_up(micropython, tmp_path, heap, "hanging_bus")
    actions = [e["action"] for e in events if e["event"] == "bus_error"]
    assert actions[0].startswith("freeing the bus") and actions[-1] == "recovered"
    assert len([e for e in events if e["event"] == "pose"]) == 12
    assert only(events, "saved")["written"]
    assert only(events, "ready")["corrected"]


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85"])
def test_the_firmwares_sampling_loop_allocates_nothing(micropython, tmp_path, sensor):
    flash(tmp_path, sensor)
    events, _ = power_up(micropython, tmp_path, 1 << 20, "locked_loop")
    locked = only(events, "locked")
    assert locked["of"] >= only(events, "capture")["samples"] > 9000
    assert locked["turns"] > 0.9 * locked["of"]
    assert len([e for e in events if e["event"] == "pose"]) == 12
    assert only(events, "ready")["corrected"]


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85"])
def test_a_late_redo_costs_no_session(micropython, tmp_path, sensor):
    """It is done, or said to have no room; what was captured is there either way."""
    flash(tmp_path, sensor)
    _, harness = power_up(micropython, tmp_path, 1 << 20, "redo_late")
    for name in ("record_a.bin", "capture.bin", "refused.bin"):
        (tmp_path / name).unlink(missing_ok=True)
    heap = HEAP + harness - bare(micropython, tmp_path)
    events, _ = power_up(micropython, tmp_path, heap, "redo_late")
    answers = [e for e in events if e["event"] == "redo" or e.get("what", "").startswith("no mem")]
    assert len(answers) == 1
    kept = "refused.bin" if answers[0]["event"] == "redo" else "capture.bin"
    assert (tmp_path / kept).exists()
    assert only(events, "capture")["kept"] > 9000


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85"])
def test_a_session_that_the_host_records(micropython, tmp_path, sensor):
    """Every block reaches the host, and the session is as good as without."""
    flash(tmp_path, sensor)
    (tmp_path / "calibrate.flag").write_text('{"record": true}')
    _, harness = power_up(micropython, tmp_path, 1 << 20, "recorded_wire")
    (tmp_path / "record_a.bin").unlink()
    (tmp_path / "calibrate.flag").write_text('{"record": true}')
    heap = HEAP + harness - bare(micropython, tmp_path)
    events, _ = power_up(micropython, tmp_path, heap, "recorded_wire")
    assert only(events, "calibrating")["recorded"]
    assert only(events, "saved")["written"]
    found = [decode_piece(line) for line in (tmp_path / "wire").read_bytes().splitlines()]
    assert [piece[0] for piece in found] == list(range(len(found)))
    blocks = read_blocks(b"".join(dict.fromkeys(piece for _, _, piece in found)))
    assert (blocks.complete, blocks.damage, len(blocks.placements)) == (True, "", 12)
    assert len(blocks.t_us) == only(events, "capture")["samples"] > 9000
