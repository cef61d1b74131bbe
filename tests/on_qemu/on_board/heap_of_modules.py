"""How much heap each module of the firmware takes, as the board loads it compiled."""

import gc
import sys

import vfs
from disk import Disk


def run(modules):
    """modules: [(name, [those it imports])]. Prints a line each: name, bytes of its own."""
    import provisioned
    vfs.mount(Disk(provisioned.FILES), "/")
    sys.path[:] = ["", ".frozen"]
    for name, needed in modules:
        for loaded in list(sys.modules):
            if loaded.split(".")[0] in ("sixflip", "sixflip_device"):
                del sys.modules[loaded]
        for other in needed:
            __import__(other)
        gc.collect()
        before = gc.mem_alloc()
        __import__(name)
        gc.collect()
        print(name, gc.mem_alloc() - before)
