"""After a calibration: the sensor, let go of for the solver, is found again."""

from ..find_sensor import find
from ..sensor import Sensor


def run(unit):
    if unit.sensor is None:
        try:
            imu = find(unit.board, unit.settings)[0]
        except OSError as e:
            unit.events.error(str(e), "the sensor that was there a moment ago")
            return "start"
        unit.sensor = Sensor(unit.board, imu, unit.settings, unit.events)
    return "reuse"
