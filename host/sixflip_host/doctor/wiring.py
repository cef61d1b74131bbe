"""What look_at_bus.py said, in findings: lines, chips, ranges, clock."""

import errno
import math

from ..calibrate.verify_files import newest_of
from .chips_on_bus import at_address, catalogued, magnetometers, shared_address
from .finding import Finding, fault, ok, warning

NOBODY = (0x7C, 0x00)           # reserved: no chip is there
CLOCK_OFF = 0.04                # of the sample clock; MPU-6050 PS 3.4, 6.6: 1 % by its PLL
ASKED_OFTEN = 2                 # times a new sample, for none to be missed
G_OFF = 0.2                     # METHOD 1: |scale - 1| beyond is refused
WIRES = "check the four wires: 3.3 V, GND, SDA and SCL on the pins in sixflip.json " \
    "(sixflip provision --pins sda=…,scl=…), the solder joints of the header"


def judge(said):
    """[Finding] of {name: values} as parse() gives them."""
    if "stopped" in said:
        return [fault("bus", "the firmware cannot open it: %s" % said["stopped"][0],
                      "sixflip provision --pins …, or --board …", True)]
    findings = settings(said) + lines(said)
    if any(one.unreachable for one in findings):
        return findings
    findings += chips(said)
    if "sensor" in said:
        findings += sensor(said) + clock(said) + gravity(said)
    return findings


def settings(said):
    name, wanted, bus, problems = said["settings"]
    if problems:
        return [warning("settings", "; ".join(problems), "sixflip provision with what you mean")]
    return [ok("settings", "%s, sensor %s, %s" % (name, wanted, bus))]


def lines(said):
    """Both lines of the bus must be high by themselves while nobody talks."""
    if "lines" not in said:
        return []
    sda, scl, *levels = said["lines"]
    pins = {"SDA (%s)" % sda: levels[0::2], "SCL (%s)" % scl: levels[1::2]}
    low = [name for name, (_, pulled_up) in pins.items() if not pulled_up]
    weak = [name for name, (alone, pulled_up) in pins.items() if pulled_up and not alone]
    if "sensor" in said and (low or weak):  # it was identified and set up: no line hangs
        return [_overruled(said, " and ".join(low + weak))]
    if low:
        return [fault("lines", "%s held low" % " and ".join(low),
                      "a short to ground, a chip without power, or a wire in the wrong hole: "
                      "unplug the sensor; if the line is high then, it is the sensor or its "
                      "cable", True)]
    if weak:
        return [fault("lines", "no pull-up on %s" % " and ".join(weak),
                      "the sensor is not connected or has no power (its board brings the "
                      "pull-ups); a bare chip needs 4.7 kΩ from each line to 3.3 V", True)]
    return [ok("lines", "SDA and SCL are high at rest")]


def _overruled(said, names):
    """A chip that answers says more of the bus than a line that was measured while idle."""
    sentence = "%s read low with the board's own pulls, but the %s answers" % (
        names, said["sensor"][1])
    if "lost" in said or "selftest" in said and said["selftest"][6]:
        return warning("lines", sentence, "transfers fail: its pull-ups are weak or missing; 4.7 "
                       "kΩ from each line to 3.3 V")
    return ok("lines", sentence + " and no transfer fails")


def chips(said):
    """Who answered, and who should have."""
    ids = said["ids"][0]
    if NOBODY in ids and isinstance(ids[NOBODY], bytes):
        return [fault("bus", "every address answers: SDA is low whatever is asked",
                      "SDA and GND or SDA and SCL touch; " + WIRES, True)]
    timeouts = [one for one in ids.values() if one == errno.ETIMEDOUT]
    if timeouts and len(timeouts) == len(ids):
        return [fault("bus", "every transfer times out: a line is stuck, or there are no pull-ups",
                      WIRES, True)]
    if not ids:     # on SPI nobody has an address
        there = [0]
    else:
        there = sorted({address for (address, _), one in ids.items() if isinstance(one, bytes)})
    asked = {address for address, _ in ids}
    others = [one for one in said["scan"][0] if one not in asked] \
        if isinstance(said["scan"][0], list) else []
    if not there and "sensor" not in said:
        more = "; something else answers at %s" % " ".join("0x%02x" % one for one in others) \
            if others else ""
        return [fault("chips", "nothing answers at %s%s" % (
            " ".join("0x%02x" % one for one in catalogued()), more), WIRES, True)]
    findings = shared_address(ids)
    if not findings:
        for address in catalogued():
            findings += at_address(ids, address)
    findings += magnetometers(ids)
    if "no sensor" in said and not any(one.state == "fault" for one in findings):
        findings.append(fault("chips", "; ".join(said["no sensor"][0]),
                              "sixflip provision --sensor auto, or wire the sensor that is asked "
                              "for", True))
    return findings


