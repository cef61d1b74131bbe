"""pyboard and other STM32 boards: I2C(1) on X9/X10, the blue LED, the USR switch.

The bus number fixes the pins here: machine.I2C(1) takes no scl= and sda= (a ValueError),
so those two settings only name the pins that bus recovery drives by hand.
"""

import machine

from .machine_board import MachineBoard, choose

USUAL_SPI = {"bus": 1, "cs": "X5"}     # SCK X6, MISO X7, MOSI X8


def make(settings):
    """The Board, on its usual pins where the settings name no others."""
    bus = choose(settings, "i2c", 1)
    freq = settings["freq"]

    def make_i2c():
        return machine.I2C(bus, freq=freq)

    scl, sda = choose(settings, "scl", "X9"), choose(settings, "sda", "X10")
    if settings["spi"] is not None:
        from .spi_bus import machine_spi
        make_i2c = machine_spi(settings["spi"], USUAL_SPI, True)
        scl = sda = None
    return MachineBoard("pyboard", make_i2c, scl, sda, led=choose(settings, "led", "LED_BLUE"),
                        button=choose(settings, "button", "SW"))
