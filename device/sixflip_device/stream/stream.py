"""Corrected samples on the serial port, and the host's lines obeyed, until something is asked."""

from array import array

from .. import led
from ..frozen_sensor import Repeats
from ..sensor import BusLost, pacer

LISTEN_US = 100000


class LineOutput:
    """Sample events: a in m/s2 and w in rad/s, or the seven raw counts."""

    def __init__(self, unit):
        self._unit = unit
        self._out = array("f", [0.0] * 6)

    def step(self, sample, dt_us):
        """Nothing happens between two samples that are sent."""

    def send(self, t_us, sample):
        unit = self._unit
        if unit.raw:
            unit.events.emit("sample", t_us=t_us, raw=sample)
            return
        out = unit.correction.apply(sample, self._out)
        w = out[3:] if unit.sensor.imu.has_gyro else None
        unit.events.emit("sample", t_us=t_us, a=out[:3], w=w)


def _output(unit):
    """step(sample, dt_us) with every sample, send(t_us, sample) with those that are sent."""
    if unit.recording:
        from .outputs import BlockOutput
        return BlockOutput(unit)
    if unit.heading:
        from .outputs import HeadingOutput
        return HeadingOutput(unit)
    if unit.binary:
        from .outputs import BinaryOutput
        return BinaryOutput(unit)
    return LineOutput(unit)


def _gravity_watch(unit):
    """A GravityWatch, or None where the heap has no room for it beside the stream."""
    from ..record.activate import small
    if small():
        return None
    from .gravity_watch import GravityWatch
    return GravityWatch(unit)


def run(unit):
    """Until a calibration is asked for, the host says stop, or the sensor is lost."""
    if unit.correction is None:
        from ..record import active_record
        active_record.use(unit, unit.slot, unit.record)
        if unit.record is not None and unit.record.terms:
            from ..record.terms import beside_stream
            beside_stream(unit)
    try:
        _stream(unit)
    except BusLost as e:
        unit.events.error(str(e), "the sensor that was there a moment ago")
        return "start"
    finally:
        unit.output = None  # its modules with it
    return "" if unit.stopped else "asked"


def _stream(unit):
    board = unit.board
    rate_hz = unit.settings["rate_hz"]
    paced = pacer(board, unit.sensor, rate_hz)
    repeats = Repeats(unit.sensor, unit.events)
    lamp = led.Lamp(board, rate_hz)
    lamp.show(led.RAW if unit.record is None else led.CALIBRATED)
    unit.events.emit("ready", corrected=unit.record is not None, stream_hz=unit.stream_hz)
    sample = array("h", [0] * 7)
    t_us = since_heard = unseen_us = 0
    due = 500000  # parts of a sample that are due, in millionths; half a one allows for jitter
    pressed = True  # a button still held from before asks for nothing
    while True:
        dt = paced.next(sample)
        if dt < 0:
            continue
        t_us += dt
        since_heard += dt
        lamp.step()
        if unit.output is None:  # so has a command left it
            unit.output = _output(unit)
            watch = _gravity_watch(unit)  # who has just asked for the stream is told as well
        if repeats.seen(sample):
            unseen_us += dt
        else:
            unit.output.step(sample, unseen_us + dt)
            if watch is not None:
                watch.step(unseen_us + dt, sample)
            unseen_us = 0
            hz = unit.stream_hz
            due += dt * hz
            if hz and due >= 1000000:
                due = min(due - 1000000, 1000000)  # late is late
                unit.output.send(t_us, sample)
        if since_heard >= LISTEN_US:
            since_heard = 0
            held = board.button()
            if held and not pressed:
                unit.asked = True
            pressed = held
            if unit.listen() or unit.asked:
                return
