"""The doctor: every fault simulated, on the virtual board where it is one of the board's."""

import json
import os
import pty
from types import SimpleNamespace

import pytest

from sixflip.chips import probe
from sixflip.record import correction_record
from sixflip_device.boards.spi_bus import SPIBus
from sixflip_host.board import firmware_update
from sixflip_host.board.board_events import wait_for
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.board.local_link import LocalLink
from sixflip_host.cli import main
from sixflip_host.doctor import reach, wiring
from sixflip_host.errors import NoBoard
from sixflip_host.verbs import doctor
from sixflip_host.virtual.virtual_board import VirtualBoard
from sixflip_sim import worlds
from sixflip_sim.spi import SimulatedSPI
from tests.worlds.written_records import make_record

STILL = {"sensor": "mpu6050", "seed": 3, "order": []}


@pytest.fixture(scope="module")
def bench(micropython, tmp_path_factory):
    """(virtual board with the firmware on it, a link to it)."""
    image = tmp_path_factory.mktemp("board") / "flash.img"
    with VirtualBoard(STILL, image, micropython=micropython) as board, \
            MpremoteLink(board.port) as link:
        firmware_update.copy(link, {"sensor": "auto"}, say=lambda text: None)
        yield board, link


def judged(bench, world, lines=None):
    """The findings about the bus of the board in a world; lines: how its wires are."""
    board, link = bench
    board.wiring = {"lines": lines} if lines else {}
    board.power_cycle({**STILL, **world})
    link.raw = False
    wait_for(link, ("hello",))
    return wiring.judge(doctor.ask(link))


def test_a_healthy_board(bench):
    found = judged(bench, {})
    assert [one.state for one in found] == ["ok"] * len(found)
    assert {one.check for one in found} == {
        "settings", "lines", "chips", "sensor", "clock", "range"}


def test_a_chip_that_answers_overrules_idle_lines(bench):
    found = judged(bench, {}, "no pull-ups")
    assert [one.state for one in found] == ["ok"] * len(found)
    assert "but the MPU6050 (0x68) answers" in found[1].found


def test_both_chips_of_a_gy85_are_listed(bench):
    found = judged(bench, {"sensor": "gy85"})
    assert [one.found for one in found if one.check == "chips"] == [
        "ITG3205 at 0x68", "ADXL345 at 0x53"]


GONE = {"faults": [{"kind": "unplugged", "at": 0}]}
TWICE = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]


@pytest.mark.parametrize("world,lines,check,state,words,todo", [
    ({"faults": [{"kind": "unplugged", "at": 0}]}, None, "chips", "fault",
     "nothing answers at 0x68 0x69 0x6a 0x6b 0x53 0x1d", "check the four wires"),
    (GONE, "no pull-ups", "lines", "fault", "no pull-up on SDA (4) and SCL (5)", "4.7 kΩ"),
    (GONE, "sda low", "lines", "fault", "SDA (4) held low", "short to ground"),
    (GONE, "scl low", "lines", "fault", "SCL (5) held low", "short to ground"),
    ({"faults": [{"kind": "timeout", "every": 1}]}, None, "bus", "fault",
     "every transfer times out", "check the four wires"),
    ({"flavour": "soft", "faults": [{"kind": "stuck_sda", "at": 0, "pulses": 1 << 30}]}, None,
     "bus", "fault", "every address answers", "SDA and GND"),
    ({"sensor": "gy85", "also": "mpu6050"}, None, "chips", "fault",
     "two chips seem to answer at 0x68", "tie AD0"),
    ({"who_am_i": 0x98}, None, "chips", "warning", "a clone at 0x68: who_am_i 0x98", "judge it"),
    ({"who_am_i": 0x12}, None, "chips", "fault", "who_am_i 0x12: ICM-20602",
     "does not drive it"),
    ({"sensor": "qmi8658", "stranger": [0x68, 0x00, 0x24]}, None, "chips", "warning",
     "BMI270 at 0x68", "configuration file"),
    ({"who_am_i": 0x33}, None, "chips", "fault", "the nearest is",
     "does not drive it"),
    ({"sensor": "gy85", "magnetometer": "QMC5883L"}, None, "chips", "warning", "QMC5883L",
     "other programs"),
    ({"sensor": "adxl345"}, None, "sensor", "warning", "no gyro", "assumes half turns"),
    ({"accel_matrix": TWICE}, None, "range", "fault", "reads 1.94 g at rest: its range is not",
     "ignores its range register"),
    ({"accel_bias_mg": [0.0, 0.0, 500.0]}, None, "range", "fault", "reads 1.51 g at rest",
     "keep it still"),
    ({"chip_clock_off": -8.0}, None, "clock", "warning", "are meant (-",
     "its clock is off"),
    ({"sensor": "lsm6dsv", "chip_clock_off": 9.0}, None, "clock", "warning",
     "the LSM6DSV or LSM6DSV16X makes", "its clock is off"),
    ({"sensor": "icm20948", "chip_clock_off": -9.0}, None, "clock", "warning",
     "the ICM-20948 makes", "its clock is off"),
    ({"sensor": "gy85", "chip_clock_off": 9.0}, None, "clock", "warning",
     "the ITG3205 makes", "its clock is off"),
    ({"faults": [{"kind": "frozen", "at_ms": 1}]}, None, "clock", "fault",
     "makes no new samples", "power away"),
    ({"freq": 10000}, None, "rate", "fault", "samples a second reached, 100 are wanted",
     "a faster bus"),
    ({"faults": [{"kind": "nak", "every": 97}]}, None, "samples", "warning", "transfers failed",
     "shorter wires"),
])
def test_a_fault_is_named_with_what_to_do(bench, world, lines, check, state, words, todo):
    found = judged(bench, world, lines)
    named = [one for one in found if words in one.found]
    assert len(named) == 1, found
    assert (named[0].check, named[0].state) == (check, state) and todo in named[0].todo
    if state == "warning" or check == "rate":
        assert [one for one in found if one.state != "ok"] == named
    if state == "warning":
        assert not any(one.state == "fault" for one in found)


