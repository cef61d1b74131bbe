"""The session's own tests on the emulated board: the longest of them all."""

from .shared_tests import pass_on_the_board


def test_the_sessions_tests_pass_on_the_board(board):
    pass_on_the_board(board, "test_session")
