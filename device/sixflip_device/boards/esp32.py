"""ESP32 boards: I2C(0) on GPIO 22/21, LED on GPIO 2, the BOOT button on GPIO 0."""

from .machine_board import MachineBoard, choose, pinned_bus

USUAL_SPI = {"bus": 2, "sck": 18, "mosi": 23, "miso": 19, "cs": 5}


def make(settings):
    """The Board, on its usual pins where the settings name no others."""
    make_bus, scl, sda = pinned_bus(settings, (0, 22, 21), USUAL_SPI)
    # BOOT held during a reset starts the loader, so it only counts once we are running
    return MachineBoard("esp32", make_bus, scl, sda, led=choose(settings, "led", 2),
                        button=choose(settings, "button", 0))
