"""The board's machine module: one simulated I2C bus, pins, resets. boot.py sets the world."""

import raw_repl

world = None
_id = b"\x00" * 8
_wiring = {}
_levels = {}

PWRON_RESET, HARD_RESET, WDT_RESET, DEEPSLEEP_RESET, SOFT_RESET = 1, 2, 3, 4, 5
cause = PWRON_RESET


def start(a_world, board_id, wiring):
    global world, _id, _wiring, SimulatedSPI
    from sixflip_sim.spi import SimulatedSPI  # later its modules are out of reach
    world = a_world
    _id = board_id
    _wiring = wiring


def unique_id():
    return _id


def freq(hz=None):
    return 125000000


def reset_cause():
    return cause


def reset():
    raise raw_repl.Restart(raw_repl.HARD_RESET)


def soft_reset():
    raise raw_repl.Restart(raw_repl.SOFT_RESET)


def disable_irq():
    return 0


def enable_irq(state):
    pass


def idle():
    world.clock.sleep_us(100)


def I2C(*identity, **options):
    """The one bus of the world, whatever its number and pins.

    On an STM32 the pins belong to the bus: naming them is a ValueError, as there.
    """
    if world.spec["flavour"] == "stm32" and ("scl" in options or "sda" in options):
        raise ValueError("extra keyword arguments given")
    return world.i2c


SoftI2C = I2C


def SPI(*identity, **options):
    """The world's chip on SPI; the pin "cs_pin" of the wiring selects it."""
    world.spi = SimulatedSPI(world.i2c, options["polarity"] << 1 | options["phase"])
    return world.spi


# Pyboard v1.1 (ports/stm32/boards/PYBV11/pins.csv), as far as boards are wired to them.
STM32_NAMES = (["X%d" % i for i in range(1, 23)] + ["Y%d" % i for i in range(1, 13)]
               + ["SW", "LED_RED", "LED_GREEN", "LED_YELLOW", "LED_BLUE"])
ESP32_MISSING = (20, 24, 28, 29, 30, 31)


def _check_pin(identity, pull):
    """What the ports of MicroPython 1.25 refuse: their machine_pin.c, STM32's pin.c."""
    flavour = world.spec["flavour"]
    number = isinstance(identity, int)
    if flavour == "stm32":
        if number:
            raise TypeError("can't convert 'int' object to str implicitly")
        if identity not in STM32_NAMES:
            raise ValueError("Pin(%s) doesn't exist" % identity)
        if pull not in (None, 0, 1, 2):
            raise ValueError("invalid pin pull: %d" % pull)
    elif flavour == "esp32":
        if not number or not 0 <= identity < 40 or identity in ESP32_MISSING:
            raise ValueError("invalid pin")
    elif flavour == "rp2":
        if number and not 0 <= identity < 30 or not number and identity != "LED":
            raise ValueError("invalid pin")
        if identity == "LED" and pull is not None:  # a pin of the Pico W's radio chip
            raise ValueError("pulls are not supported for external pins")


def _bus_pins():
    return _wiring.get("sda_pin", 4), _wiring.get("scl_pin", 5)


class Pin:
    IN, OUT, OPEN_DRAIN, ALT = 0, 1, 2, 3
    PULL_UP, PULL_DOWN = 1, 2

    def __init__(self, identity, mode=-1, pull=None, value=None):
        _check_pin(identity, pull)
        self.identity = identity
        self.mode = mode
        self.pull = pull
        if value is not None:
            self.value(value)
        elif pull == Pin.PULL_UP:
            _levels.setdefault(identity, 1)

    def init(self, mode=-1, pull=None, value=None):
        self.__init__(self.identity, mode, pull, value)

    def value(self, level=None):
        """Read or set. Pins of the bus are driven through to it, a held button reads 0."""
        if level is None:
            if self.identity == _wiring.get("button_pin") and _wiring.get("button_held"):
                return 0
            if self.mode == Pin.IN and self.identity in _bus_pins():
                return self._line()
            return _levels.get(self.identity, 0)
        self._drive(level)
        return None

    def _line(self):
        """A line of the bus at rest, by the wiring's "lines": sda low, scl low, no pull-ups."""
        state = _wiring.get("lines", "")
        if state == "no pull-ups":
            return 1 if self.pull == Pin.PULL_UP else 0
        return 0 if state == ("sda low", "scl low")[_bus_pins().index(self.identity)] else 1

    def _drive(self, level):
        before = _levels.get(self.identity, 1)
        _levels[self.identity] = 1 if level else 0
        if self.identity == _wiring.get("cs_pin", 17) and hasattr(world, "spi"):
            world.spi.select(level)
        if self.identity == _wiring.get("scl_pin", 5) and not before and level:
            world.i2c.pulse_scl()

    __call__ = value

    def on(self):
        self.value(1)

    def off(self):
        self.value(0)

    high = on
    low = off

    def toggle(self):
        self.value(1 - self.value())


class LED(Pin):
    pass


class WDT:
    def __init__(self, identity=0, timeout=5000):
        self.timeout = timeout

    def feed(self):
        pass
