"""A board's stream from first to last sample: asked for, read, counted, put back."""

import contextlib
import json
import math
import time

from sixflip.capture.stream_frame import CORRECTED, HEADING, RAW

from ..errors import CheckFailed, NoBoard, SixflipError
from .board_events import parse, unusable
from .stream_reader import FrameReader

KINDS = {"raw": RAW, "corrected": CORRECTED, "heading": HEADING}
ANSWER_S = 10
SILENCE_S = 5
SLOWEST_HZ = 0.01       # slower than that nobody can tell from a board that has stopped
CLOCK_TIMES = 10        # real seconds a second of the board's, before its clock counts as standing
WRAP_US = 1 << 32


class StreamSession:
    """what: raw, corrected or heading; binary: frames instead of lines; hz: None as it is.

    taken, lost, damaged   samples, frames that never came (binary), lines nobody can read
    show(event)            called with everything else the board says
    """

    def __init__(self, link, what, binary=False, hz=None, show=None):
        self.link = link
        self.what = what
        self.binary = binary
        self.hz = hz
        self.show = show or (lambda event: None)
        self.reader = FrameReader()
        self.taken = self.misfits = 0
        self.before = None
        self.silence = SILENCE_S

    @property
    def lost(self):
        return self.reader.lost

    @property
    def damaged(self):
        return self.reader.damaged + self.misfits

    def _ask(self, cmd, answer, **fields):
        """The board's answer to a command; whatever it streams meanwhile is passed over."""
        self.link.send(json.dumps(dict({"cmd": cmd}, **fields)))
        end = time.monotonic() + ANSWER_S
        reader = FrameReader()
        for line in self.link.raw_lines(ANSWER_S):
            said = reader.line(line)
            event = parse(said) if isinstance(said, str) else None
            if event and event["event"] == answer:
                return event
            if event and event["event"] == "misfit" and event["of"] == answer:
                raise NoBoard(unusable(self.link.port, event))
            self._refuse(event)
            if time.monotonic() > end:
                break
        raise NoBoard("%s: nothing answers as the firmware does, expected %r; is it stopped? "
                      "(reset the board, or sixflip provision)" % (self.link.port, answer))

    def _refuse(self, event):
        """Raises when the board says that there will be no stream."""
        if not event:
            return
        if event["event"] == "error":
            raise CheckFailed("the board: %s, expected %s" % (
                event["what"], event.get("expected")))
        if event["event"] in ("state", "calibrating"):
            raise CheckFailed("%s: a calibration is under way, nothing is streamed: finish it "
                              "with sixflip calibrate" % self.link.port)

    def ask_for(self, **fields):
        """The board's answer to the stream command; close() puts back what was before."""
        self.before = self._ask("info", "info")
        return self._ask("stream", "stream", **fields)

    def samples(self, seconds=None):
        """(t_us, values) of every sample, until so many seconds of the board's time are over.

        values  7 counts; ax ay az m/s² and gx gy gz rad/s; or roll, pitch, yaw in degrees; NaN
                for a gyro that the chip has not
        """
        fields = {} if self.hz is None else {"hz": self.hz}
        now = self.ask_for(raw=self.what == "raw", heading=self.what == "heading",
                           binary=self.binary, **fields)
        if not now["hz"]:
            raise CheckFailed("%s: the board is set to stream nothing, expected a rate: --hz"
                              % self.link.port)
        if not now["hz"] >= SLOWEST_HZ:
            raise CheckFailed("%s: the board is set to stream %g samples a second, expected %g at "
                              "least: --hz" % (self.link.port, now["hz"], SLOWEST_HZ))
        self.silence = max(SILENCE_S, 3 / now["hz"])
        first, began = None, time.monotonic()
        for t_us, values in self._timed():
            first = t_us if first is None else first
            if seconds is not None and t_us - first >= seconds * 1e6:
                return
            self.taken += 1
            yield t_us, values
            if seconds is not None and time.monotonic() - began > (
                    self.silence + CLOCK_TIMES * seconds) * getattr(self.link, "patience", 1):
                raise NoBoard("%s: in %.0f s the board's clock went on by %.3g s, expected %g" % (
                    self.link.port, time.monotonic() - began, 1e-6 * (t_us - first), seconds))

    def _timed(self):
        """Samples with a time that does not wrap."""
        ahead, last = 0, None
        for t_us, values in self._received():
            if self.binary and last is not None and t_us < last:
                ahead += WRAP_US
            last = t_us
            yield t_us + ahead, values

    def _received(self):
        since = time.monotonic()
        for line in self.link.raw_lines(self.silence):
            said = self.reader.line(line)
            sample = self._frame(said) if isinstance(said, tuple) else None
            if isinstance(said, str):
                event = parse(said)
                sample = self._event(event)
                if event and sample is None:
                    self._other(event)
            if sample:
                since = time.monotonic()
                yield sample
            elif time.monotonic() - since > 2 * self.silence:
                break
        raise NoBoard("%s: the board has stopped streaming, expected a sample every %d s or "
                      "sooner" % (self.link.port, self.silence))

    def _frame(self, frame):
        kind, _, t_us, values = frame
        if not self.binary or kind != KINDS[self.what]:
            return None
        if any(math.isinf(value) for value in values):
            self.misfits += 1
            return None
        return t_us, values

    def _event(self, event):
        """The sample in an event, None when it is not of the kind asked for."""
        if self.binary or not event:
            return None
        if event["event"] == "misfit":
            self.misfits += event["of"] in ("sample", "heading")
            return None
        keys = {"raw": ("raw",), "corrected": ("a", "w"),
                "heading": ("roll_deg", "pitch_deg", "yaw_deg")}[self.what]
        if event["event"] not in ("sample", "heading") or event.get(keys[0]) is None:
            return None
        values = [event.get(key) for key in keys]
        if self.what != "heading":
            values = values[0] + (values[1] or [math.nan] * 3) if len(values) > 1 else values[0]
        return event["t_us"], tuple(values)

    def _other(self, event):
        """Not a sample: perhaps the board started anew, with the stream it has by itself."""
        self._refuse(event if event["event"] != "error" else None)
        if event["event"] == "hello":
            raise NoBoard("%s: the board has started anew in the middle of the stream"
                          % self.link.port)
        if event["event"] not in ("sample", "heading"):
            self.show(event)

    def close(self):
        """Leaves the board as it was."""
        if self.before is None:
            return
        with contextlib.suppress(SixflipError):
            self.link.send(json.dumps(dict(
                {"cmd": "stream"}, hz=self.before.get("stream_hz") or 0,
                raw=bool(self.before.get("raw")), heading=bool(self.before.get("heading")),
                binary=bool(self.before.get("binary")))))
