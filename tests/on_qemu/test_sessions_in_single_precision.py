"""The session's own tests on the emulated board: the longest of all."""

import pytest

from .shared_tests import OF_SESSIONS, pass_on_the_board


@pytest.mark.long
@pytest.mark.parametrize("name", OF_SESSIONS)
def test_the_sessions_tests_pass_on_the_board(board, name):
    pass_on_the_board(board, name)
