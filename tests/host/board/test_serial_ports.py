"""Which port a board is on after it went away and came back."""

from types import SimpleNamespace

from sixflip_host.board import serial_ports

PICO, OTHER_PICO, BRIDGE = (0x2E8A, 5, "E66"), (0x2E8A, 5, "F77"), (0x1A86, 0x7523, None)


def plugged(monkeypatch, **ports):
    monkeypatch.setattr(serial_ports.list_ports, "comports", lambda: [
        SimpleNamespace(device=device, vid=vid, pid=pid, serial_number=number)
        for device, (vid, pid, number) in ports.items()])


def test_a_board_with_a_serial_number_is_found_wherever_it_comes_back(monkeypatch):
    plugged(monkeypatch, a=OTHER_PICO, c=PICO)
    assert serial_ports.same_device(PICO, "b") == "c"
    plugged(monkeypatch, a=OTHER_PICO)
    assert serial_ports.same_device(PICO, "b") == "b"


def test_of_twin_bridges_none_is_taken_for_the_other(monkeypatch):
    plugged(monkeypatch, a=BRIDGE, b=BRIDGE)
    assert serial_ports.same_device(BRIDGE, "b") == "b"
    plugged(monkeypatch, a=BRIDGE, c=BRIDGE)
    assert serial_ports.same_device(BRIDGE, "b") == "b"
    plugged(monkeypatch, c=BRIDGE)
    assert serial_ports.same_device(BRIDGE, "b") == "c"
