"""What the LED says. Sixteen steps of an eighth of a second, over and over.

    lamp                                meaning
    fast flicker, all the time          measuring the sensor's noise: leave it alone
    one short flash every two seconds   put the box on a face that is still missing
    half on, half off, twice a second   the box was put down: take the hand away
    steadily on                         capturing: do not touch
    three flashes, pause                pose taken: flip it, or go to the next face
    five flashes, pause                 pose not taken; the line on the serial port says why
    slow, one second on, one off        calibrated, corrected samples are streamed
    two long flashes, pause             no correction: samples are raw
    two short flashes, pause            no chip on the bus
"""

MEASURING = 0b1010101010101010
WAITING = 0b1000000000000000
SETTLING = 0b1100110011001100
CAPTURING = 0b1111111111111111
ACCEPTED = 0b1010100000000000
REFUSED = 0b1010101010000000
CALIBRATED = 0b1111111100000000
RAW = 0b1110111000000000
NO_CHIP = 0b1010000000000000

STATES = {
    "measuring noise": MEASURING,
    "moving": WAITING,
    "settling": SETTLING,
    "capturing": CAPTURING,
    "done": CALIBRATED,
}


class Lamp:
    """step() once a sample, no allocation; show(pattern) at once, flash(pattern) once over."""

    def __init__(self, board, rate_hz):
        self._led = board.led
        self._samples = max(1, int(rate_hz) // 8)
        self._base = 0
        self._once = 0
        self._position = 0
        self._countdown = 1

    def show(self, pattern):
        """This pattern from now on, over and over."""
        if pattern != self._base:
            self._base = pattern
            if not self._once:
                self._position = 0
                self._countdown = 1

    def flash(self, pattern):
        """This pattern once, then the shown one goes on."""
        self._once = pattern
        self._position = 0
        self._countdown = 1

    def step(self):
        """To be called once a sample."""
        self._countdown -= 1
        if self._countdown > 0:
            return
        self._countdown = self._samples
        self._led((self._once or self._base) >> (15 - self._position) & 1)
        self._position += 1
        if self._position == 16:
            self._position = 0
            self._once = 0
