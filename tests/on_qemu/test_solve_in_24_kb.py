"""Importing the solve and solving from pose means in 24 KB of a 32-bit heap."""

HEAP = 24 * 1024


def test_importing_and_solving_from_pose_means(board):
    error, rounds, used = board.exec("import solve_from_means\nsolve_from_means.run(%d)"
                                     % HEAP).split()
    print("\nsolved from pose means: %s bytes in use of %d at the end" % (used, HEAP))
    assert float(error) < 1e-5
    assert 3 <= int(rounds) < 20
