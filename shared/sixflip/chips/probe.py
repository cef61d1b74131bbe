"""Find out which sensor is on the bus, by identification registers.

A scan alone proves nothing (rp2 bit-bangs it, and several chips share an address): what
counts is the answer of the register that holds the identification. catalogue.py has them.
"""

import errno

from sixflip.chips import catalogue, magnetometers

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

_ATTEMPTS = const(4)            # a glitch may spoil one answer: two have to be the same
_NOBODY = const(0x7C)           # reserved (10-bit addressing): no chip answers there


class NoChip(OSError):
    """No usable sensor: .report says line by line what was asked and what answered."""

    def __init__(self, report, code=errno.ENODEV):
        super().__init__(code, "; ".join(report))
        self.report = report


class BusStuck(NoChip):
    """The bus itself does not work: a line is held low. Recover it, then look again."""


def _answer(i2c, address, register, n=1):
    """Bytes of an identification register, or None when nobody answers at the address."""
    try:
        return i2c.readfrom_mem(address, register, n)
    except OSError as error:
        if not error.args or error.args[0] != errno.ETIMEDOUT:
            return None
    raise BusStuck(["time-out at 0x%02x: a line of the bus is held low, or there are no "
                    "pull-up resistors" % address], errno.ETIMEDOUT)


def _identify(i2c, address, register, rows):
    """(answer of the register, row it belongs to or None); asked until one of the known came
    twice in a row. The answer is None when nobody answers at the address."""
    answer = None
    for _ in range(_ATTEMPTS):
        answered = _answer(i2c, address, register)
        if answered is None:
            continue
        same = answered[0] == answer
        answer = answered[0]
        if same:
            for row in rows:
                if answer & row[6] in row[4]:
                    return answer, row
    return answer, None


def _rows_at(address, register=None):
    """Rows of the chips that may be at an address; 0 is the one chip on SPI."""
    return [row for row in catalogue.CHIPS
            if (address in row[2] if address else row[0] in catalogue.ON_SPI)
            and (register is None or row[3] == register)]


def _place(address):
    return "0x%02x" % address if address else "SPI"


def _registers_at(address):
    """Identification registers of the chips that may be at an address, each once."""
    registers = []
    for row in _rows_at(address):
        if row[3] not in registers:
            registers.append(row[3])
    return registers


def _ask(i2c, address):
    """(row or None, answer, {register: answer}) of whoever is at an address."""
    answers = {}
    for register in _registers_at(address):
        answer, row = _identify(i2c, address, register, _rows_at(address, register))
        if answer is None:
            continue
        answers[register] = answer
        if row is not None:
            return row, answer, answers
    return None, None, answers


def _first_bank(i2c, address):
    """A chip that a reset of the board left in another bank shows its identification again."""
    for bank in {row[5] for row in _rows_at(address)}:
        if bank is not None:
            try:
                i2c.writeto_mem(address, bank, b"\x00")
            except OSError:
                return


def _shifted(answers):
    """The sentence on an identification that came a bit late or early: the clock's other edge."""
    for register in answers:
        if answers[register] in (0x00, 0xFF):
            continue
        for row in _rows_at(0, register):
            for known in row[4]:
                if known in (answers[register] << 1 & 0xFE, answers[register] << 1 & 0xFE | 1,
                             answers[register] >> 1, answers[register] >> 1 | 0x80):
                    return "that is 0x%02x, %s, shifted by a bit" % (known, row[4][known])
    return ""


def nearest(address, answers):
    """"the nearest is 0x68 in 0x75, MPU6050, 1 bit away", by the number of bits that differ; of
    an answer that is nobody's, such as 0x00, that it is none. answers: {register: answer}."""
    best = None
    for register in answers:
        if answers[register] in (0x00, 0xFF):
            continue
        for row in _rows_at(address, register):
            for known in row[4]:
                away = bin((answers[register] & row[6]) ^ known).count("1")
                if best is None or away < best[0]:
                    best = away, known, register, row[4][known]
    if best is None:
        return "that is no identification: no power, or two chips that pull at the lines"
    return "no chip that is known here; the nearest is 0x%02x in 0x%02x, %s, %d bit%s away" % (
        best[1], best[2], best[3], best[0], "" if best[0] == 1 else "s")


def _stranger(i2c, address, answers):
    """What is said of somebody who is none of ours; on SPI the mode may be the wrong one."""
    if not address:
        said = _shifted(answers)
        if said or i2c.mode not in (0, 3):
            return ("%s: SPI mode %d is wrong, the chips take 0 and 3 (or the clock is too fast)"
                    % (said or "that is no identification", i2c.mode))
    return nearest(address, answers)


def _look(i2c, report):
    """({sensor: (address, id)}, {address: {register: answer}} of chips that are none of ours)."""
    sensors, strangers = {}, {}
    for address in _addresses(i2c):
        row, answer, answers = _ask(i2c, address)
        if row is None and answers:
            _first_bank(i2c, address)
            row, answer, answers = _ask(i2c, address)
        if row is None:
            if answers:
                strangers[address] = answers
                said = ["0x%02x in register 0x%02x" % (answers[r], r) for r in sorted(answers)]
                report.append("%s answers %s: %s" % (_place(address), ", ".join(said),
                                                     _stranger(i2c, address, answers)))
        elif row[0] in sensors:
            report.append("%s: a second one, not used" % _place(address))
        else:
            sensors[row[0]] = address, answer
            report.append("%s: %s (who_am_i 0x%02x)" % (
                _place(address), row[4][answer & row[6]], answer))
    if not getattr(i2c, "spi", False):
        _look_for_magnetometers(i2c, report)
    return sensors, strangers