def sensor(said):
    """What the firmware makes of it."""
    kind, name, _, _, _, _, report = said["sensor"]
    findings = [ok("sensor", "%s: %s" % (kind, name))]
    for line in report:
        if "no gyro" in line:
            findings.append(warning("sensor", line,
                                    "a calibration without gyro assumes half turns"))
    if "lost" in said:
        findings.append(fault("sensor", "answers, then is lost: %s" % said["lost"][0],
                              "a loose wire or a weak supply; shorter wires; \"freq\": 100000 in "
                              "sixflip.json"))
    return findings


def clock(said):
    """Samples the chip makes by the board's clock, and samples the bus carries."""
    findings = []
    for chip, made, us, nominal, asked in said.get("ready", ()):
        whose = "the %s" % chip
        if not made or not us:
            findings.append(fault("clock",
                                  "%s makes no new samples: its readings are frozen" % whose,
                                  "take its power away for some seconds; if that does not help, "
                                  "it is broken"))
        elif asked > ASKED_OFTEN * made:    # else a slow bus missed some
            off = made * 1e6 / us / nominal - 1
            words = "%s makes %.1f samples a second, %.4g are meant (%+.1f %%)" % (
                whose, made * 1e6 / us, nominal, 100 * off)
            findings.append(ok("clock", words) if abs(off) <= CLOCK_OFF else warning(
                "clock", words, "its clock is off, as clones' are: timestamps come from the "
                "board, so rates are right, but its filter and noise are not those of the data "
                "sheet"))
    if "selftest" not in said:
        return findings
    fine, problems, reached, wanted, _, _, errors = said["selftest"]
    slow = [one for one in problems if one.startswith("too slow")]
    other = [one for one in problems if one not in slow]
    if slow:
        findings.append(fault("rate", "%.0f samples a second reached, %d are wanted" % (
            reached, wanted), "a faster bus (\"freq\": 400000 in sixflip.json) or a lower "
            "\"rate_hz\""))
    if other:
        findings.append(fault("samples", "; ".join(other), "take the sensor's power away for some "
                              "seconds; if that does not help, it is broken"))
    if errors:
        findings.append(warning("samples", "%d transfers failed in the self-test" % errors,
                                "shorter wires, a better supply, or \"freq\": 100000"))
    return findings or [ok("rate", "%.0f samples a second" % reached)]


def gravity(said):
    """At rest the length of the reading is 1 g, whatever the attitude: else the range is wrong."""
    if "means" not in said or not said["selftest"][4]:
        return []
    n, sums = said["means"]
    _, _, _, range_g, lsb, _, _ = said["sensor"]
    size = math.sqrt(sum((total / n) ** 2 for total in sums[:3])) / lsb if n else 0.0
    if abs(size - 1) <= G_OFF:
        return [ok("range", "%.3f g at rest at ±%d g" % (size, range_g))]
    half = math.log2(size) if size > 0 else math.inf
    if abs(half - round(half)) < 0.2 and 0 < abs(round(half)) <= 3:
        return [fault("range", "reads %.2f g at rest: its range is not the ±%d g it was set to" % (
            size, range_g), "a clone that ignores its range register, or another program that "
            "sets it; take its power away for some seconds, run nothing else on the bus")]
    return [fault("range", "reads %.2f g at rest" % size,
                  "a broken sensor, or it was moved: keep it still and try again")]


def record(said, slots):
    """Findings of what is in flash; slots: [(name, Record or the sentence why not)]."""
    readable = [one for _, one in slots if not isinstance(one, str)]
    if not readable:
        damaged = ["%s: %s" % (name, one) for name, one in slots]
        return [Finding("record", "warning" if damaged else "ok", "; ".join(damaged) or
                        "no correction in flash", "sixflip calibrate")]
    newest = newest_of(readable)
    if "sensor" in said:
        kind, _, who, _, lsb, _, _ = said["sensor"]
        if newest.chip != kind or abs(newest.accel_lsb_per_g - lsb) > 5.1e-4:
            return [fault("record", "the correction in flash is of a %s at %g counts per g, the "
                          "sensor is a %s at %g: the board refuses it" % (
                              newest.chip, newest.accel_lsb_per_g, kind, lsb),
                          "sixflip calibrate")]
        if tuple(newest.who_am_i) != tuple(who):
            return [fault("record", "the correction in flash is of a sensor with who_am_i %s, "
                          "this one has %s" % (_ids(newest.who_am_i), _ids(who)),
                          "the sensor was swapped: sixflip calibrate")]
    return [ok("record", "number %d, verdict %s" % (
        newest.sequence, newest.accel["verdict"] if newest.accel else "none"))]


def _ids(who):
    return "/".join("0x%02x" % one for one in who)
