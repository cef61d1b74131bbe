"""One board of a tray as a value: its own session, how it sits in the jig, why it has left."""

from dataclasses import dataclass, field, replace

from ..guide.next_step import face_up
from ..guide.session_state import CALIBRATING, OVER, WAITING, State
from .jig import jig_to_own

SHORT = 8       # characters of an id on a screen
SILENT_S = 3    # a live state comes four times a second


@dataclass(frozen=True)
class Member:
    """port    by which it is known; number: as the person sees it, from 1
    state      its session, guide.session_state
    mounting   {its face: the jig's}, as far as it is known; see jig
    gone       the sentence with which it left the tray, "" while it is in it
    missed     faces in a row that it did not take, or not whole
    captures   captures that it began since the jig was brought to where it lies;
    patient    until this second of the caller's clock the others wait for the one under way
    """

    port: str
    number: int
    state: State = field(default_factory=State)
    mounting: dict = field(default_factory=dict)
    gone: str = ""
    missed: int = 0
    captures: int = 0
    patient: float = 0.0

    @property
    def running(self):
        """Whether it is in its session."""
        return not self.gone and self.state.stage == CALIBRATING and not self.waiting

    @property
    def waiting(self):
        """Whether its session is still to begin, or to say what it lacks."""
        state = self.state
        return not self.gone and (state.stage == WAITING or state.stage == CALIBRATING
                                  and not state.missing and not state.taken)

    @property
    def over(self):
        """Whether nothing more is to come of it."""
        return bool(self.gone) or self.state.stage == OVER

    @property
    def stuck(self):
        """Whether its readings say nothing of how it lies."""
        return self.state.reason == "stale"

    @property
    def name(self):
        """Number and the id's beginning, as far as it is known."""
        return "%d%s" % (self.number, self.state.board and " (%s)" % self.state.board[:SHORT])

    @property
    def taken_last(self):
        """Its face of the last placement that it took in this session, "" before the first."""
        return list(self.state.taken)[-1][:2] if self.state.paces and self.state.taken else ""

    def own(self, face):
        """Its own face that is up when that of the jig is; "" while that is not known."""
        return jig_to_own(self.mounting).get(face, "")

    def placements(self, face):
        """How many of the two placements on a face of the jig it has; 0 where not known."""
        own = self.own(face)
        return sum(own + letter not in self.state.missing for letter in "ab") if own else 0

    def silent_s(self, now):
        """For how many seconds it has said nothing, 0 where it speaks."""
        silence = now - self.state.now
        return silence if silence > SILENT_S else 0

    def jig_up(self):
        """The face of the jig that is up by its vector, "" where that is not known."""
        return "" if self.stuck else self.mounting.get(face_up(self.state), "")

    def without(self, face):
        """The Member as it will be once it has obeyed a redo of the jig's face; one that is over
        waits for its session."""
        own = self.own(face)
        back = tuple(own + letter for letter in "ab")
        kept = {pose: n for pose, n in self.state.taken.items() if pose not in back}
        missing = back + tuple(pose for pose in self.state.missing if pose not in back)
        stage = WAITING if self.state.stage == OVER else self.state.stage
        return replace(self, state=replace(self.state, taken=kept, missing=missing, stage=stage))