def _addresses(i2c):
    if getattr(i2c, "spi", False):
        return [0]
    addresses = []
    for row in catalogue.CHIPS:
        for address in row[2]:
            if address not in addresses:
                addresses.append(address)
    return addresses


def _look_for_magnetometers(i2c, report):
    for name, address, register, expected in magnetometers.KNOWN:
        answer = _answer(i2c, address, register, len(expected))
        if answer is None:
            continue
        if answer == expected:
            report.append("0x%02x: %s, a magnetometer, not used" % (address, name))
        else:
            report.append("0x%02x answers %s: not the magnetometer %s" % (
                address, " ".join(["0x%02x" % i for i in answer]), name))


def find(i2c, sleep_ms=None, sensor="auto", ranges=(None, None)):
    """(imu, report) of the sensor on the bus, the first of the catalogue where several are.

    sensor: "auto" or the one that must be there, of catalogue.SENSORS; a chip that answers
    with an unknown identification is used as a clone of the one that is asked for, never as
    anything by itself. ranges: full scales in g and °/s, None: the driver's; where the chip
    has not got it, the next larger. Raises NoChip with .report, a list of lines (BusStuck,
    errno ETIMEDOUT, when the bus does not work). The imu is not configured yet.
    """
    if sensor != "auto" and sensor not in catalogue.SENSORS:
        raise ValueError("sensor is %r, expected auto or one of %s"
                         % (sensor, " ".join(catalogue.SENSORS)))
    report = []
    sensors, strangers = _look(i2c, report)
    for name in catalogue.SENSORS if sensor == "auto" else (sensor,):
        where = _where(name, sensors, strangers if sensor != "auto" else {}, report)
        if where:
            try:
                driver = catalogue.driver(name)
            except ImportError:
                raise NoChip(report + ["its driver is not on this board: sixflip provision "
                                       "--sensor %s" % name])
            imu = _make(driver, name, i2c, where, sleep_ms, ranges, report)
            _others(sensors, name, report)
            return imu, report
    if not getattr(i2c, "spi", False) and _answer(i2c, _NOBODY, 0) is not None:
        raise BusStuck(["every address answers, the reserved 0x7c too: SDA is held low"],
                       errno.ETIMEDOUT)
    raise NoChip(_complaint(i2c, sensor, sensors, strangers, report))


def _where(name, sensors, strangers, report):
    """What the driver of a sensor is made with: address and identification of each chip."""
    if name == "gy85":
        both = "adxl345" in sensors and "itg3205" in sensors
        return (sensors["adxl345"][0],) + sensors["itg3205"] if both else None
    if name in sensors:
        return sensors[name]
    _, _, addresses, register, _, _, _ = catalogue.row_of(name)
    for address in addresses + (0,):
        answer = strangers.get(address, {}).get(register, 0)
        if 0 < answer < 0xFF:
            report.append("who_am_i 0x%02x is no %s's: taken for a clone of one, as the settings "
                          "ask for it" % (answer, name))
            return address, answer
    return None


def _make(driver, name, i2c, where, sleep_ms, ranges, report):
    """The driver's object, at the full scales that hold what is wanted."""
    got = []
    for wanted, available, unit in zip(ranges, (driver.ACCEL_RANGES, driver.GYRO_RANGES),
                                     ("g", "deg/s")):
        if wanted is not None and available:
            scales = sorted([row[0] for row in available])
            fits = ([g for g in scales if g >= wanted] or scales[-1:])[0]
            if fits != wanted:
                report.append("a full scale of %s %s is not one of the %s's (%s): %s is used" % (
                    wanted, unit, name, " ".join([str(g) for g in scales]), fits))
            got.append(fits)
        else:
            got.append(None)
    return driver(i2c, *where, sleep_ms=sleep_ms, accel_range_g=got[0], gyro_range_dps=got[1])


def _others(sensors, name, report):
    """Sensors that could be used as well, and how."""
    if name == "adxl345" and "itg3205" not in sensors:
        report.append("no gyro: lift the box for a flip, which is taken as 180 degrees")
    own = ("adxl345", "itg3205") if name in ("gy85", "adxl345") else (name,)
    for other in sensors:
        if other in catalogue.SENSORS and other not in own:
            report.append("%s is there, too: sensor %s in the settings takes it instead"
                          % (other, other))


def _complaint(i2c, sensor, sensors, strangers, report):
    if not report:
        report.append("nobody answers at %s: check power, SDA, SCL and pull-ups"
                      % " ".join(["0x%02x" % a for a in _addresses(i2c)]))
    elif sensor != "auto":
        report.append("the settings ask for %s, which is not there" % sensor)
    for name in sensors:
        if name in catalogue.NOT_DRIVEN:
            report.append("%s: %s" % (name, catalogue.NOT_DRIVEN[name]))
    if strangers and getattr(i2c, "spi", False):
        report.append("check power, SCK, MOSI, MISO and CS; MISO and MOSI may be swapped")
    elif strangers:
        report.append("two chips at one address answer like that, too: unplug one of them; a "
                      "clone is used where the settings name its sensor")
    elif not sensors and sensor == "auto" and len(report) and not report[0].startswith("nobody"):
        report.append("no accelerometer found")
    return report
