"""Raspberry Pi Pico and Pico W (rp2): I2C0 on GP4/GP5, the LED on the board."""

import machine

from .machine_board import MachineBoard, choose

USUAL_SPI = {"bus": 0, "sck": 18, "mosi": 19, "miso": 16, "cs": 17}


def make(settings):
    """The Board, on its usual pins where the settings name no others."""
    bus = choose(settings, "i2c", 0)
    scl = choose(settings, "scl", 5)
    sda = choose(settings, "sda", 4)
    freq = settings["freq"]

    def make_i2c():
        return machine.I2C(bus, scl=machine.Pin(scl), sda=machine.Pin(sda), freq=freq)

    if settings["spi"] is not None:
        from .spi_bus import machine_spi
        make_i2c = machine_spi(settings["spi"], USUAL_SPI)
        scl = sda = None
    # "LED" is GP25 on a Pico and a pin of the radio chip on a Pico W
    return MachineBoard("pico", make_i2c, scl, sda, led=choose(settings, "led", "LED"),
                        button=settings["button"])