def test_on_spi_the_bus_is_called_so_and_a_wrong_mode_is_named():
    spi = SPIBus(SimulatedSPI(worlds.make(STILL).i2c, 1), 1)
    with pytest.raises(probe.NoChip) as caught:
        probe.find(spi)
    said = {"settings": ("pico", "auto", "SPI at 1000 kHz, mode 1", []), "scan": ([],),
            "ids": ({},), "no sensor": (caught.value.report,)}
    found = wiring.judge(said)
    assert "SPI at 1000 kHz" in found[0].found and "I2C" not in found[0].found
    assert [one.state for one in found] == ["ok", "fault"]
    assert "SPI mode 1 is wrong, the chips take 0 and 3" in found[1].found


def findings(capsys, *words):
    """(exit code, {check: finding}) of the verb."""
    capsys.readouterr()
    code = main(["doctor", *words, "--json"])
    answer = json.loads(capsys.readouterr().out)
    assert answer["ok"] == all(one["state"] != "fault" for one in answer["findings"])
    return code, {one["check"]: one for one in answer["findings"]}


def test_the_verb_from_port_to_record(bench, capsys):
    """A board on its port: healthy, in words; then a wrong record, another setting."""
    board, link = bench
    judged(bench, {})
    firmware_update.copy(link, {"sensor": "auto"}, say=lambda text: None)
    link.close()
    try:
        assert main(["doctor", "--port", board.port]) == 0
        out = capsys.readouterr().out
        assert "nothing is wrong" in out and "MicroPython v1." in out
        assert "files are this sixflip's" in out and "no correction in flash" in out
        with MpremoteLink(board.port) as other:
            other.put("record_a.bin", correction_record.encode(make_record()))
        code, found = findings(capsys, "--port", board.port)
        assert code == 1 and found["record"]["state"] == "fault"
        assert "at 8192 counts per g, the sensor is a mpu6050 at 16384" in found["record"]["found"]
        with MpremoteLink(board.port) as other:
            other.remove("record_a.bin")
            other.put("sixflip.json", b'{"sensor": "gy85"}')
            other.put("sixflip_device/led.py", b"# an older one\n")
        code, found = findings(capsys, "--port", board.port)
        assert code == 3 and found["firmware"]["state"] == "warning"
        assert "the settings ask for gy85, which is not there" in found["chips"]["found"]
    finally:
        link.open()
        firmware_update.copy(link, {"sensor": "auto"}, say=lambda text: None)


def test_provision_and_pull_as_json(bench, tmp_path, capsys):
    """Here because this board has its firmware already."""
    board, link = bench
    judged(bench, {})
    link.close()
    try:
        capsys.readouterr()
        assert main(["provision", "--port", board.port, "--json"]) == 0
        done = json.loads(capsys.readouterr().out)
        assert done["selftest"]["ok"] and done["files_there"] > 50
        assert main(["pull", "--port", board.port, "-o", str(tmp_path), "--json"]) == 0
        fetched = json.loads(capsys.readouterr().out)
        # a session in which the box was never turned may have been refused already
        assert {"sixflip.json"} <= set(fetched["files"]) <= {
            "sixflip.json", "refused.bin", "refused.csv"}
        assert fetched["board"] == board.unique_id
    finally:
        link.open()


def test_no_firmware_on_the_board(board, capsys):
    code, found = findings(capsys, "--port", board.port)
    assert code == 1 and found["firmware"]["todo"] == "sixflip provision"
    assert found["MicroPython"]["state"] == "ok"


def test_a_port_that_somebody_holds(bench, capsys):
    code, found = findings(capsys, "--port", bench[0].port)     # by our own link
    assert code == 3 and "is held by another program" in found["port"]["found"]


# -- ports


def port(device, vid=None, pid=None):
    return SimpleNamespace(device=device, vid=vid, pid=pid, description="something")


