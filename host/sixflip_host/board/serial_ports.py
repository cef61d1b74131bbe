"""Serial ports: which are plugged in, which are MicroPython boards, why one will not open."""

import errno
import os

from serial.tools import list_ports

# USB vendor and product of boards that run MicroPython or sit behind their usual bridges.
# Sources: MicroPython ports/*/boards (MICROPY_HW_USB_VID), vendors' lists. None: any product.
KNOWN = {
    (0x2E8A, None): "Raspberry Pi Pico (RP2)",
    (0xF055, None): "MicroPython USB (pyboard class)",
    (0x303A, None): "Espressif ESP32 with USB",
    (0x10C4, 0xEA60): "CP210x bridge (ESP32 boards)",
    (0x1A86, 0x7523): "CH340 bridge (ESP32 boards)",
    (0x1A86, 0x55D4): "CH9102 bridge (ESP32 boards)",
    (0x0403, 0x6001): "FT232 bridge",
    (0x0D28, 0x0204): "micro:bit (DAPLink)",
    (0x239A, None): "Adafruit board",
    (0x1FFB, None): "Pololu or Teensy board",
}


def board_name(port):
    """What KNOWN says about a port of pyserial's list, or None."""
    if port.vid is None:
        return None
    return KNOWN.get((port.vid, port.pid)) or KNOWN.get((port.vid, None))


def boards():
    """Ports with a known board on them, as dicts, sorted by port."""
    return sorted(({"port": port.device, "kind": board_name(port),
                    "usb": "%04x:%04x" % (port.vid, port.pid),
                    "serial_number": port.serial_number or ""}
                   for port in list_ports.comports() if board_name(port)),
                  key=lambda row: row["port"])


def identity(device):
    """(vendor, product, serial number) behind a port, None when there is none (a pty, a UART)."""
    for port in list_ports.comports():
        if port.device == device and port.vid is not None:
            return (port.vid, port.pid, port.serial_number)
    return None


def same_device(wanted, device):
    """The port on which the device of an identity is now; `device` when it cannot be told, as of
    two bridges of a kind that have no serial number."""
    ports = [port.device for port in list_ports.comports()
             if wanted is not None and (port.vid, port.pid, port.serial_number) == wanted]
    return ports[0] if len(ports) == 1 else device


def why_not(device):
    """One line why a port could not be opened."""
    if "://" in device:
        return "%s: nothing listens there, expected socket://host:port of a board" % device
    try:
        descriptor = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except FileNotFoundError:
        there = ", ".join(row["port"] for row in boards()) or "none"
        return "%s: no such port (boards plugged in: %s)" % (device, there)
    except PermissionError:
        return ("%s: no permission to open it; on most Linux systems: sudo usermod -aG dialout "
                "$USER, then log in again" % device)
    except OSError as error:
        if error.errno == errno.EBUSY:
            return held(device)
        return "%s: cannot be opened: %s" % (device, error.strerror)
    is_terminal = os.isatty(descriptor)
    os.close(descriptor)
    if not is_terminal:
        return "%s: is not a serial port" % device
    return held(device)


def held(device):
    return ("%s: another program holds the port (a second terminal?); close it and try again"
            % device)
