"""Is there a port, may it be opened, does a MicroPython answer, is our firmware on it?"""

import errno
import os
import re
from pathlib import Path

from ..board import firmware_update, serial_ports
from ..errors import SixflipError
from .finding import fault, ok, warning

OLDEST = (1, 21)            # of MicroPython: what the firmware is tried with
PLENTY = 30                 # bytes of a program's name


def ports(serial):
    """(Findings, port or None) where none was named; serial: pyserial's list of ports."""
    boards = [port for port in serial if serial_ports.board_name(port)]
    if len(boards) == 1:
        return [ok("port", "%s: %s" % (boards[0].device, serial_ports.board_name(boards[0])))], \
            boards[0].device
    if boards:
        return [fault("port", "%d boards are plugged in: %s" % (
            len(boards), " ".join(port.device for port in boards)),
            "say which one: sixflip doctor --port %s" % boards[0].device, True)], None
    if serial:
        return [fault("port", "no board that is known among the serial ports: %s" % ", ".join(
            "%s (%s)" % (port.device, port.description) for port in serial[:8]),
            "if one of them is yours, name it: sixflip doctor --port %s" % serial[0].device,
            True)], None
    return [fault("port", "this computer sees no serial port at all",
                  "another USB cable (many only charge), another socket, no hub; hold no BOOTSEL "
                  "button; on Linux `dmesg` says whether anything was plugged in. Without "
                  "hardware: sixflip virtual-board", True)], None


def opened(device):
    """A Finding of whether a port can be opened; only Linux and macOS tell before."""
    if "://" in device or not hasattr(os, "O_NOCTTY"):
        return ok("port", "%s: looked at by opening it" % device)
    try:
        descriptor = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except FileNotFoundError:
        return fault("port", serial_ports.why_not(device), "plug it in, or name another port",
                     True)
    except PermissionError:
        return not_allowed(device)
    except OSError as error:
        if error.errno == errno.EBUSY:
            return busy(device)
        return fault("port", "%s: cannot be opened: %s" % (device, error.strerror),
                     "unplug the board and plug it in again", True)
    with os.fdopen(descriptor, "rb", buffering=0) as port:
        if not os.isatty(descriptor):
            return fault("port", "%s: is no serial port" % device, "name the board's port", True)
        if not lockable(port):
            return busy(device)
    others = [] if device.startswith("/dev/pts/") else holders(device)
    if others:      # it does not lock, but it takes half of what the board says
        return warning("port", "%s: is also open in %s" % (device, ", ".join(others)),
                       "close that program")
    return ok("port", "%s: can be opened" % device)


def lockable(port):
    """Whether nobody holds the lock that pyserial and mpremote take; it is let go again."""
    import fcntl
    try:
        fcntl.flock(port, fcntl.LOCK_EX | fcntl.LOCK_NB)
        fcntl.flock(port, fcntl.LOCK_UN)
    except OSError as error:
        return error.errno not in (errno.EAGAIN, errno.EACCES)
    return True


def not_allowed(device):
    """The group that may use the port, and how to get into it."""
    import grp
    import pwd
    try:
        name = grp.getgrgid(os.stat(device).st_gid).gr_name
        user = pwd.getpwuid(os.getuid()).pw_name
        member = user in grp.getgrnam(name).gr_mem
    except (KeyError, OSError):
        name, user, member = "dialout", "$USER", False
    todo = "you are in the group %s, but not since you logged in: log out and in again" % name \
        if member else "sudo usermod -aG %s %s, then log out and in again" % (name, user)
    return fault("port", "%s: you may not open it; its group is %s" % (device, name), todo, True)


def busy(device):
    """Who has the port, as far as this user may know."""
    others = holders(device)
    return fault("port", "%s: is held by %s" % (device, ", ".join(others) or "another program"),
                 "close that program (a second terminal?) and try again", True)


def holders(device, processes="/proc"):
    """["minicom (4711)"] of other processes that have the device open."""
    holding = []
    real = os.path.realpath(device)
    for folder in Path(processes).glob("[0-9]*"):
        if int(folder.name) == os.getpid():
            continue
        try:
            held = any(os.path.realpath(one) == real for one in (folder / "fd").iterdir())
            name = (folder / "comm").read_text(errors="replace").strip()[:PLENTY] if held else ""
        except OSError:         # another user's, or gone meanwhile
            continue
        if held:
            holding.append("%s (%s)" % (name, folder.name))
    return holding


def micropython(link):
    """Findings of what runs on the board: MicroPython, and a version that will do."""
    try:
        version, machine = (str(one) for one in link.version())
    except SixflipError as error:
        return [fault("MicroPython", str(error),
                      "put MicroPython on the board (micropython.org/download), close other "
                      "programs on the port, press its reset button once", True)]
    said = "%s, %s" % (machine, version)
    if "circuitpython" in said.lower() or "adafruit" in version.lower():
        return [fault("MicroPython", "this is CircuitPython: " + said,
                      "its machine module is another one; put MicroPython on the board "
                      "(micropython.org/download)", True)]
    number = re.search(r"(\d+)\.(\d+)", version)
    if version.startswith("CPython"):
        return [ok("MicroPython", "none, this computer: " + said)]
    if number and (int(number.group(1)), int(number.group(2))) < OLDEST:
        return [warning("MicroPython", "%s: older than %d.%d, with which the firmware is tried"
                        % (said, *OLDEST), "put a newer one on the board "
                        "(micropython.org/download); its files stay")]
    return [ok("MicroPython", said)]


def firmware(link):
    """Findings of the files on the board against those of this computer."""
    import hashlib
    ours, _ = firmware_update.firmware_for(link)
    there = link.files(list(ours))
    if "main.py" not in there or not any(name.startswith("sixflip_device/") for name in there):
        return [fault("firmware", "sixflip's firmware is not on this board", "sixflip provision")]
    differ = [name for name, data in ours.items()
              if there.get(name, (0, ""))[1] != hashlib.sha256(data).hexdigest()]
    # what an earlier firmware left may be imported in place of this one's: NAME.py before NAME.mpy
    differ += [name for name in there if name not in ours
               and firmware_update.of_the_firmware(name)]
    if differ:
        return [warning("firmware", "%d of its %d files are not this sixflip's (%s)" % (
            len(differ), len(ours), ", ".join(sorted(differ)[:3])), "sixflip provision")]
    return [ok("firmware", "all %d files are this sixflip's" % len(ours))]
