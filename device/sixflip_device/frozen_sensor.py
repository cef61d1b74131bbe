"""A chip that hangs: it answers, awake and set up as it should be, and repeats one reading.

Noise does not give the same triple SAME times over, so what repeats itself so often is no
measurement. The chip is set up anew then, and again after twice as many, for as long as it
takes. A session has its own eye on this, in its windows.
"""

from array import array

from sixflip.poses.still_window import SAME

MOST = 4096  # repeats from one attempt to the next


class FrozenSensor:
    """seen(sample) -> whether it is one of a chip that hangs: not to be used. BusLost when the
    chip cannot be set up anew."""

    def __init__(self, sensor, events):
        self._sensor = sensor
        self._events = events
        self._last = array("h", [0] * 6)
        self._same = [1, 1]  # accelerometer, gyro
        self._due = SAME

    def seen(self, sample):
        """Whether the sample repeats too many before it, and is not to be used."""
        most = self._repeats(sample, 0)
        if self._sensor.imu.has_gyro:
            most = max(most, self._repeats(sample, 1))
        if most < SAME:
            self._due = SAME
            return False
        if most == self._due:
            self._due += min(most, MOST)
            if most == SAME:
                self._events.error("the sensor hangs: %d identical readings" % SAME,
                                   "noise; nothing is sent until a reading differs")
            self._sensor.hangs()
        return True

    def _repeats(self, sample, sensor):
        """How many times accelerometer (sensor 0) or gyro (1) has read the same in a row."""
        last = self._last
        same = True
        for i in range(3 * sensor, 3 * sensor + 3):
            if sample[i] != last[i]:
                last[i] = sample[i]
                same = False
        self._same[sensor] = self._same[sensor] + 1 if same else 1
        return self._same[sensor]
