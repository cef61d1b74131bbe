"""sixflip provision: the firmware onto a board, only what changed, then its self-test."""

import contextlib
import hashlib
import json

from ..errors import NoBoard, SixflipError, UsageError
from ..terminal import plain
from . import board_schema
from .board_answers import NoSpace
from .board_events import events, unusable
from .board_files import board_files
from .byte_progress import Bytes
from .on_board_scripts import UPDATE
from .ports import add_port, open_link

HELP = "copy the firmware onto a board and test its sensor"
EXAMPLE = "sixflip provision --sensor gy85 --pins sda=4,scl=5"
BOARDS = ("pico", "esp32", "pyboard", "raspberry_pi")
SENSORS = ("auto", "mpu6050", "gy85", "adxl345")
PLATFORMS = {"rp2": "pico", "esp32": "esp32", "pyboard": "pyboard"}
SETTINGS = "sixflip.json"


def add_arguments(parser):
    add_port(parser)
    parser.add_argument("--sensor", choices=SENSORS, help="default: find out at power-up")
    parser.add_argument("--board", choices=BOARDS, help="default: by the port of MicroPython")
    parser.add_argument("--pins", metavar="sda=4,scl=5",
                        help="pins that differ from the board's usual ones: sda, scl, led, button")
    parser.add_argument("--json", action="store_true", help="what was done and tested, as JSON")


def pins(text):
    """{"sda": 4, "scl": 5} of "sda=4,scl=5"; names such as X9 stay text."""
    found = {}
    for part in text.split(","):
        name, equals, value = part.strip().partition("=")
        if name not in ("sda", "scl", "led", "button") or not equals or not value:
            raise UsageError("--pins %s: expected names of sda scl led button with a pin each, "
                             "such as sda=4,scl=5" % text)
        found[name] = int(value) if value.isdigit() else value
    return found


def wanted_settings(args):
    """What the command line says for sixflip.json."""
    wanted = pins(args.pins) if args.pins else {}
    for name in ("sensor", "board"):
        if getattr(args, name):
            wanted[name] = getattr(args, name)
    return wanted


def json_settings(data):
    """The settings of a sixflip.json, {} where it is damaged: they are written anew then."""
    try:
        return board_schema.SETTINGS.take(json.loads(data))
    except (ValueError, RecursionError):
        return {}


def merged_settings(link, present, wanted):
    """Bytes of sixflip.json: what is on the board, changed where the command line says so."""
    values = json_settings(link.get(SETTINGS)) if SETTINGS in present else {}
    values.update(wanted)
    if "board" not in values:
        values["board"] = PLATFORMS.get(link.platform(), "pico")
    return (json.dumps(values, indent=1, sort_keys=True) + "\n").encode()


def settings_line(data, wanted):
    """What sixflip.json on the board says from now on, and what of it was there before."""
    values = json.loads(data)
    kept = [name for name in sorted(values) if name not in wanted and name != "sensor"]
    sensor = values.get("sensor", "auto")
    line = "sensor: %s" % ("found out at power-up" if sensor == "auto" else sensor)
    if "sensor" not in wanted and "sensor" in values:
        line += ", as configured on the board (--sensor changes it)"
    return line + "".join("; %s: %s" % (name, json.dumps(values[name])) for name in kept)


