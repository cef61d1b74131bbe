"""sixflip provision: the firmware onto a board, only what changed, then its self-test."""
import json

from sixflip.chips import catalogue
from sixflip_device import settings
from sixflip_device.boards.spi_bus import KEYS

from ..board import board_settings, firmware_update
from ..board.ports import add_port, open_link
from ..errors import UsageError
from ..terminal import plain

EXAMPLE = ("sixflip provision --sensor gy85 --pins sda=4,scl=5\n"
           "         sixflip provision --sensor lsm6dsox --range 8g,2000dps --rate 200")
BOARDS = ("pico", "esp32", "pyboard", "raspberry_pi")


def more():
    """The settings, at the end of --help."""
    return board_settings.help_table() + "\n\n"


def add_arguments(parser):
    add_port(parser)
    parser.add_argument("--sensor", choices=("auto", *catalogue.SENSORS), metavar="NAME",
                        help="auto: whichever of the known chips answers at power-up, which is "
                             "said (the default); or one of %s"
                             % " ".join(catalogue.SENSORS))
    parser.add_argument("--range", metavar="8g,2000dps",
                        help="full scales of accelerometer and gyro, one or both (default: 2 g "
                             "and 500 deg/s where the chip has them); a correction is for one "
                             "range only")
    parser.add_argument("--rate", metavar="HZ", type=int,
                        help="samples a second, %d to %d (default: %d)" % (
                            settings.KNOWN["rate_hz"][2:] + settings.KNOWN["rate_hz"][:1]))
    parser.add_argument("--board", choices=BOARDS, help="default: by the port of MicroPython")
    parser.add_argument("--pins", metavar="sda=4,scl=5",
                        help="pins that differ from the board's usual ones: sda, scl, led, button")
    parser.add_argument("--spi", metavar="sck=18,mosi=19,miso=16,cs=17",
                        help="the sensor is on SPI, on the board's usual pins where none are "
                             "named (--spi usual); also bus, mode (3 or 0) and freq (Hz); "
                             "--spi off: on I2C again")
    parser.add_argument("--json", action="store_true", help="what was done and tested, as JSON")


def pins(text):
    """{"sda": 4, "scl": 5} of "sda=4,scl=5"; names such as X9 stay text."""
    numbers = {}
    for part in text.split(","):
        name, equals, value = part.strip().partition("=")
        if name not in ("sda", "scl", "led", "button") or not equals or not value:
            raise UsageError("--pins %s: expected names of sda scl led button with a pin each, "
                             "such as sda=4,scl=5" % text)
        numbers[name] = int(value) if value.isdigit() else value
    return numbers


def spi_pins(text):
    """{"sck": 18, "cs": 17} of "sck=18,cs=17", {} of "usual", None of "off"."""
    if text == "off":
        return None
    pin_of = {}
    for part in text.split(",") if text != "usual" else ():
        name, equals, value = part.strip().partition("=")
        numbers = name in ("bus", "mode", "freq")
        if name not in KEYS or not value or numbers and not value.isdigit() \
                or name == "mode" and value not in ("0", "3"):
            raise UsageError("--spi %s: expected usual, off or some of %s with a pin or number "
                             "each, such as sck=18,cs=17; the chips take the modes 0 and 3"
                             % (text, " ".join(KEYS)))
        pin_of[name] = int(value) if value.isdigit() else value
    return pin_of


def wanted_settings(args):
    """What the command line says for sixflip.json."""
    wanted = pins(args.pins) if args.pins else {}
    wanted.update(board_settings.ranges(args.range) if args.range else {})
    if args.spi:
        wanted["spi"] = spi_pins(args.spi)
    if args.rate is not None:
        _, _, low, high = settings.KNOWN["rate_hz"]
        if not low <= args.rate <= high:
            raise UsageError("--rate %d: expected %d to %d" % (args.rate, low, high))
        wanted["rate_hz"] = args.rate
    for name in ("sensor", "board"):
        if getattr(args, name):
            wanted[name] = getattr(args, name)
    return wanted


def run(args):
    wanted = wanted_settings(args)
    notes = []
    if wanted.get("sensor", "auto") != "auto":
        wanted, notes = board_settings.what_the_chip_offers(wanted["sensor"], wanted)
    say = (lambda text: None) if args.json else print
    for note in notes:
        say(note)
    with open_link(args.port) as link:
        version, machine = link.version()
        say(plain("%s: %s, %s" % (link.port, machine, version)))
        copied, kept = firmware_update.copy(link, wanted, say)
        hello, test = firmware_update.self_test(link, say)
        for line in hello.get("report") or ():
            say(plain(line))
        say(plain(firmware_update.verdict_line(hello, test)))
        if test.get("ok"):
            say("next: sixflip calibrate")
    if args.json:
        print(json.dumps({
            "format": 1, "kind": "sixflip provision", "port": link.port, "machine": machine,
            "micropython": version, "files_copied": copied, "files_there": kept,
            "hello": hello, "selftest": test}))
    return 0 if test.get("ok") else 1
