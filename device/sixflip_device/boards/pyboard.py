"""pyboard and other STM32 boards: I2C(1) on X9/X10, the blue LED, the USR switch.

The bus number fixes the pins here: machine.I2C(1) takes no scl= and sda= (a ValueError),
so those two settings only name the pins that bus recovery drives by hand.
"""

import machine

from .machine_board import MachineBoard, choose


def make(settings):
    bus = choose(settings, "i2c", 1)
    freq = settings["freq"]

    def make_i2c():
        return machine.I2C(bus, freq=freq)

    return MachineBoard("pyboard", make_i2c, choose(settings, "scl", "X9"),
                        choose(settings, "sda", "X10"), led=choose(settings, "led", "LED_BLUE"),
                        button=choose(settings, "button", "SW"))
