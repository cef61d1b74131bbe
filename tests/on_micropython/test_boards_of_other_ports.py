"""Every board file with pins and a bus that refuse what the port of MicroPython refuses."""

import json
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
QUICK = {"grace_ms": 0, "pose_samples": 100, "rest_s": 2, "timeout_s": 60, "stream_hz": 0}
SESSION = {"sensor": "mpu6050", "seed": 3, "tilt_deg": 2.0, "first_rest_s": 5.0, "dwell_s": 3.0,
           "move_s": 1.5}
IN_A_MOVE_MS = 22000
# board, flavour of its bus, pins of clock, LED and button
PORTS = {"esp32": ("esp32", 22, "2", 0), "pyboard": ("stm32", "X9", "LED_BLUE", "SW"),
         "pico": ("rp2", 5, "LED", 15)}


@pytest.fixture
def power_up(micropython, tmp_path):
    """power_up(settings, world, wiring) -> its events, the firmware freshly on the flash."""
    for name in ("sixflip", "sixflip_device"):
        part = "shared" if name == "sixflip" else "device"
        (tmp_path / name).symlink_to(ROOT / part / name)
    (tmp_path / "main.py").symlink_to(ROOT / "device" / "main.py")
    os.mkfifo(tmp_path / "asked")

    def run(settings, world, wiring):
        (tmp_path / "sixflip.json").write_text(json.dumps(dict(QUICK, **settings)))
        (tmp_path / "port.json").write_text(json.dumps(
            {"world": dict(SESSION, **world), "wiring": wiring}))
        done = micropython("firmware_on_another_port.py", str(tmp_path), heap="4m")
        assert done.returncode == 0, done.stdout[-500:] + done.stderr[-1500:]
        return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]

    return run


def named(events, name):
    return [event for event in events if event["event"] == name]


@pytest.mark.parametrize("board", PORTS)
def test_calibrates_frees_a_stuck_bus_by_its_own_pins_and_uses_its_own_led(power_up, board):
    flavour, scl, led, _ = PORTS[board]
    events = power_up({"board": board}, {"flavour": flavour, "faults": [
        {"kind": "stuck_sda", "at_ms": IN_A_MOVE_MS, "pulses": 9}]}, {"scl_pin": scl})
    assert named(events, "hello")[0]["board"] == board
    actions = [event["action"] for event in named(events, "bus_error")]
    assert "recovered" in actions, (actions, events[-1])
    assert len(named(events, "pose")) == 12, events[-1]
    assert named(events, "solved")[0]["verdict"] == "good"
    assert led in events[-1]["touched"]


@pytest.mark.parametrize("board", PORTS)
def test_the_button_held_at_power_up_asks_for_a_calibration(power_up, board):
    flavour, _, _, button = PORTS[board]
    asked = {"board": board, "button": button}
    world = {"flavour": flavour, "order": [], "first_rest_s": 100.0}
    power_up(asked, {"flavour": flavour}, {})
    assert named(power_up(asked, world, {}), "calibrating") == []
    held = power_up(dict(asked, timeout_s=5), world, {"button_pin": button, "button_held": True})
    assert len(named(held, "calibrating")) == 1


def test_an_stm32_board_with_other_pin_names_is_given_a_new_bus(power_up):
    """A Nucleo has no X9: no clock pulses by hand, but no crash in mid-recovery either."""
    events = power_up({"board": "pyboard", "scl": "PC40", "sda": "PC41", "led": 5},
                      {"flavour": "stm32", "faults": [
                          {"kind": "unplugged", "at_ms": IN_A_MOVE_MS, "for_ms": 60}]}, {})
    assert "recovered" in [event["action"] for event in named(events, "bus_error")]
    assert named(events, "saved")[0]["written"]


def test_a_bus_on_pins_that_are_not_there_leads_to_the_setting(power_up):
    """An ESP32-C3 has no GPIO 22."""
    events = power_up({"board": "esp32", "scl": 45}, {"flavour": "esp32"}, {})
    assert "scl 45" in events[-1]["what"] and "sixflip.json" in events[-1]["what"]
