"""A session that goes on after another one: the placements of both are solved together."""

from sixflip.placement_log import empty_move

PAUSE_US = 60000000  # between the two; how long it was nobody knows


def resume(session, placements, samples, moves=None):
    """Put the placements of a session of so many samples in force, and its moves.

    moves   to each of them and the one under way at its end (capture_moves.py); None: nothing
            is known of them
    """
    log = session._log
    for i, placement in enumerate(placements):
        log.open = moves[i] if moves else empty_move(placement.first)
        log.follow(False)  # the path is in the move, if it is known
        log.accept(placement)
    log.follow(False)
    log.open = moves[-1] if moves else empty_move(samples)
    log.open.largest_gap_us = PAUSE_US
    session.samples = samples
    session._away = True
