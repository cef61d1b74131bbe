"""What is known of a tray of boards at one moment, as a value."""

from collections import Counter
from dataclasses import dataclass, replace

from ..guide.board_values import text
from ..guide.session_state import State
from .member import Member

LOG = 300


@dataclass(frozen=True)
class Tray:
    """members   in the order of their numbers
    face, letter  the jig's face that is to be up, "" before the first, and "a" for its first
                 placement, "b" after half a turn
    here         {port: its own face} of the boards that took something on this face since
    said         {port: how often it said on this face that it has it whole}
    flips        ports of the boards that the half turn is for
    first_at     second at which the first of them took this placement, None before
    visits       {face: how often the person was led to it}; last: the face before;
                 redone: how often a person took a face back
    reference    port of the board whose axes are the jig's
    now, since   seconds of the caller's clock: last event, first board's session
    patience     every wait is so many times longer, see board_link
    log          lasting lines, oldest first
    """

    members: tuple
    face: str = ""
    letter: str = "a"
    here: dict = None
    said: dict = None
    flips: tuple = ()
    first_at: float = None
    visits: dict = None
    last: str = ""
    redone: int = 0
    reference: str = ""
    now: float = 0.0
    since: float = None
    patience: float = 1.0
    log: tuple = ()

    @property
    def running(self):
        return [member for member in self.members if member.running]

    @property
    def over(self):
        return all(member.over for member in self.members)

    def member(self, port):
        return next(member for member in self.members if member.port == port)

    def awaited(self):
        """The boards that this placement is for: those that lack it and can still take it."""
        if not self.face:
            return []
        if self.letter == "a":
            return [member for member in self.running if not member.placements(self.face)]
        return [member for member in self.running
                if member.port in self.flips and member.placements(self.face) == 1]

    def up(self):
        """The jig's face that is up, by most of its boards; "" where nobody knows. One that has
        been silent while another spoke, as while its USB port comes back, may have been turned
        since."""
        spoken = max((member.state.now for member in self.running), default=0.0)
        votes = Counter(member.jig_up() for member in self.running
                        if not member.silent_s(spoken))
        votes.pop("", None)
        most = max(votes.values(), default=0)
        best = [face for face in votes if votes[face] == most]
        return self.face if self.face in best else best[0] if best else ""


def tray(boards, patience=1.0):
    """The Tray of boards, {port: id or None}, numbered from 1; nothing is heard of them yet."""
    return Tray(tuple(Member(port, number, State(board=text(boards[port], 40)))
                      for number, port in enumerate(boards, 1)),
                here={}, said={}, visits={}, patience=patience)


def put(now_tray, member):
    """The Tray with a Member in its place."""
    return replace(now_tray, members=tuple(
        member if before.port == member.port else before for before in now_tray.members))


def say(now_tray, line):
    """The Tray with one more lasting line."""
    return replace(now_tray, log=(now_tray.log + (line,))[-LOG:])
