"""Corrected samples on the serial port, and the host's lines obeyed, until something is asked."""

from array import array

from .. import led
from ..frozen_sensor import FrozenSensor
from ..sensor import pacer
from .gravity_watch import GravityWatch
from .outputs import BinaryOutput, BlockOutput, HeadingOutput, LineOutput

LISTEN_US = 100000


def _output(firmware):
    """step(sample, dt_us) with every sample, send(t_us, sample) with those that are sent."""
    if firmware.recording:
        return BlockOutput(firmware)
    if firmware.heading:
        return HeadingOutput(firmware)
    return BinaryOutput(firmware) if firmware.binary else LineOutput(firmware)


def run(firmware):
    """Until a calibration is asked for or the host says stop; BusLost when the sensor is gone."""
    try:
        _stream(firmware)
    finally:
        firmware.output = None


def _stream(firmware):
    board = firmware.board
    rate_hz = firmware.settings["rate_hz"]
    paced = pacer(board, firmware.sensor, rate_hz)
    frozen = FrozenSensor(firmware.sensor, firmware.events)
    lamp = led.Lamp(board, rate_hz)
    lamp.show(led.RAW if firmware.record is None else led.CALIBRATED)
    firmware.events.emit("ready", corrected=firmware.record is not None,
                         stream_hz=firmware.stream_hz)
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
        if firmware.output is None:  # so has a command left it
            firmware.output = _output(firmware)
            watch = GravityWatch(firmware)  # who has just asked for the stream is told as well
        if frozen.seen(sample):
            unseen_us += dt
        else:
            firmware.output.step(sample, unseen_us + dt)
            watch.step(unseen_us + dt, sample)
            unseen_us = 0
            hz = firmware.stream_hz
            due += dt * hz
            if hz and due >= 1000000:
                due = min(due - 1000000, 1000000)  # late is late
                firmware.output.send(t_us, sample)
        if since_heard >= LISTEN_US:
            since_heard = 0
            held = board.button()
            if held and not pressed and firmware.request is None:
                firmware.request = {}
            pressed = held
            if firmware.listen():
                return
