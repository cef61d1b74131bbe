"""The shared core on real single-precision floats, 31-bit ints and a 140 KB heap."""

import ast
from pathlib import Path

import numpy as np
import pytest

from sixflip import accelerometer
from sixflip.placement import Placement
from sixflip_host.solving import reference

from .firmware import frozen_files

SHARED_TESTS = sorted(Path(n).stem for n in frozen_files() if n.startswith("test_"))

RUN = """
import gc, unittest
module = __import__(%r)
print('%%d passed, %%d failed, %%d skipped' %% tuple(unittest.run_module(module)))
"""


@pytest.mark.parametrize("name", SHARED_TESTS)
def test_shared_tests_pass_on_the_board(board, name):
    printed = board.exec(RUN % name)
    last = printed.strip().splitlines()[-1]
    passed, failed, _ = (int(part.split()[0]) for part in last.split(", "))
    assert failed == 0 and passed > 0, printed


def session_sums(seed, tilt_deg, lsb=16384, n=400):
    """Twelve placements of a sensor with errors on a tilted table: exact integer sums."""
    rng = np.random.default_rng(seed)
    A = np.eye(3) + rng.normal(0, 0.02, (3, 3))
    bias = rng.normal(0, 0.05, 3)
    placements = []
    for face in range(6):
        axis, sign = (2, 2, 0, 0, 1, 1)[face], (1, -1)[face % 2]
        yaw = rng.uniform(0, 2 * np.pi)
        for letter in range(2):
            t = np.radians(tilt_deg)
            truth = np.zeros(3)
            truth[axis] = sign * np.cos(t)
            turn = yaw + np.pi * letter
            truth[(axis + 1) % 3] = np.sin(t) * np.cos(turn)
            truth[(axis + 2) % 3] = np.sin(t) * np.sin(turn)
            counts = np.rint((A @ truth + bias + rng.normal(0, 0.004, (n, 3))) * lsb)
            sums = [int(x) for x in counts.sum(axis=0)] + [0] * 4
            noise = [float(x) for x in counts.std(axis=0)] + [0.0] * 3
            placements.append((1 + 2 * face + letter, 0, n, sums, noise, n * 10000))
    return placements


SOLVE = """
import gc, struct
from sixflip import accelerometer
from sixflip.placement import Placement
gc.collect(); before = gc.mem_alloc()
r = accelerometer.solve([Placement(*p) for p in %r], %r)
print([struct.unpack('<I', struct.pack('<f', x))[0] for row in r.P for x in row[:3]])
"""


def solved_on_board(board, placements, lsb):
    """The board's P, its float32 values exactly."""
    bits = ast.literal_eval(board.exec(SOLVE % (placements, lsb)).strip().splitlines()[-1])
    return np.array(bits, dtype=np.uint32).view(np.float32).astype(float).reshape(4, 3)


def vector_error_mg(P, Q, g=9.80665):
    """Largest difference of two corrections over the sphere of 1 g, in mg (upper bound)."""
    d = P - Q
    return (np.linalg.norm(d[:3], 2) * g + np.linalg.norm(d[3])) / g * 1000


@pytest.mark.parametrize("seed,tilt_deg,lsb", [(1, 0, 16384), (2, 2, 16384), (3, 5, 256)])
def test_the_boards_solution_is_numpys_within_a_hundredth_of_a_mg(board, seed, tilt_deg, lsb):
    placements = session_sums(seed, tilt_deg, lsb)
    P = solved_on_board(board, placements, lsb)
    wanted = reference.solve([Placement(*p) for p in placements], lsb, accelerometer.G)
    error = vector_error_mg(P, wanted.P[:, :3])
    print("single precision against double: %.5f mg" % error)
    assert error < 0.01
