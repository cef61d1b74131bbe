"""The firmware under CPython: a folder as flash, a process as the board."""

import pytest

from sixflip_host.board import firmware_update
from sixflip_host.board.local_link import LocalLink
from sixflip_host.errors import NoBoard, UsageError
from sixflip_host.verbs import calibrate

WORLD = {"sensor": "gy85", "seed": 5, "tilt_deg": 1.0}


def test_calibrates_as_a_board_does(tmp_path):
    with LocalLink(tmp_path / "flash", WORLD) as link:
        firmware_update.copy(link, {}, lambda text: None)
        hello, test = firmware_update.self_test(link)
        assert test["ok"]
        assert hello["sensor"] == "gy85"
        link.reset()
        assert calibrate.follow(link, lambda event: None)["verdict"] == "good"
        process = link.process
    assert process.poll() is not None
    assert (tmp_path / "flash" / "record_a.bin").read_bytes()[:4] == b"6FLP"


def test_folder_without_firmware(tmp_path):
    with LocalLink(tmp_path) as link, pytest.raises(NoBoard, match="ended with code 3"):
        list(link.lines(20))


def test_names_stay_in_the_folder(tmp_path):
    with LocalLink(tmp_path / "flash") as link:
        for name in ("../x", "/etc/passwd"):
            with pytest.raises(UsageError, match="leaves the folder"):
                link.get(name)
