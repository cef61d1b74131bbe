"""The process in which the emulated Pico runs; started by emulated_pico.

python -m sixflip_host.emulated.pico_process CONFIG.json

Prints one line of JSON when the port is there and one as the answer to every line of JSON on
its standard input: {"power_cycle": world or null}, {"cut_after": n}, {} (how it stands). The
end of the input is the end of the board; then the flash is kept in its image file. A line
{"failed": why} is the last one of a board that does not start.
"""

import asyncio
import dataclasses
import json
import os
import sys
from pathlib import Path

from rp2040py.boards import BOARDS
from rp2040py.cli.pty_repl import PtyInteractiveRepl
from rp2040py.device import MicroPythonDevice
from rp2040py.device.base_device import ResetCause

from sixflip_sim import worlds

from .flash_chip import FLASH_BYTES, fit
from .i2c_device import ChipsOnI2C

BOOT_S = 60


class EmulatedPico(MicroPythonDevice):
    """A Pico with a simulated world on its I2C bus.

    Every reset of the board begins that world anew, as on the virtual board: the box lies
    again where it lay, and the chips lose their supply.
    """

    def __init__(self, uf2, world):
        super().__init__(board=dataclasses.replace(BOARDS["pico"], image=uf2))
        self.world = world
        self.chips = ChipsOnI2C(worlds.make(world))
        self.chips.attach(self.mcu)
        self.flash = fit(self.mcu, self.power_cut)
        self.boots = 1
        self.cuts = 0

    def hard_reset(self, *, cause=ResetCause.RUN_PIN):
        super().hard_reset(cause=cause)
        self.chips.power_up(worlds.make(self.world))
        self.boots += 1

    def power_cut(self):
        self.cuts += 1
        self.hard_reset(cause=ResetCause.POWER_ON)

    def state(self):
        return {"boots": self.boots, "cuts": self.cuts, "emulated_us": self.chips.now_us(),
                "transactions": self.chips.transactions, "refused": self.chips.refused,
                "flash_operations": self.flash.operations}

    def obey(self, command):
        if "cut_after" in command:
            self.flash.cut_after = command["cut_after"]
        if "power_cycle" in command:
            if command["power_cycle"] is not None:
                self.world = command["power_cycle"]
            self.hard_reset(cause=ResetCause.POWER_ON)
        return self.state()


def say(answer):
    print(json.dumps(answer), flush=True)


async def run(config):
    image = Path(config["image"])
    pico = EmulatedPico(config["uf2"], config["world"])
    if image.exists():
        pico.mcu.flash[:FLASH_BYTES] = image.read_bytes()
    ended = asyncio.Event()
    port = PtyInteractiveRepl(pico.cdc, pico.simulator, on_quit=lambda code: ended.set())
    await port.start()
    commands = b""

    def heard():
        nonlocal commands
        data = os.read(0, 65536)
        if not data:
            ended.set()
        lines = (commands + data).split(b"\n")
        commands = lines.pop()
        for line in lines:
            say(pico.obey(json.loads(line)))

    asyncio.get_running_loop().add_reader(0, heard)
    await pico.astart(BOOT_S)
    say({"port": port.slave_path})
    await pico.simulator.wait_for(ended, None)
    pico.stop()
    await port.stop()
    image.write_bytes(pico.mcu.flash[:FLASH_BYTES])


def main(path):
    try:
        asyncio.run(run(json.loads(Path(path).read_text())))
    except (ValueError, TimeoutError, OSError) as error:  # no image, or one that does not start
        say({"failed": str(error)})
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
