"""Imports the solve, compiled as provision sends it, and solves from twelve pose means.

run(heap): in so many bytes of heap, all that the interpreter and this module hold among them.
Prints the largest error of P's diagonal, the rounds, and the bytes in use at the end.
"""

import gc

import vfs
from disk import Disk

M = (1.02, 0.98, 1.01)
TILT = 0.035


def means():
    out = []
    for code in range(1, 13):
        face = (code - 1) // 2
        k = (2, 2, 0, 0, 1, 1)[face]
        v = [0.0, 0.0, 0.0]
        v[k] = (1 - 2 * (face % 2)) * (1 - TILT * TILT) ** 0.5
        v[(k + 1) % 3] = TILT if code % 2 else -TILT
        out.append([M[i] * v[i] + 0.1 for i in range(3)])
    return out


def run(heap):
    import sys

    import provisioned
    vfs.mount(Disk(provisioned.FILES), "/")
    sys.path[:] = ["", ".frozen"]
    gc.collect()
    ballast = gc.mem_alloc() + gc.mem_free() - heap
    weight = bytearray(ballast)  # a smaller heap
    from sixflip.accelerometer import six_faces
    assert six_faces.__file__ == "sixflip/accelerometer/six_faces.mpy", six_faces.__file__
    P, _, rounds = six_faces.solve(list(range(1, 13)), means(), "tilt solved")
    error = max([abs(P[k][k] * M[k] - 1) for k in range(3)])
    gc.collect()
    print(error, rounds, gc.mem_alloc() - len(weight))
