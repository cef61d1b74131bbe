"""A virtual board whose operator does what is asked: sessions come to an end by themselves."""

import json

import pytest

from sixflip_host import cli
from sixflip_host.board import calibration_request, firmware_update
from sixflip_host.board.board_events import wait_for
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.verbs import calibrate
from sixflip_host.virtual.board_hands import AskedHand
from sixflip_host.virtual.virtual_board import VirtualBoard

WORLD = {"sensor": "mpu6050", "seed": 3, "tilt_deg": 2.0, "order": []}
PLAN = "Z+a Z+b L1 X+a Y+a L2 Z+a"


@pytest.fixture
def board(micropython, tmp_path):
    with VirtualBoard(WORLD, tmp_path / "flash.img", micropython=micropython, speed=20.0,
                      hand=AskedHand()) as board:
        with MpremoteLink(board.port) as link:
            # Of poses of 100 samples noise alone may be a zero that drifted, and is doubtful.
            firmware_update.copy(link, {"sensor": "mpu6050"})
        yield board


@pytest.mark.long
def test_a_session_a_redo_and_a_redo_without_a_restart(board, capsys):
    assert cli.main(["calibrate", "--port", board.port]) == 0
    assert cli.main(["calibrate", "--port", board.port, "--redo", "X+"]) == 0
    assert capsys.readouterr().out.count("verdict: good") == 2
    with MpremoteLink(board.port) as link:
        wait_for(link, ("sample",))
        link.send(json.dumps({"cmd": "redo", "face": "Y-"}))
        assert calibrate.follow(link, lambda event: None)["verdict"] == "good"


def test_a_plan_with_leaning_poses_and_repeats(board):
    with MpremoteLink(board.port) as link:
        calibration_request.ask_for_calibration(link, {"poses": PLAN, "samples": 100, "rest_s": 2})
        taken = []
        wait_for(link, ("capture",), seen=lambda event: taken.append(event.get("pose")) if
                 event["event"] == "pose" else None)
        assert " ".join(taken) == PLAN
