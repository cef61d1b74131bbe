"""A board that has answered and waits takes no processor from the tests beside it."""

import os


def test_a_board_that_waits_is_stopped_and_answers_again(board):
    for number in (1, 2):
        assert board.exec("print(%d)" % number).strip() == str(number)
        _, status = os.waitpid(board.process.pid, os.WUNTRACED)
        assert os.WIFSTOPPED(status)
