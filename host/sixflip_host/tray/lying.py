"""On which face the jig lies, and how a board sits in it, by what the board says."""

from dataclasses import replace

from ..board.event_words import ROUND
from . import jig
from .tray_value import put, say


def lying(now_tray, member, own):
    """The face on which the jig lies when a board says that it lies on its face own.

    As that board sits in the jig, if that is what was asked for; else what most boards say; else
    what was asked for, or the next face that agrees with what is known of the board.
    """
    known = member.mounting.get(own, "")
    up = now_tray.up()
    if known and known in (now_tray.face, up) or known and not up:
        return known
    if known:
        return up
    return next(face for face in (up, now_tray.face, *ROUND)
                if face and jig.fits(member.mounting, own, face))


def sits(now_tray, member, own, face):
    """So a board sits in the jig: with its face own up when the jig's face is."""
    if member.mounting.get(own, face) != face:
        now_tray = say(now_tray, "%s does not turn with the others: is it loose in the jig?"
                       % member.name)
    return put(now_tray, replace(member, mounting=jig.learned(member.mounting, own, face)))
