"""The shared core on real single-precision floats, 31-bit ints and a 140 KB heap."""

import ast

import numpy as np
import pytest

from sixflip.accelerometer import solver as accelerometer
from sixflip.poses.placement import Placement
from sixflip_host.calibrate import reference

from .shared_tests import SHARED_TESTS, pass_on_the_board
from .simulated_sums import session_sums, vector_error_mg


@pytest.mark.long
@pytest.mark.parametrize("name", SHARED_TESTS)
def test_shared_tests_pass_on_the_board(board, name):
    pass_on_the_board(board, name)


SOLVE = """
import gc, struct
from sixflip.accelerometer import solver as accelerometer
from sixflip.poses.placement import Placement
gc.collect(); before = gc.mem_alloc()
r = accelerometer.solve([Placement(*p) for p in %r], %r)
print([struct.unpack('<I', struct.pack('<f', x))[0] for row in r.P for x in row[:3]])
"""


def solved_on_board(board, placements, lsb):
    """The board's P, its float32 values exactly."""
    bits = ast.literal_eval(board.exec(SOLVE % (placements, lsb)).strip().splitlines()[-1])
    return np.array(bits, dtype=np.uint32).view(np.float32).astype(float).reshape(4, 3)


@pytest.mark.parametrize("seed,tilt_deg,lsb", [(1, 0, 16384), (2, 2, 16384), (3, 5, 256)])
def test_the_boards_solution_is_numpys_within_a_hundredth_of_a_mg(board, seed, tilt_deg, lsb):
    placements = session_sums(seed, tilt_deg, lsb)
    P = solved_on_board(board, placements, lsb)
    wanted = reference.solve([Placement(*p) for p in placements], lsb, accelerometer.G)
    error = vector_error_mg(P, wanted.P[:, :3])
    print("single precision against double: %.5f mg" % error)
    assert error < 0.01
