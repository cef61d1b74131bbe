"""First code of the virtual board's process: world, flash, terminal; then as a board boots.

micropython boot.py CONFIG.json, written by sixflip_host.virtual.virtual_board at every start.
"""

import gc
import json
import sys


def blank(path, size):
    """True when the image at path is not there; then an erased one of size bytes is made."""
    try:
        with open(path, "rb"):
            return False
    except OSError:
        with open(path, "wb") as file:
            for _ in range(size // 4096):
                file.write(b"\xff" * 4096)
        return True


def make_world(config):
    """The simulated world behind machine and time; none of its modules stays importable."""
    import time

    import machine

    from sixflip_sim import worlds

    world = worlds.make(config["world"])
    machine.start(world, bytes.fromhex(config["unique_id"]), config["wiring"])
    machine.cause = config["cause"]

    def move(line):
        world.operator.asked(world.clock.now_us(), **json.loads(line))

    time.start(world.clock, config["speed"], open(config["asked"], "rb"),  # noqa: SIM115
               open(config["hand"], "rb"), move)  # noqa: SIM115
    # The firmware has to bring its own copy of sixflip: the chips' tables of the simulated
    # world are not on the board's flash.
    for name in list(sys.modules):
        if name.split(".")[0] in ("sixflip", "sixflip_sim"):
            del sys.modules[name]


def mount_flash(config):
    import time

    import vfs
    from flash import FlashImage

    new = blank(config["image"], config["flash_bytes"])
    file = open(config["image"], "r+b")  # noqa: SIM115  open for as long as the board runs
    blocks = file.seek(0, 2) // 4096  # one made earlier keeps its size
    device = FlashImage(file, blocks, wait_us=time.clock.sleep_us, times=config["flash_times"])
    if new:
        vfs.VfsLfs2.mkfs(device)
    device.cut_after = config["cut_after"]
    vfs.umount("/")
    vfs.mount(vfs.VfsLfs2(device), "/")


def boot(config):
    import os

    import raw_repl

    sys.path[:] = config["path"]
    make_world(config)
    mount_flash(config)
    os.chdir("/")
    sys.path[:] = ["", ".frozen", "/lib"]
    sys.argv[:] = []
    repl = raw_repl.Repl(raw_repl.Terminal(config["terminal"]), config["raw"])
    gc.collect()
    try:
        repl.terminal.mode("repl")
        repl.run_file("boot.py")
        if not config["raw"]:
            repl.run_file("main.py")
        repl.loop()
    except raw_repl.Restart as restart:
        return restart.args[0]


with open(sys.argv[1]) as config_file:
    config = json.load(config_file)
sys.path[:] = config["path"]
sys.exit(boot(config))
