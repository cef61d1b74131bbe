"""sixflip record: the raw samples of a resting or driving board for hours, without a session."""

import json
import math
import sys
import time

from ..board import calibration_request
from ..board.board_events import events, parse
from ..board.ports import add_port, open_link
from ..board.recording import Recording
from ..board.stream_session import StreamSession
from ..errors import CheckFailed, Interrupted, NoBoard, UsageError
from ..file_arguments import add_output
from ..terminal import plain

EXAMPLE = "sixflip record --hours 8 -o night.bin"
SILENCE_S = 5
LOOK_S = 8              # what is missing is said every few seconds; a board that powers up, later


def add_arguments(parser):
    add_port(parser)
    how_long = parser.add_mutually_exclusive_group()
    how_long.add_argument("--seconds", type=float, metavar="N",
                          help="by the board's clock (default: until Ctrl-C)")
    how_long.add_argument("--hours", type=float, metavar="H", help="the same in hours")
    add_output(parser, "-o", "--output", metavar="FILE", kinds=(),
               help="a board's capture file (default: DEVICE-NUMBER.bin here), which every verb "
                    "reads; it is whole at every moment")
    parser.add_argument("--json", action="store_true", help="what was recorded, as JSON")


def run(args):
    """Until the time is over or Ctrl-C; what came is in the file whatever ends it."""
    wanted_s = args.seconds if args.hours is None else args.hours * 3600
    if wanted_s is not None and not 0 < wanted_s < math.inf:
        raise UsageError("--%s %g: expected more than 0" % (
            "seconds" if args.hours is None else "hours",
            args.seconds if args.hours is None else args.hours))
    recording = Recording(args.output, labelled=False)
    with open_link(args.port) as link:
        free_for_a_log(link)
        session = StreamSession(link, "raw")
        try:
            session.ask_for(record=True, hz=0)
            receive(link, recording, wanted_s, args.json)
        except KeyboardInterrupt:
            recording.end()
            raise Interrupted("stopped; " + ", ".join(recording.words())) from None
        finally:
            recording.close()
            session.close()
    report(recording, args.json)
    return 0


def free_for_a_log(link):
    """A board without a record begins a session by itself, and a box that lies still on a face
    gives it one pose: ended where there are no more."""
    for event in events(link, LOOK_S, LOOK_S):
        missing = event.get("missing")
        if event["event"] in ("sample", "heading", "ready"):
            return
        if event["event"] == "state" and missing is not None and len(missing) > 10:
            calibration_request.stop(link)
            return
        if event["event"] == "state" and (missing is not None or event.get("at") is not None):
            raise CheckFailed("%s: a calibration is under way: finish it with sixflip calibrate, "
                              "or end it with Ctrl-C there" % link.port)


def receive(link, recording, wanted_s, quiet):
    """Every piece into the recording, until it holds wanted_s seconds of the board's time."""
    heard, told = time.monotonic(), 0.0
    for line in link.raw_lines(SILENCE_S):
        now = time.monotonic()
        if recording.take(line):
            heard = now
            if recording.other:
                raise NoBoard("%s: the board has started anew; %s" % (
                    link.port, ", ".join(recording.words())))
            recorded_s = recording.recorded_s()
            if wanted_s is not None and recorded_s >= wanted_s:
                recording.end()
                return
            if sys.stderr.isatty() and not quiet and now - told > 1:
                told = now
                print("\r%s, %s, %d samples" % (recording.path, clock_words(recorded_s),
                                                recording.samples), end="", file=sys.stderr)
        elif (parse(line.decode("utf-8", "replace")) or {}).get("event") == "hello":
            raise NoBoard("%s: the board has started anew; %s" % (
                link.port, ", ".join(recording.words())))
        elif now - heard > 2 * SILENCE_S:
            break
    raise NoBoard("%s: the board has stopped sending samples; %s" % (
        link.port, ", ".join(recording.words())))


def clock_words(seconds):
    return "%d:%02d:%02d" % (seconds // 3600, seconds // 60 % 60, seconds % 60)


def report(recording, as_json):
    if as_json:
        print(json.dumps({"format": 1, "kind": "sixflip record", "file": str(recording.path),
                          "samples": recording.samples, "lost": recording.lost,
                          "gaps": recording.gaps, "seconds": round(recording.recorded_s(), 3)}))
        return
    for line in recording.words():
        print(plain(line))
