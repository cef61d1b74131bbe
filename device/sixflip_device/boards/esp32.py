"""ESP32 boards: I2C(0) on GPIO 22/21, LED on GPIO 2, the BOOT button on GPIO 0."""

import machine

from .machine_board import MachineBoard, choose

USUAL_SPI = {"bus": 2, "sck": 18, "mosi": 23, "miso": 19, "cs": 5}


def make(settings):
    """The Board, on its usual pins where the settings name no others."""
    bus = choose(settings, "i2c", 0)
    scl = choose(settings, "scl", 22)
    sda = choose(settings, "sda", 21)
    freq = settings["freq"]

    def make_i2c():
        return machine.I2C(bus, scl=machine.Pin(scl), sda=machine.Pin(sda), freq=freq)

    if settings["spi"] is not None:
        from .spi_bus import machine_spi
        make_i2c = machine_spi(settings["spi"], USUAL_SPI)
        scl = sda = None
    # BOOT held during a reset starts the loader, so it only counts once we are running
    return MachineBoard("esp32", make_i2c, scl, sda, led=choose(settings, "led", 2),
                        button=choose(settings, "button", 0))
