"""Runs on the board, beside its firmware: the lines of the bus, who answers, what it measures.

Prints one Python literal a line, ("name", ...). Nothing is changed but the sensor's set-up.
"""

from array import array

from sixflip.chips.catalogue import CHIPS
from sixflip_device.boards.this_board import board_here

ASKED = sorted({(address, row[3], 1) for row in CHIPS for address in row[2]}) + [
    (0x1E, 0x0A, 3), (0x0D, 0x0D, 1), (0x7C, 0x00, 1)]
TRIES = 3
SAMPLES = 50
READY_US = 500000


def tell(*what):
    print(repr(what))


class Quiet:
    """Events that are only counted."""

    def __init__(self):
        self.errors = 0

    def emit(self, event, **fields):
        self.errors += 1


def levels(board):
    """("lines", SDA and SCL against the pin's own pull-down, then with its pull-up)."""
    scl, sda = getattr(board, "_scl", None), getattr(board, "_sda", None)
    if board.scl_pulse is None or scl is None:
        return
    from machine import Pin
    read = []
    for pull in (getattr(Pin, "PULL_DOWN", None), Pin.PULL_UP):
        for name in (sda, scl):
            pin = Pin(name, Pin.IN, pull)
            board.sleep_us(200)
            read.append(pin.value())
    tell("lines", str(sda), str(scl), *read)
    board.reopen_i2c()


def answers(i2c):
    """("ids", {(address, register): bytes or errno}); asked again when there was an error."""
    ids = {}
    for address, register, n in ASKED:
        for _ in range(TRIES):
            try:
                ids[address, register] = bytes(i2c.readfrom_mem(address, register, n))
                break
            except OSError as e:
                ids[address, register] = e.args[0] if e.args else 0
    tell("ids", ids)


def scanned(i2c):
    try:
        tell("scan", list(i2c.scan()))
    except (OSError, AttributeError) as e:
        tell("scan", str(e))


def data_ready(board, imu):
    """("ready", new samples between the first and the last, microseconds, nominal rate, how
    often it was asked) of each chip of the sensor, by what its driver says of a new sample."""
    for chip in (imu.accel, imu.gyro) if hasattr(imu, "accel") else (imu,):
        if chip.READY_ON:
            register, bits = chip.READY_ON
            before = chip._read(register)
            chip._write(register, before | bits)
        tell("ready", chip.chip, *count_ready(board, chip))
        if chip.READY_ON:
            chip._write(register, before)


def count_ready(board, chip):
    status, bits = chip.READY
    sample = array("h", [0] * 7)
    started = board.ticks_us()
    first = last = asked = 0
    seen = -1                   # what was ready before
    while board.ticks_diff(board.ticks_us(), started) < READY_US:
        asked += 1
        try:
            new = chip._read(status) & bits
            if new:
                chip.read_into(sample)
        except OSError:         # the self-test counts them
            continue
        if new:
            last = board.ticks_diff(board.ticks_us(), started)
            if seen < 0:
                first = last
            seen += 1
        board.sleep_us(100)
    return max(0, seen), last - first, chip.output_rate_hz, asked


def measured(board, imu, settings):
    """The firmware's own self-test, and the mean of some samples."""
    from sixflip_device.sensor import Sensor
    from sixflip_device.session import start
    quiet = Quiet()
    sensor = Sensor(board, imu, settings, quiet)
    answer = start.self_test(board, sensor, settings["rate_hz"])
    sample = array("h", [0] * 7)
    sums = [0] * 7
    n = 0
    for _ in range(SAMPLES):
        if sensor.read_into(sample) == 0:
            n += 1
            for k in range(7):
                sums[k] += sample[k]
        board.sleep_us(1000000 // settings["rate_hz"])
    tell("selftest", answer["ok"], answer["problems"], answer["rate_hz"], settings["rate_hz"],
         answer["still"], answer["temperature_c"], sensor.errors)
    tell("means", n, sums)


def bus_of(board, settings):
    """In words."""
    if getattr(board.i2c, "spi", False):
        freq = settings["spi"].get("freq", 1000000)
        return "SPI at %d kHz, mode %d" % (freq // 1000, board.i2c.mode)
    return "I2C at %d kHz" % (settings["freq"] // 1000)


def look():
    from sixflip_device.find_sensor import find
    board, settings, problems = board_here()
    tell("settings", board.name, settings["sensor"], bus_of(board, settings), problems)
    levels(board)
    if getattr(board.i2c, "spi", False):    # one chip, no addresses to ask
        tell("scan", [])
        tell("ids", {})
    else:
        scanned(board.i2c)
        answers(board.i2c)
    try:
        imu, report = find(board, settings)
    except OSError as e:
        tell("no sensor", getattr(e, "report", None) or [str(e)])
        return
    tell("sensor", imu.sensor, imu.name, imu.who_am_i, imu.accel_range_g, imu.accel_lsb_per_g,
         imu.gyro_lsb_per_dps if imu.has_gyro else 0, report)
    try:
        if imu.fifo is None:        # else every sample is counted
            data_ready(board, imu)
        measured(board, imu, settings)
    except OSError as e:
        tell("lost", str(e))


try:
    look()
except (OSError, ValueError, ImportError) as error:
    tell("stopped", str(error))
