"""A session that goes on after another one: the placements of both are solved together."""

from sixflip.placement_log import empty_move


def resume(session, placements, samples):
    """Put the placements of a session of so many samples in force; of the moves to them, and
    to the one that comes next, nothing is known: they lack samples.
    """
    log = session._log
    for placement in placements:
        _lost(log, placement.first)
        log.accept(placement)
    _lost(log, samples)
    session.samples = samples
    session._away = True


def _lost(log, first):
    log.open = empty_move(first)
    log.open.drops = 1
