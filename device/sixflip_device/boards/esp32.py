"""ESP32 boards: I2C(0) on GPIO 22/21, LED on GPIO 2, the BOOT button on GPIO 0."""

import machine

from .machine_board import MachineBoard, choose


def make(settings):
    bus = choose(settings, "i2c", 0)
    scl = choose(settings, "scl", 22)
    sda = choose(settings, "sda", 21)
    freq = settings["freq"]

    def make_i2c():
        return machine.I2C(bus, scl=machine.Pin(scl), sda=machine.Pin(sda), freq=freq)

    # BOOT held during a reset starts the loader, so it only counts once we are running
    return MachineBoard("esp32", make_i2c, scl, sda, led=choose(settings, "led", 2),
                        button=choose(settings, "button", 0))
