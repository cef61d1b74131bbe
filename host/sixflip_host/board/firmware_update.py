"""A board's files brought up to date, as a whole or not at all."""

import contextlib
import hashlib
import json

from sixflip.chips import catalogue
from sixflip_sim import worlds

from ..errors import NoBoard, SixflipError
from ..terminal import plain
from .board_answers import NoSpace
from .board_events import events, unusable
from .board_files import board_files
from .board_settings import SETTINGS, merged_settings, settings_line
from .byte_progress import Bytes
from .compiled_firmware import for_board
from .on_board_scripts import STAGED, UPDATE

NO_SENSOR = "no usable sensor"


def copy(link, wanted, say=print):
    """Bring the board's files up to date; returns (number copied, number already there).

    On a board that starts a firmware all new files are copied into a folder of their own first
    and take their places together: pulled out at any time it starts the old one or the new one.
    What an earlier firmware had and this one has not goes with the old one.
    """
    files, reason = firmware_for(link)
    if reason:
        say("the firmware goes there as source: " + plain(reason))
    asked = [*files, SETTINGS]
    present = link.files(asked)
    if UPDATE in present:  # cut off, and not powered up since
        link.finish()
        present = link.files(asked)
    files[SETTINGS] = merged_settings(link, present, wanted)
    for name in other_drivers(json.loads(files[SETTINGS]).get("sensor", "auto"), files):
        del files[name]
    say(plain(settings_line(files[SETTINGS], wanted)))
    hashes = {name: hashlib.sha256(data).hexdigest() for name, data in files.items()}
    changed = [name for name in files if present.get(name, (0, ""))[1] != hashes[name]]
    changed.sort(key=lambda name: name == "main.py")  # a half-copied board never starts it
    starts = "main.py" in present
    ready = [name for name in changed
             if starts and present.get(STAGED + name, (0, ""))[1] == hashes[name]]
    # What a cable pulled out in mid-copy left behind.
    for name in present:
        if name.startswith(STAGED) and name[len(STAGED):] not in ready or \
                name.endswith(".new") and of_the_firmware(name[:-4]):
            link.remove(name)
    stale = [name for name in present if name not in files and of_the_firmware(name)]
    if not starts:
        remove(link, stale)     # MicroPython would import NAME.py before NAME.mpy
        stale = []
    todo = [name for name in changed if name not in ready]
    with Bytes("copying", sum(len(files[name]) for name in todo)) as bar:
        try:
            send(link, link.stage if starts else link.put, files, todo, bar)
            if starts and (changed or stale):
                link.commit(changed, stale)
        except NoSpace:
            if not starts:
                raise
            say("no room for the old firmware and the new one: without one until this is done")
            remove(link, ["main.py", *[STAGED + name for name in changed], *stale])
            todo = [name for name in changed if name != "main.py"] + ["main.py"]
            bar.at(0)
            send(link, link.put, files, todo, bar)
    say("%d files copied, %d already there" % (len(todo), len(files) - len(todo)))
    return len(todo), len(files) - len(todo)


def of_the_firmware(name):
    """Whether it is a module in one of the firmware's two folders, of this version or another."""
    return name.startswith(("sixflip/", "sixflip_device/")) and name.endswith((".py", ".mpy"))


def other_drivers(sensor, files):
    """Names of the drivers that a board does not need whose settings name its sensor."""
    modules = {row[0]: row[1].split(".")[0] for row in catalogue.CHIPS if row[1]}
    if sensor not in modules:       # auto: whichever answers
        return []
    own = {modules[name] for name in (*worlds.parts_of(sensor), sensor)}
    return [name for name in files
            if name.startswith("sixflip/chips/")
            and name[len("sixflip/chips/"):].split(".")[0] in set(modules.values()) - own]


def firmware_for(link):
    """({name: bytes} of the firmware as this board takes it, None or why that is source)."""
    sources = {name: path.read_bytes() for name, path in board_files().items()}
    return for_board(sources, link.mpy())


def remove(link, names):
    """Removes files of a board that it may not have."""
    for name in names:
        with contextlib.suppress(SixflipError, OSError):
            link.remove(name)


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
