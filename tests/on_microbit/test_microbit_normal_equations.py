"""The normal equations, and the tilt solved with them, on a micro:bit with 9.5 KB of heap.

Nothing more of ours fits: the poses' sums come from the host, one pose at a time.
"""

import ast

import numpy as np
import pytest

from sixflip.poses.placement import Placement
from sixflip_host.calibrate import reference
from tests.on_qemu.simulated_sums import session_sums, vector_error_mg

from .pieces import SHARED, of_module, of_modules

SUMS = [(1, 0, 16384), (2, 2, 16384), (3, 5, 256)]  # seed, tilt in degrees, counts per g
SOLVER = ("accelerometer/normal_equations",)
COLLECT = "import gc\ngc.collect()"
FREE = COLLECT + "\nprint(gc.mem_free())"
BITS = """
import struct
print([struct.unpack('<I', struct.pack('<f', x))[0] for r in P for x in r])
"""
ROW = "m = [s / %d for s in %r]"


def send(board, names):
    """The modules, piece by piece; a collection between two, or what compiling left lies about."""
    send_pieces(board, of_modules(*names))


def send_pieces(board, pieces):
    for piece in pieces:
        board.exec(piece, COLLECT)


def free(board):
    return int(board.exec(FREE))


def solution(board):
    """The board's P, 4 x 3, its float32 values exactly."""
    bits = ast.literal_eval(board.exec(BITS))
    return np.array(bits, dtype=np.uint32).view(np.float32).astype(float).reshape(4, 3)


def test_the_interpreter_is_what_the_tier_is_for(microbit):
    printed = microbit.exec("import sys\nprint(sys.platform, 1.0 + 1e-7 == 1.0)", FREE).split()
    assert printed[:2] == ["microbit", "True"]
    assert int(printed[2]) < 10000


@pytest.mark.parametrize("seed,tilt_deg,lsb", SUMS)
def test_normal_equations_alone(microbit, seed, tilt_deg, lsb):
    """Level truth, as if the table were: the least squares and nothing else."""
    placements = [Placement(*p) for p in session_sums(seed, tilt_deg, lsb)]
    empty = free(microbit)
    send(microbit, SOLVER)
    with_solver = free(microbit)
    microbit.exec("n = NormalEquations(3)")
    rows, truth = [], []
    for p in placements:
        face = (p.pose - 1) // 2
        t = [0, 0, 0]
        t[(2, 2, 0, 0, 1, 1)[face]] = (1, -1)[face % 2]
        microbit.exec(ROW % (p.n * lsb, p.sums[:3]), "n.add(m + [1.0], %r)" % t)
        rows.append([s / (p.n * lsb) for s in p.sums[:3]] + [1.0])
        truth.append(t)
    before = free(microbit)
    least = int(microbit.exec("P = n.solve()\nprint(gc.mem_free())"))
    wanted = np.linalg.lstsq(np.array(rows), np.array(truth), rcond=None)[0]
    error = vector_error_mg(solution(microbit), wanted, g=1.0)
    print("micro:bit: %d bytes of heap, %d with the solver in, %d with the sums, %d when solved; "
          "%.5f mg from numpy" % (empty, with_solver, before, least, error))
    assert error < 0.01


PAIR = """
def pair(f, d, a, b):
    a = [s / d for s in a]
    b = [s / d for s in b]
    h = in_plane(corrected(P, a), corrected(P, b), f) if P else (None, None)
    n.add(a + [1.0], upright(f, h[0]))
    n.add(b + [1.0], upright(f, h[1]))
"""
SOLVE = """
Q = n.solve()
if P: print(max([abs(x - y) for p, q in zip(P, Q) for x, y in zip(p, q)]))
P = Q
Q = n = None
"""


@pytest.mark.parametrize("seed,tilt_deg,lsb", SUMS)
def test_flips_with_the_tilt_solved(microbit, seed, tilt_deg, lsb):
    """METHOD 1, level 2; the poses' sums are sent again in every round instead of kept."""
    placements = [Placement(*p) for p in session_sums(seed, tilt_deg, lsb)]
    send(microbit, SOLVER)
    send_pieces(microbit, of_module("poses/faces", "AXIS", "SIGN"))
    send_pieces(microbit, of_module("accelerometer/six_faces", "in_plane", "upright", "corrected"))
    microbit.exec(PAIR, "P = n = None")
    left = free(microbit)
    moved, rounds = 1.0, 0
    while moved > 1e-6 and rounds < 20:
        microbit.exec(COLLECT, "n = NormalEquations(3)")
        for a, b in zip(placements[::2], placements[1::2]):
            face = (a.pose - 1) // 2
            microbit.exec("pair(%d, %d, %r, %r)" % (face, a.n * lsb, a.sums[:3], b.sums[:3]),
                          COLLECT)
        moved = float(microbit.exec(SOLVE, COLLECT) or 1.0)
        rounds += 1
    wanted = reference.solve(placements, lsb, 1.0)
    error = vector_error_mg(solution(microbit), wanted.P[:, :3], g=1.0)
    print("micro:bit: %d bytes left with the tilt's solver in; %d rounds, %.5f mg from numpy"
          % (left, rounds, error))
    assert rounds < 20
    assert error < 0.01


def in_one(names):
    """The modules as one source, as they stand, but for the imports among them."""
    lines = "\n".join((SHARED / (name + ".py")).read_text() for name in names).splitlines()
    return "\n".join(line for line in lines if not line.startswith("from sixflip"))



UNIT_ROWS = """
n = NormalEquations(3)
for k in range(4): n.add([1.0 if i == k else 0.0 for i in range(4)], [0.0] * 3)
"""


def test_why_it_goes_over_in_pieces(microbit):
    """Not even the module of the normal equations compiles as one source in this heap. The
    whole solve (six_faces) does not even in pieces, or leaves less than its elimination takes.
    """
    with pytest.raises(RuntimeError, match="MemoryError"):
        microbit.exec(in_one(SOLVER))
    microbit.reset()
    send(microbit, SOLVER)
    microbit.exec(UNIT_ROWS)
    takes = free(microbit) - int(microbit.exec("P = n.solve()\nprint(gc.mem_free())"))
    microbit.reset()
    left = 0
    try:
        send(microbit, SOLVER)
        send_pieces(microbit, of_module("poses/faces", "AXIS", "SIGN", "LEANING", "face_of_code"))
        send(microbit, ("accelerometer/six_faces",))
        left = free(microbit)
    except RuntimeError as error:
        assert "MemoryError" in str(error)
    print("micro:bit: as one source MemoryError; in pieces six_faces and all it needs leave %d "
          "bytes, its elimination takes %d" % (left, takes))
    assert left < takes
