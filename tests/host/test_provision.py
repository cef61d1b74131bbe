"""Provisioning: only what changed, main.py last, interrupted and gone on with, no chip."""

import json
import threading

import pytest

from sixflip_host import cli
from sixflip_host.board import provision
from sixflip_host.board.board_files import board_files
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.errors import NoBoard, UsageError


def quiet(text):
    pass


def test_board_files_are_the_three_parts_and_main_is_last():
    names = list(board_files())
    assert names[-1] == "main.py"
    assert {name.split("/")[0] for name in names} == {"sixflip", "sixflip_device", "main.py"}


def test_second_time_copies_nothing(board, capsys):
    assert cli.main(["provision", "--port", board.port, "--sensor", "mpu6050"]) == 0
    assert "self-test ok: MPU6050" in capsys.readouterr().out
    assert cli.main(["provision", "--port", board.port]) == 0
    assert "\n0 files copied" in capsys.readouterr().out


def test_only_the_changed_file_and_main_last_and_then_both_in_place(link, monkeypatch):
    provision.copy(link, {}, quiet)
    link.put("sixflip/faces.py", b"damaged")
    link.put("main.py", b"damaged")
    order = []
    stage = link.stage
    monkeypatch.setattr(
        link, "stage", lambda name, *rest: (order.append(name), stage(name, *rest)))
    assert provision.copy(link, {}, quiet)[0] == 2
    assert order == ["sixflip/faces.py", "main.py", "sixflip_update.py"]
    assert provision.copy(link, {}, quiet)[0] == 0


def test_settings_of_the_user_stay(link):
    link.put("sixflip.json", b'{"grace_ms": 700, "sensor": "auto"}')
    provision.copy(link, {"sensor": "gy85"}, quiet)
    assert json.loads(link.get("sixflip.json")) == {
        "board": "pico", "grace_ms": 700, "sensor": "gy85"}


def test_what_is_configured_on_the_board_is_kept_and_said(link):
    said = []
    provision.copy(link, {"sensor": "gy85", "sda": 8}, said.append)
    assert said[0] == 'sensor: gy85; board: "pico"'
    provision.copy(link, {}, said.append)
    assert said[2] == "sensor: gy85, as configured on the board (--sensor changes it); " \
        'board: "pico"; sda: 8'
    provision.copy(link, {"sensor": "auto"}, said.append)
    assert said[4].startswith("sensor: found out at power-up; ")


def test_pulled_out_and_gone_on_with(board):
    def pull_out(name, *rest):
        if name == "sixflip/faces.py":
            threading.Timer(0, board.unplug).start()
        return put(name, *rest)

    with MpremoteLink(board.port) as first:
        put = first.put
        first.put = pull_out
        with pytest.raises(NoBoard, match="run the same command again"):
            provision.copy(first, {}, quiet)
    board.plug()
    with MpremoteLink(board.port) as second:
        copied, there = provision.copy(second, {}, quiet)
        assert there > 0
        assert copied + there == len(board_files()) + 1
        assert not [name for name in second.files([]) if name.endswith(".new")]


def test_wrong_chip_is_exit_3(board, capsys):
    assert cli.main(["provision", "--port", board.port, "--sensor", "gy85"]) == 3
    error = capsys.readouterr().err
    assert "no usable sensor" in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("text", ["sda", "sda=", "mosi=3", "=4", ""])
def test_pins_that_are_none(text):
    with pytest.raises(UsageError, match="expected names of sda scl"):
        provision.pins(text)


def test_pins():
    assert provision.pins("sda=4, scl=X9") == {"sda": 4, "scl": "X9"}
