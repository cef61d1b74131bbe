"""The firmware of a Raspberry Pi through real smbus2 down to the ioctl of /dev/i2c-1."""

import errno
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from sixflip_device.boards import raspberry_pi
from sixflip_host import cli
from sixflip_host.board import firmware_update
from sixflip_host.board.local_link import LocalLink

from .device_node import DeviceNode

HERE = Path(__file__).resolve().parent
QUICK = {"grace_ms": 100, "pose_samples": 100, "rest_s": 2, "timeout_s": 60}
SESSION = {"seed": 4, "tilt_deg": 2.0, "first_rest_s": 5.0, "dwell_s": 3.0, "move_s": 1.5}


def power_up(node, flash, until):
    """Events of the firmware's process; once until(event) is true the host says stop."""
    environment = node.environment(SIXFLIP_BOARD_DIR=str(flash), PYTHONDONTWRITEBYTECODE="1")
    firmware = subprocess.Popen(
        [sys.executable, str(HERE / "firmware_in_shared_time.py"), str(node.clock), str(flash)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        env=environment)
    events = []
    enough = False
    try:
        for line in firmware.stdout:
            assert line.startswith("{"), line + firmware.stdout.read()
            events.append(json.loads(line))
            name = events[-1]["event"]
            # the first stop ends a calibration, the second the stream after it
            if until(events[-1]) and not enough or enough and name == "ready":
                enough = True
                firmware.stdin.write('{"cmd": "stop"}\n')
                firmware.stdin.flush()
        assert firmware.wait(30) == 0
    finally:
        firmware.kill()
        firmware.communicate()
    assert name == "stopped"
    return events


def ready(event):
    return event["event"] == "ready"


def named(events, name):
    return [event for event in events if event["event"] == name]


@pytest.fixture
def flash(tmp_path):
    """A folder with the firmware on it."""
    folder = tmp_path / "flash"
    with LocalLink(folder) as link:
        firmware_update.copy(link, dict(QUICK, board="raspberry_pi"), lambda text: None)
    return folder


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85"])
def test_a_whole_calibration_and_the_power_up_after_it(tmp_path, flash, sensor, capsys):
    with DeviceNode(tmp_path, dict(SESSION, sensor=sensor)) as node:
        events = power_up(node, flash, ready)
    hello = named(events, "hello")[0]
    assert (hello["board"], hello["sensor"]) == ("raspberry_pi", sensor)
    assert named(events, "selftest")[0]["ok"]
    assert len(named(events, "pose")) == 12
    solved = named(events, "solved")[0]
    assert solved["verdict"] == "good"
    assert solved["tilt_deg"] == pytest.approx(2.0, abs=0.05)
    assert named(events, "saved")[0]["written"]
    assert named(events, "bus_error") == []

    # every register and every sample by I2C_RDWR, none longer than an SMBus block
    assert set(node.seen["requests"]) == {"0x705", "0x707"}
    assert node.seen["transfers"] > 5000
    assert node.seen["longest"] == {"mpu6050": 14, "gy85": 8}[sensor]

    assert cli.main(["pull", "--port", "local:%s" % flash, "-o", str(tmp_path / "pulled")]) == 0
    pulled = next((tmp_path / "pulled").iterdir())
    assert cli.main(["verify", str(pulled)]) == 0, capsys.readouterr().out

    still = dict(SESSION, sensor=sensor, order=[], first_rest_s=60.0)
    with DeviceNode(tmp_path, still) as node:
        events = power_up(node, flash, lambda event: event["event"] == "sample")
    assert named(events, "record")[0]["slot"] == "a"
    assert named(events, "ready")[0]["corrected"]
    a = named(events, "sample")[0]["a"]
    assert sum(x * x for x in a) ** 0.5 == pytest.approx(9.80665, abs=0.15)


def test_provision_puts_the_firmware_there_and_tests_the_chip(tmp_path, monkeypatch, capsys):
    """The command itself, in real time, the firmware started as on a Raspberry Pi."""
    with DeviceNode(tmp_path, {"sensor": "gy85", "order": [], "first_rest_s": 60.0},
                    real_time=True) as node:
        for name, value in node.environment().items():
            monkeypatch.setenv(name, value)
        folder = tmp_path / "flash"
        code = cli.main(["provision", "--board", "raspberry_pi", "--port", "local:%s" % folder])
    said = [line for line in capsys.readouterr().out.splitlines()
            if line.startswith("self-test") or "GY-85" in line][-1]
    # a busy computer may not keep up, which is all the self-test may find
    assert (code, said[:20]) == (0, "self-test ok: GY-85:") or "GY-85" in said and (
        "too slow" in said and ";" not in said), said
    assert node.seen["transfers"] > 100


FROM_LINUX = [(errno.EREMOTEIO, errno.ENODEV), (errno.ENXIO, errno.ENODEV),
              (errno.EIO, errno.ENODEV), (errno.ETIMEDOUT, errno.ETIMEDOUT)]


@pytest.mark.parametrize("linux,machine", FROM_LINUX)
def test_what_the_kernel_answers_comes_as_machine_i2c_gives_it(tmp_path, flash, linux, machine):
    """One transfer fails: it is made again. Six fail: the bus is opened anew, the chip set up."""
    assert linux in (121, 6, 5, 110)
    # both begin at the reading of a sample, made four times before the bus is opened anew;
    # the check of the registers, after every eighth sample, is made three times
    errnos = [[500, linux, 1], [895, linux, 6]]
    still = {"sensor": "mpu6050", "order": [], "first_rest_s": 120.0}
    with DeviceNode(tmp_path, still, errnos) as node:
        events = power_up(node, flash, lambda event: event.get("action") == "recovered")
    told = [(event["errno"], event["action"]) for event in named(events, "bus_error")]
    freeing = "freeing the bus and asking the chip again"
    assert told == [(machine, "read again"), (machine, freeing), (machine, freeing),
                    (machine, freeing), (machine, "recovered")]
    assert named(events, "error") == []


SMBUS = """
from smbus2 import SMBus
with SMBus(1) as bus:
    bus.write_byte_data(0x68, 0x1B, 0x18)
    print(bus.read_byte_data(0x68, 0x75), bus.read_byte_data(0x68, 0x1B))
    try:
        bus.read_byte_data(0x53, 0)
    except OSError as error:
        print(error.errno)
"""


def test_other_programs_reach_the_same_chips_by_smbus_calls(tmp_path):
    """I2C_SLAVE and I2C_SMBUS, which ours does not use: the fake is not made to its measure."""
    with DeviceNode(tmp_path, {"sensor": "mpu6050"}) as node:
        done = node.run("-c", SMBUS)
    assert done.stdout.split() == [str(0x68), str(0x18), "121"], done.stderr
    assert set(node.seen["requests"]) == {"0x703", "0x705", "0x720"}


def test_no_bus_says_what_was_expected(flash):
    """This computer's own /dev, where raspi-config has not been run."""
    if os.path.exists("/dev/i2c-9"):
        pytest.fail("this computer has an I2C bus 9: the test wants one that is not there")
    settings = json.loads((flash / "sixflip.json").read_text())
    (flash / "sixflip.json").write_text(json.dumps(dict(settings, i2c=9)))
    done = subprocess.run([sys.executable, str(flash / "main.py")], capture_output=True, text=True,
                          env=dict(os.environ, SIXFLIP_BOARD_DIR=str(flash)),
                          stdin=subprocess.DEVNULL)
    assert re.search("expected /dev/i2c-9: switch I2C on .raspi-config.", done.stdout)


def test_a_bus_that_is_not_for_this_user_names_the_group(monkeypatch):
    def refused(number):
        raise PermissionError(errno.EACCES, "Permission denied")

    words = "/dev/i2c-1: add this user to its group"
    monkeypatch.setattr("smbus2.SMBus", refused)
    with open(os.devnull) as nobody, pytest.raises(OSError, match=words) as caught:
        monkeypatch.setattr("sys.stdin", nobody)
        raspberry_pi.make({"i2c": None, "spi": None})
    assert caught.value.errno == errno.EACCES
