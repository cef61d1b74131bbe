"""A session goes on after a power cycle, on a board whose flash keeps it waiting."""

import json

import pytest

from sixflip_host import cli
from sixflip_host.board import calibration_request, firmware_update, pulled_files
from sixflip_host.board.board_events import wait_for
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.board.event_words import GUIDED_ORDER
from sixflip_host.verbs import calibrate
from sixflip_host.virtual import demo_bench
from sixflip_host.virtual.virtual_board import VirtualBoard

PACE = demo_bench.PACE["pico"]  # the fewest samples a turn


@pytest.mark.parametrize("sensor, settings, hand, left", [
    ("gy85", PACE.settings, PACE.hand, ["Y-a", "Y-b"]),
    ("mpu6050", {}, {}, ["X-b", "Y-a", "Y-b"])],
    ids=["few samples", "in mid-face"])
def test_the_flips_from_before_count(micropython, tmp_path, sensor, settings, hand, left):
    first = [pose for pose in GUIDED_ORDER if pose not in left]
    again = [pose for pose in GUIDED_ORDER if pose[:2] in {name[:2] for name in left}]
    spec = {"sensor": sensor, "seed": 3, "tilt_deg": 2.0, **hand}
    with VirtualBoard(dict(spec, order=first), tmp_path / "flash.img",
                      micropython=micropython) as board, MpremoteLink(board.port) as link:
        firmware_update.copy(link, {"sensor": sensor, **settings})
        link.reset()
        for _ in first:
            wait_for(link, ("pose",))
        link.send(json.dumps({"cmd": "stop"}))
        assert wait_for(link, ("solved",))["missing"] == left
        link.put(calibration_request.FLAG, json.dumps({"continue": True}).encode())
        board.world = dict(spec, order=again)
        link.reset()
        solved = calibrate.follow(link, lambda event: None)
        assert solved["verdict"] == "good", solved
        assert solved["gyro"]["reason"].startswith("6 flips, "), solved["gyro"]
        pulled = pulled_files.fetch(link, tmp_path / "pulled")
    assert cli.main(["verify", str(pulled)]) == 0
