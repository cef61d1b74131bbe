"""Provisioning: only what changed, main.py last, interrupted and gone on with, no chip."""

import json
import sys
import threading

import pytest

from sixflip.chips import catalogue
from sixflip_host import cli
from sixflip_host.board import compiled_firmware, firmware_update
from sixflip_host.board.board_files import board_files
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.errors import NoBoard, UsageError
from sixflip_host.verbs import provision
from sixflip_host.virtual.virtual_board import VirtualBoard


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
    firmware_update.copy(link, {}, quiet)
    link.put("sixflip/poses/faces.mpy", b"damaged")
    link.put("main.py", b"damaged")
    order = []
    write = link.write
    monkeypatch.setattr(
        link, "write", lambda fresh, *rest: (order.append(fresh), write(fresh, *rest)))
    assert firmware_update.copy(link, {}, quiet)[0] == 2
    assert order == ["sixflip_new/sixflip/poses/faces.mpy", "sixflip_new/main.py",
                     "sixflip_update.py.new"]
    assert firmware_update.copy(link, {}, quiet)[0] == 0


def test_settings_of_the_user_stay(link):
    link.put("sixflip.json", b'{"grace_ms": 700, "sensor": "auto"}')
    firmware_update.copy(link, {"sensor": "gy85"}, quiet)
    assert json.loads(link.get("sixflip.json")) == {
        "board": "pico", "grace_ms": 700, "sensor": "gy85"}


def test_what_is_configured_on_the_board_is_kept_and_said(link):
    said = []
    firmware_update.copy(link, {"sensor": "gy85", "sda": 8}, said.append)
    assert said[0] == 'sensor: gy85; board: "pico"'
    firmware_update.copy(link, {}, said.append)
    assert said[2] == "sensor: gy85, as configured on the board (--sensor changes it); " \
        'board: "pico"; sda: 8'
    firmware_update.copy(link, {"sensor": "auto"}, said.append)
    assert said[4].startswith("sensor: found out at power-up; ")


def test_pulled_out_and_gone_on_with(board):
    def pull_out(name, *rest):
        if name == "sixflip/poses/faces.mpy":
            threading.Timer(0, board.unplug).start()
        return put(name, *rest)

    with MpremoteLink(board.port) as first:
        put = first.put
        first.put = pull_out
        with pytest.raises(NoBoard, match="run the same command again"):
            firmware_update.copy(first, {}, quiet)
    board.plug()
    with MpremoteLink(board.port) as second:
        copied, there = firmware_update.copy(second, {}, quiet)
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


def as_source(monkeypatch, link):
    """The firmware goes there uncompiled, as from a computer without mpy-cross."""
    monkeypatch.setattr(link, "mpy", lambda: None)
    firmware_update.copy(link, {}, quiet)
    monkeypatch.undo()


def modules(link):
    """Endings of what is imported from the board's two packages."""
    return {name.rsplit(".", 1)[1] for name in link.files([]) if name.startswith("sixflip")
            and "/" in name}


@pytest.mark.long
def test_compiled_it_takes_the_place_of_the_source_and_back(link, monkeypatch):
    as_source(monkeypatch, link)
    assert modules(link) == {"py"}
    firmware_update.copy(link, {}, quiet)
    assert modules(link) == {"mpy"}
    assert link.run("from sixflip.poses import faces; print(faces.__file__)", "").strip() \
        == b"sixflip/poses/faces.mpy"
    as_source(monkeypatch, link)
    assert modules(link) == {"py"}


def test_what_an_earlier_firmware_had_and_this_one_has_not_goes(link):
    firmware_update.copy(link, {}, quiet)
    link.put("sixflip/record.mpy", b"a module where there is a folder now")
    link.put("sixflip_device/maker.txt", b"no module")
    firmware_update.copy(link, {}, quiet)
    there = link.files([])
    assert "sixflip/record.mpy" not in there and "sixflip/record/record.mpy" in there
    assert "sixflip_device/maker.txt" in there


@pytest.mark.long
def test_source_left_beside_a_half_copied_firmware_is_not_imported(link, monkeypatch):
    as_source(monkeypatch, link)
    link.remove("main.py")
    firmware_update.copy(link, {}, quiet)
    assert modules(link) == {"mpy"}


@pytest.mark.parametrize("mpy, why", [(None, "loads no .mpy files"), (0x0005, "of version 5"),
                                      (0x1F07, "of version 7")])
def test_another_format_gets_the_source_with_one_line(link, monkeypatch, mpy, why):
    monkeypatch.setattr(link, "mpy", lambda: mpy)
    said = []
    firmware_update.copy(link, {}, said.append)
    assert [line for line in said if "as source" in line and why in line]
    assert modules(link) == {"py"}


def test_no_compiler_here_is_no_obstacle(monkeypatch):
    compiled_firmware.compiled.cache_clear()
    monkeypatch.setitem(sys.modules, "mpy_cross", None)
    files, why = compiled_firmware.for_board({"main.py": b"x", "sixflip/a.py": b"V = 1"}, 0xB06)
    assert (sorted(files), why) == (["main.py", "sixflip/a.py"], "mpy-cross is not installed here")


def test_what_does_not_compile_stays_source():
    files, why = compiled_firmware.for_board({"main.py": b"x", "sixflip/a.py": b"def ("}, 0xB06)
    assert "sixflip/a.py" in files and "SyntaxError" in why


def test_what_the_chip_offers_and_the_nearest_is_said(board, capsys):
    assert cli.main(["provision", "--port", board.port, "--sensor", "mpu6050",
                     "--range", "3g,2000dps", "--rate", "200"]) == 0
    out = capsys.readouterr().out
    assert "the mpu6050 has no ±3 g but 2 4 8 16: ±4 is taken" in out
    assert '; accel_range_g: 4' in out or "accel_range_g" not in out.split("sensor:")[0]
    assert "0x68: MPU6050 (who_am_i 0x68)" in out
    assert "self-test ok: MPU6050 (0x68), 200 samples a second" in out


@pytest.mark.parametrize("words, expected", [
    (["--range", "8"], "--range 8: expected a full scale"),
    (["--range", "8g,4g"], "expected a full scale"), (["--range", "900g"], "expected 1 to 64"),
    (["--rate", "5"], "--rate 5: expected 10 to 500"),
    (["--spi", "clk=3"], "--spi clk=3: expected"),
    (["--spi", "mode=1"], "the chips take the modes 0 and 3")])
def test_ranges_rates_and_pins_that_cannot_be(words, expected, capsys):
    assert cli.main(["provision", "--port", "nowhere", *words]) == 2
    assert expected in capsys.readouterr().err


def test_only_the_driver_of_the_sensor_that_is_named_is_sent(link):
    firmware_update.copy(link, {"sensor": "lsm6dsox"}, quiet)
    drivers = {row[1].split(".")[0] for row in catalogue.CHIPS if row[1]}
    there = {name[len("sixflip/chips/"):-len(".mpy")] for name in link.files(["main.py"])
             if name.startswith("sixflip/chips/")}
    assert there & drivers == {"lsm6ds"} and "six_axis" in there


def test_a_chip_on_spi_by_its_pins(tmp_path, capsys):
    with VirtualBoard({"sensor": "lsm6dsox", "order": []}, tmp_path / "flash.img") as spi_board:
        assert cli.main(["provision", "--port", spi_board.port, "--sensor", "auto",
                         "--spi", "cs=17"]) == 0
    out = capsys.readouterr().out
    assert "SPI: LSM6DSOX or LSM6DSO (who_am_i 0x6c)" in out and "self-test ok: LSM6DSOX" in out