def test_no_port_at_all(monkeypatch, capsys):
    monkeypatch.setattr(doctor.list_ports, "comports", lambda: [])
    code, found = findings(capsys)
    assert code == 3 and "no serial port at all" in found["port"]["found"]
    assert "another USB cable" in found["port"]["todo"]


def test_ports_that_are_no_boards_and_too_many_boards():
    (found,), chosen = reach.ports([port("/dev/ttyS0")])
    assert chosen is None and "/dev/ttyS0 (something)" in found.found and found.unreachable
    (found,), chosen = reach.ports([port("/dev/ttyACM0", 0x2E8A, 5), port("/dev/ttyACM1", 0xF055)])
    assert chosen is None and found.todo == "say which one: sixflip doctor --port /dev/ttyACM0"
    (found,), chosen = reach.ports([port("/dev/ttyS0"), port("/dev/ttyACM1", 0x2E8A, 5)])
    assert chosen == "/dev/ttyACM1" and found.state == "ok"


def test_a_port_one_may_not_open(monkeypatch, tmp_path):
    device = tmp_path / "ttyACM0"
    device.write_text("")

    def denied(*args):
        raise PermissionError(13, "Permission denied")
    monkeypatch.setattr(os, "open", denied)
    found = reach.opened(str(device))
    assert found.unreachable and "you may not open it; its group is" in found.found
    assert found.todo.startswith("sudo usermod -aG ") or "log out" in found.todo


def test_a_member_of_the_group_who_has_not_logged_in_again(monkeypatch, tmp_path):
    import grp
    import pwd
    monkeypatch.setattr(grp, "getgrgid", lambda gid: SimpleNamespace(gr_name="dialout"))
    monkeypatch.setattr(pwd, "getpwuid", lambda uid: SimpleNamespace(pw_name="maker"))
    for members, todo in ((["maker"], "log out and in again"), ([], "usermod -aG dialout maker")):
        monkeypatch.setattr(grp, "getgrnam", lambda name, m=members: SimpleNamespace(gr_mem=m))
        assert todo in reach.not_allowed(str(tmp_path)).todo


def test_no_such_port_and_no_serial_port(tmp_path):
    assert "no such port" in reach.opened("/dev/ttyNONE9").found
    (tmp_path / "file").write_text("")
    assert "is no serial port" in reach.opened(str(tmp_path / "file")).found


def test_who_holds_a_port(tmp_path):
    master, slave = pty.openpty()
    device = os.ttyname(slave)
    for number, name, target in ((4711, "minicom", device), (4712, "idle", "/dev/null")):
        (tmp_path / str(number) / "fd").mkdir(parents=True)
        (tmp_path / str(number) / "fd" / "3").symlink_to(target)
        (tmp_path / str(number) / "comm").write_text(name + "\n")
    assert reach.holders(device, tmp_path) == ["minicom (4711)"]
    os.close(master)
    os.close(slave)


# -- what runs on the board


class Board:
    """A link to a board that says this of itself."""

    port = "/dev/ttyACM0"

    def __init__(self, *version, said=b""):
        self.version_said = version
        self.said = said

    def version(self):
        if not self.version_said:
            raise NoBoard("/dev/ttyACM0 does not answer as a MicroPython board does")
        return self.version_said

    def run(self, code, doing, timeout):
        return self.said

    def files(self, hashed):
        return {}


@pytest.mark.parametrize("version,state,words", [
    (("v1.25.0 on 2025-04-15", "Raspberry Pi Pico with RP2040"), "ok", "Pico with RP2040"),
    (("v1.19.1 on 2022-06-18", "ESP32 module"), "warning", "older than 1.21"),
    (("9.2.1 on 2024-11-20", "Adafruit CircuitPython on a Pico"), "fault", "CircuitPython"),
    ((), "fault", "does not answer")])
def test_what_runs_on_the_board(version, state, words):
    found, = reach.micropython(Board(*version))
    assert found.state == state and words in found.found
    assert found.unreachable == (state == "fault")


@pytest.mark.parametrize("said", [
    b"", b"Traceback\n", b"('lines',)\n", b"('settings', 1)\n",
    b"('settings', 'pico', 'auto', 1, [])\n('scan', [])\n('ids', {(104, 117): b'h'})\n"
    b"('sensor', 'x')\n", b"[" * 5000])
def test_a_board_that_talks_nonsense(said):
    with pytest.raises(NoBoard, match="board|bus"):
        doctor._of_the_bus(Board("x", "y", said=said))


def test_this_computer_as_the_board(tmp_path, monkeypatch, capsys):
    """A Raspberry Pi whose I2C is not switched on."""
    folder = tmp_path / "board"
    with LocalLink(folder) as link:
        firmware_update.copy(link, {"sensor": "auto", "i2c": 13}, say=lambda text: None)
        (folder / "sixflip.json").write_text('{"i2c": 13}')
    monkeypatch.setattr(LocalLink, "reset", lambda self: None)
    code, found = findings(capsys, "--port", "local:%s" % folder)
    assert code == 3 and "/dev/i2c-13" in found["bus"]["found"]