def copy(link, wanted, say=print):
    """Bring the board's files up to date; returns (number copied, number already there).

    On a board that starts a firmware all new files are copied beside the old ones first and
    take their places together: pulled out at any time it starts the old one or the new one.
    """
    files = {name: path.read_bytes() for name, path in board_files().items()}
    asked = [*files, SETTINGS]
    present = link.files(asked)
    if UPDATE in present:  # cut off, and not powered up since
        link.finish()
        present = link.files(asked)
    files[SETTINGS] = merged_settings(link, present, wanted)
    say(plain(settings_line(files[SETTINGS], wanted)))
    hashes = {name: hashlib.sha256(data).hexdigest() for name, data in files.items()}
    changed = [name for name in files if present.get(name, (0, ""))[1] != hashes[name]]
    changed.sort(key=lambda name: name == "main.py")  # a half-copied board never starts it
    starts = "main.py" in present
    ready = [name for name in changed
             if starts and present.get(name + ".new", (0, ""))[1] == hashes[name]]
    # What a cable pulled out in mid-copy left behind.
    for name in present:
        if name.endswith(".new") and name[:-4] in files and name[:-4] not in ready:
            link.remove(name)
    todo = [name for name in changed if name not in ready]
    with Bytes("copying", sum(len(files[name]) for name in todo)) as bar:
        try:
            send(link, link.stage if starts else link.put, files, todo, bar)
        except NoSpace:
            if not starts:
                raise
            say("no room for the old firmware and the new one: without one until this is done")
            for name in ["main.py", *[name + ".new" for name in changed]]:
                with contextlib.suppress(SixflipError, OSError):
                    link.remove(name)
            todo = [name for name in changed if name != "main.py"] + ["main.py"]
            bar.at(0)
            send(link, link.put, files, todo, bar)
            starts = False
    if starts and changed:
        link.commit(changed)
    say("%d files copied, %d already there" % (len(todo), len(files) - len(todo)))
    return len(todo), len(files) - len(todo)


def send(link, put, files, names, bar):
    """put(name, data, progress) of every name, with a hint when the board goes away."""
    done = 0
    for number, name in enumerate(names):
        try:
            put(name, files[name], lambda n, base=done: bar.at(base + n))
        except NoSpace:
            raise
        except NoBoard as error:
            raise NoBoard("%s; %d of %d files are copied, run the same command again and it "
                          "goes on from there" % (error, number, len(names))) from None
        done += len(files[name])


NO_SENSOR = "no usable sensor"


def self_test(link, say=print):
    """The board's self-test after a reset: (hello, selftest) events; NoBoard without a sensor."""
    link.reset()
    try:
        return first_words(link, 6, say)
    except Silent:
        # What was said before the USB port was back is lost; a soft reset keeps the port.
        link.restart_firmware()
        return first_words(link, 15, say)


class Silent(NoBoard):
    """No self-test was heard of."""


def first_words(link, silence_s, say):
    hello = {}
    for event in events(link, silence_s, 60):
        if event["event"] == "hello":
            hello = event
        elif event["event"] == "selftest":
            return hello, event
        elif event["event"] == "misfit" and event["of"] == "selftest":
            raise NoBoard(unusable(link.port, event))
        elif event["event"] == "error":
            line = "%s; expected %s" % (event["what"], event.get("expected"))
            if event["what"].startswith(NO_SENSOR):
                raise NoBoard("%s: %s" % (link.port, line))
            say("the board says: " + plain(line))
    raise Silent("%s: no self-test within %d s of the reset" % (link.port, silence_s))


def verdict_line(hello, test):
    """One line for a person: which chip, and whether it does what it should."""
    chip = hello.get("chip") or hello.get("sensor") or "sensor"
    if test["ok"]:
        return "self-test ok: %s, %.0f samples a second" % (chip, test.get("rate_hz") or 0)
    return "self-test failed: %s: %s" % (chip, "; ".join(test.get("problems") or ["no reason"]))


def run(args):
    wanted = wanted_settings(args)
    say = (lambda text: None) if args.json else print
    with open_link(args.port) as link:
        version, machine = link.version()
        say(plain("%s: %s, %s" % (link.port, machine, version)))
        copied, kept = copy(link, wanted, say)
        hello, test = self_test(link, say)
        say(plain(verdict_line(hello, test)))
        if test.get("ok"):
            say("next: sixflip calibrate")
    if args.json:
        print(json.dumps({
            "format": 1, "kind": "sixflip provision", "port": link.port, "machine": machine,
            "micropython": version, "files_copied": copied, "files_there": kept,
            "hello": hello, "selftest": test}))
    return 0 if test.get("ok") else 1
