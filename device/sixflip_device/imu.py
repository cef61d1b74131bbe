"""Corrected samples in your own program:

    from sixflip_device.imu import CorrectedImu
    imu = CorrectedImu()
    ax, ay, az, gx, gy, gz = imu.read()
"""

from array import array

from .events import Events
from .find_sensor import find
from .firmware import Firmware
from .frozen_sensor import FrozenSensor
from .record.active_record import activate, load
from .sensor import READ, Sensor


class CorrectedImu:
    """The sensor with the correction that is stored on the board.

    board     one of boards/, or None: as sixflip.json says
    rest_s    seconds to wait for a rest in which the gyro's bias is measured anew; None: as
              sixflip.json says, 0: the stored bias
    report    called with the firmware's event lines (print, for one); None: silence

    calibrated says whether there is a record for this sensor, reason why not. Without one
    read() answers with the data sheet's scale. OSError when the sensor cannot be reached, or
    hangs.
    """

    def __init__(self, board=None, rest_s=None, report=None):
        if board is None:
            from .boards.this_board import board_here
            board, values, _ = board_here()
        else:
            from . import settings
            values, _ = settings.load(board.root)
        self._firmware = firmware = Firmware(board, values)
        firmware.events = Events(report or (lambda line: None))
        imu, _ = find(board, values)
        firmware.sensor = Sensor(board, imu, values, firmware.events)
        self._frozen = FrozenSensor(firmware.sensor, firmware.events)
        self._sample = array("h", [0] * 7)
        self._out = array("f", [0.0] * 6)
        self.reason = load(firmware)
        activate(firmware)
        self.calibrated = firmware.record is not None
        if rest_s != 0 and imu.has_gyro:
            from .record.check_at_rest import refresh
            rest = refresh(firmware, rest_s)
            if self.calibrated and values["mounting"] is not None:
                from .record.mount import at_power_up
                at_power_up(firmware, rest)

    def _read(self):
        # a chip that had to be set up anew delivers from the next sample on
        for _ in range(3):
            if self._firmware.sensor.read_into(self._sample) == READ:
                if self._frozen.seen(self._sample):
                    raise OSError("the sensor hangs: it repeats its reading")
                return self._sample
            self._firmware.board.sleep_us(20000)
        raise OSError("the sensor answers, but not with samples")

    def read(self):
        """(ax, ay, az) in m/s2 and (gx, gy, gz) in rad/s, six floats, corrected."""
        self._firmware.correction.apply(self._read(), self._out)
        return tuple(self._out)

    def raw(self):
        """Seven counts as the chip gave them: ax ay az gx gy gz temp."""
        return tuple(self._read())
