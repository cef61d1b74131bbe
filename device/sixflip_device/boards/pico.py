"""Raspberry Pi Pico and Pico W (rp2): I2C0 on GP4/GP5, the LED on the board."""

from .machine_board import MachineBoard, choose, pinned_bus

USUAL_SPI = {"bus": 0, "sck": 18, "mosi": 19, "miso": 16, "cs": 17}


def make(settings):
    """The Board, on its usual pins where the settings name no others."""
    make_bus, scl, sda = pinned_bus(settings, (0, 5, 4), USUAL_SPI)
    # "LED" is GP25 on a Pico and a pin of the radio chip on a Pico W
    return MachineBoard("pico", make_bus, scl, sda, led=choose(settings, "led", "LED"),
                        button=settings["button"])
