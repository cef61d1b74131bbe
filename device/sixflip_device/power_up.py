"""What happens at power-up (METHOD 6), and after it until somebody stops it.

One phase after the other, each a module with run(unit) -> name of the next phase or "". A
phase is let go of when it ends: a small board must not hold solver and session at once.

    start     find the sensor, hello, self-test, grace window
    recall    newest valid record; put_in_force: it corrects; rest: gyro bias
    asked     all six faces, a plan, or (redo_session) the session before goes on
    sampling  guided session: six faces, each with a flip
    checking  the poses, then flips_turned: by an earlier gyro, solving: the parameters,
              judging: their verdict
    remember  the record before, then solving_gyro, gyro_signs, judging_gyro, judging_flips
    saving    record on flash
    resume    the sensor again, then reuse: the record corrects
    terms     what it has beside scale and bias
    stream    corrected samples
"""

import gc
import sys

from .events import Events, HostLine
from .flash_files import FLAG, size


class Unit:
    """Everything the phases share; see board.py for board.

    sensor, record, slot, correction   None until there is one
    bias_dps    the gyro bias in use, or None
    asked       a calibration is wanted, request: which (asked.py); stopped: the host wants
                the REPL
    raw, heading, binary, stream_hz    what is streamed and how; output: what sends it
    recording   the host wants the blocks of a capture: of the session to come, or of the stream
    taken       what a phase left for the next: asked for sampling, sampling for solving,
                when there is no sensor
    """

    def __init__(self, board, settings):
        self.board = board
        self.settings = settings
        self.events = Events(board.write_line)
        self.host = HostLine(board, self.events)
        self.sensor = None
        self.record = None
        self.slot = None
        self.correction = None
        self.bias_dps = None
        self.asked = False
        self.request = None
        self.stopped = False
        self.raw = self.heading = self.binary = self.recording = False
        self.output = None
        self.stream_hz = settings["stream_hz"]
        self.first = True
        self.taken = None

    def listen(self):
        """Obeys one line of the host, if there is one. True when it changes what to do."""
        command = self.host.poll()
        if command is not None:
            self.obey(command, False)
        return self.asked or self.stopped

    def let_go(self):
        """No correction while a session runs; a record that is on the flash is read again."""
        self.correction = None
        if self.slot is not None:
            self.record = None

    def obey(self, command, calibrating):
        if command["cmd"] == "stop" and not calibrating:
            self.stopped = True  # in any heap
            return
        from .commands import obey
        obey(self, command, calibrating)


# Small and needed in every phase, or behind objects that outlive one.
LASTING = ("sixflip_device.power_up", "sixflip_device.events",
           "sixflip_device.flash_files", "sixflip_device.boards", "sixflip.chips",
           "sixflip.poses.faces", "sixflip.poses.placement", "sixflip.record.record")
# As long as there is a sensor; of the drivers only what the sensor is made of.
SAMPLING = ("sixflip_device.led", "sixflip_device.sensor", "sixflip_device.fifo_pacer",
            "sixflip.poses.still_window")


PLACES = {
    "start": "session.start", "recall": "record.load_record", "rest": "record.rest",
    "put_in_force": "record.activate", "asked": "session.session_request",
    "redo_session": "session.redo_session", "sampling": "session.sampling",
    "checking": "session.checking", "flips_turned": "session.flips_turned",
    "solving": "session.solving", "judging": "session.judging",
    "remember": "session.previous_record", "solving_gyro": "session.solving_gyro",
    "gyro_signs": "session.gyro_signs", "holding_flips": "session.holding_flips",
    "judging_gyro": "session.judging_gyro", "judging_flips": "session.judging_flips",
    "saving": "record.saving", "resume": "record.reopen_sensor", "reuse": "record.apply_record",
    "terms": "record.terms", "stream": "stream.stream"}

THRESHOLD = 4096   # bytes
SMALL_HEAP = 262144


def free(names):
    """Lets go of modules by name; whoever still uses one keeps it alive."""
    for name in names:
        sys.modules.pop(name, None)
        at = name.rfind(".")
        package = sys.modules.get(name[:at])
        if package is not None and hasattr(package, name[at + 1:]):
            delattr(package, name[at + 1:])
    gc.collect()


def free_unlasting(sensor=None):
    """After a phase: on CPython there is memory enough, and tests hold on to modules."""
    if sys.implementation.name == "micropython":
        lasting = LASTING if sensor is None else LASTING + SAMPLING
        free([m for m in sys.modules
              if m.startswith("sixflip") and "." in m and m not in lasting
              and not m.startswith("sixflip_device.boards.")])


def _run_phase(name, unit):
    # a function of its own: a frame that lives on keeps alive what passed through it
    return __import__("sixflip_device." + PLACES.get(name, name), None, None, ["run"]).run(unit)


def run(board, settings, problems=()):
    """The firmware; returns only when the host says stop."""
    unit = Unit(board, settings)
    for problem in problems:
        unit.events.error(problem, "the settings as the README lists them")
    if hasattr(gc, "threshold") and gc.mem_free() + gc.mem_alloc() < SMALL_HEAP:
        # collected early, what lasts stays at the front and the free rest in one piece
        gc.threshold(THRESHOLD)
    phase = "start"
    while phase:
        if phase == "asked" and unit.request is None and not size(board.root + FLAG):
            phase = "sampling"  # as mostly: all six faces
        if phase == "sampling":
            unit.let_go()
            if unit.record is None:
                free(("sixflip.record.record",))
        gc.collect()  # once more, now that the frames of the phase before are gone
        phase = _run_phase(phase, unit)
        free_unlasting(unit.sensor)
        if unit.taken is not None:
            from .moved_together import move
            move(unit)
            move = None
            free(("sixflip_device.moved_together",))
    unit.events.emit("stopped")


def main():
    from .boards.this_board import board_here
    board, values, problems = board_here()
    board_here = None
    free_unlasting()
    run(board, values, problems)
