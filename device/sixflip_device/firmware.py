"""What the phases of the firmware share, and the one line of the host that is obeyed at a time."""

from .events import Events, HostLine


class Firmware:
    """The state of the firmware between its phases (power_up.py); nothing is added to it later.

    board, settings  one of boards/, and what settings.py has read
    events, host     lines to the host and from it (events.py)
    sensor           sensor.Sensor, None until one was found
    slot, record     where the active record (sixflip.record.record) is stored, "a", "b" or None,
                     and the record itself, None without one
    correction       of that record, or of the data sheet's numbers; None while a session samples
    bias_dps         the gyro's bias in use, three numbers in deg/s, or None
    request          the calibration that is wanted, as the host's line or the flag's file words it
                     (session_request.py), {} for all six faces; None: none is wanted
    stopped          the host wants the REPL
    first            this is the first search for a sensor since power-up
    raw, heading, binary, stream_hz   what is streamed, and how often
    recording        every sample is sent, as the blocks of a capture
    output           what sends the stream; None: to be made anew
    """

    def __init__(self, board, settings):
        self.board = board
        self.settings = settings
        self.events = Events(board.write_line)
        self.host = HostLine(board, self.events)
        self.sensor = None
        self.slot = None
        self.record = None
        self.correction = None
        self.bias_dps = None
        self.request = None
        self.stopped = False
        self.first = True
        self.raw = self.heading = self.binary = self.recording = False
        self.stream_hz = settings["stream_hz"]
        self.output = None

    def listen(self):
        """Obeys one line of the host, if there is one. True when it changes what to do next."""
        command = self.host.poll()
        if command is not None:
            self.obey(command, False)
        return self.request is not None or self.stopped

    def obey(self, command, calibrating):
        """Obeys a command (a dict with "cmd"); calibrating: a session is under way."""
        if command["cmd"] == "stop" and not calibrating:
            self.stopped = True  # even where the heap has no room for the other commands
            return
        from .commands import obey
        obey(self, command, calibrating)
