"""A board with MicroPython's machine module: pins, I2C, stdin as the host's line."""

import os
import select
import sys

import machine

from .board import Board, LineReader

HALF_CLOCK_US = 5  # 100 kHz, slow enough for any chip on the bus


class MachineBoard(Board):
    """make_i2c() -> a new machine.I2C; scl, sda, led, button: pin numbers, names or None.

    The button is wired from the pin to ground
    unless pressed=1 says that pressing gives a high level.
    """

    def __init__(self, name, make_i2c, scl, sda, led=None, button=None, led_on=1, pressed=0):
        self.name = name
        self._make_i2c = make_i2c
        self._scl = scl
        self._sda = sda
        pull = machine.Pin.PULL_DOWN if pressed else machine.Pin.PULL_UP
        self._led = _pin(led, machine.Pin.OUT)
        self._led_on = led_on
        self._button = _pin(button, machine.Pin.IN, pull)
        self._pressed = pressed
        cwd = os.getcwd()  # "/" on most boards, "/flash" on STM32
        self.root = cwd if cwd.endswith("/") else cwd + "/"
        self.unique_id = "".join(["%02x" % b for b in machine.unique_id()])
        self._poll = select.poll()
        self._poll.register(sys.stdin, select.POLLIN)
        self._reader = LineReader()
        try:
            self.i2c = make_i2c()
        except ValueError as e:  # another chip of the family, which lacks these pins
            raise ValueError("no bus with scl %s, sda %s (%s): set them in sixflip.json"
                             % (scl, sda, e))
        if _pin(scl) is None or _pin(sda) is None:
            self.scl_pulse = None  # an STM32 board with other names for its pins

    def reopen_i2c(self):
        """A new machine.I2C on the same pins."""
        # pins that were driven by hand have lost their I2C function
        self.i2c = self._make_i2c()
        return self.i2c

    def _open_drain(self, pin):
        return machine.Pin(pin, machine.Pin.OPEN_DRAIN, value=1)

    def scl_pulse(self):
        """One clock pulse with SDA released: lets a chip shift out what it still holds."""
        scl = self._open_drain(self._scl)
        self._open_drain(self._sda)
        scl.value(0)
        self.sleep_us(HALF_CLOCK_US)
        scl.value(1)
        self.sleep_us(HALF_CLOCK_US)

    def stop_condition(self):
        """SDA rises while SCL is high: every chip on the bus goes back to waiting."""
        scl = self._open_drain(self._scl)
        sda = self._open_drain(self._sda)
        scl.value(0)
        sda.value(0)
        self.sleep_us(HALF_CLOCK_US)
        scl.value(1)
        self.sleep_us(HALF_CLOCK_US)
        sda.value(1)
        self.sleep_us(HALF_CLOCK_US)

    def led(self, on):
        """Switches the LED, whichever level lights it."""
        if self._led is not None:
            self._led.value(self._led_on if on else 1 - self._led_on)

    def button(self):
        """Whether the level of the pin is that of a pressed button."""
        return self._button is not None and self._button.value() == self._pressed

    def read_line(self):
        """A whole line from stdin, or None where what has arrived ends none."""
        while self._poll.poll(0):
            ch = sys.stdin.read(1)
            if not ch:
                return None
            line = self._reader.feed(ch)
            if line is not None:
                return line
        return None

    def reset(self):
        """A reset of the processor; does not return."""
        machine.reset()


def _pin(identity, mode=None, pull=None):
    """The pin, or None: boards of one family differ in which of them have an LED.

    No pull is None: STM32 and the LED of a Pico W refuse -1.
    """
    if identity is None:
        return None
    try:
        return machine.Pin(identity) if mode is None else machine.Pin(identity, mode, pull)
    except (ValueError, TypeError):  # STM32: a number is a TypeError
        return None


def choose(settings, name, default):
    """The setting, or the board's own default where it is not given."""
    value = settings[name]
    return default if value is None else value


def pinned_bus(settings, usual_i2c, usual_spi):
    """(make, scl, sda): make() -> a new bus on the settings' pins; on SPI there is no scl and sda.

    usual_i2c   (number of the bus, scl, sda) where the settings name no others
    usual_spi   the same of SPI, {key: value}
    """
    if settings["spi"] is not None:
        from .spi_bus import machine_spi
        return machine_spi(settings["spi"], usual_spi), None, None
    bus, scl, sda = [choose(settings, name, usual)
                     for name, usual in zip(("i2c", "scl", "sda"), usual_i2c)]

    def make():
        return machine.I2C(bus, scl=machine.Pin(scl), sda=machine.Pin(sda),
                           freq=settings["freq"])
    return make, scl, sda
