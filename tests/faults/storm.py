"""One calibration over a failing bus, from the first power-up to the stream after the second,
and what became of it: the right correction, or a refusal with its reason.

The firmware is the real one, on simulated chips and a virtual clock. 25 samples a second and
poses of two seconds are settings that a user may choose as well.
"""

import copy
import math
import random
import tempfile
from pathlib import Path

import numpy as np

from sixflip import STANDARD_G
from sixflip.chips import catalogue
from sixflip.record import correction_record
from sixflip_device import power_up, settings
from sixflip_sim import worlds
from tests.faults.reacting_hand import ReactingHand
from tests.worlds.simulated_board import SimulatedBoard, TooLong

SETTINGS = {"rate_hz": 25, "pose_samples": 50, "rest_s": 6, "grace_ms": 0, "timeout_s": 40,
            "stream_hz": 10}
WORLD = {"order": [], "first_rest_s": 1.0, "move_s": 1.2, "tilt_deg": 2.0,
         "flip_error_deg": 0.0}
SENSORS = ({"sensor": "mpu6050"}, {"sensor": "gy85"}, {"sensor": "mpu6050", "who_am_i": 0x70})
MORE = tuple({"sensor": name} for name in catalogue.SENSORS if name not in worlds.SEEN)
FLAVOURS = ("rp2", "esp32", "stm32", "soft", "linux")
PATIENCE_S = 400.0      # then the person has had enough,
LIMIT_S = 500.0         # and a firmware that does not listen hangs
STREAMED = 40           # samples, then the board is stopped
WAIT_S = 30.0           # for a sensor that is not there

# A correction called good is wrong beyond these.
ACCEL_MG = 3.0          # RMS over all directions, as in tests/worlds/verdict_table.py,
UNSURE_MG = 1.0         # and where it is more than this,
SIGMAS = 5.0            # any of the twelve numbers in its own standard errors
GYRO = 0.03             # largest element of C A - 1
BIAS_DPS = 0.15         # of the gyro at the rest after power-up


class StormBoard(SimulatedBoard):
    """Stops when enough was streamed, or when the firmware has looked for its sensor in vain."""

    def __init__(self, world, root, hand):
        SimulatedBoard.__init__(self, world, root, limit_s=LIMIT_S)
        self.hand = hand
        self.steps = []         # (transaction at which it begins, event)
        self.streamed = 0
        self.lost = False       # the last thing heard was an error

    def write_line(self, text):
        SimulatedBoard.write_line(self, text)
        event = self.events[-1]
        self.steps.append((self.world.i2c.transactions, event))
        self.streamed += event["event"] == "sample"
        self.lost = event["event"] == "error"
        if self.hand:
            self.hand.see(event)

    def read_line(self):
        now = self.world.clock.now_us() / 1e6
        given_up = self.lost and now - self.events[-1]["at_s"] > WAIT_S
        alone = self.hand is None and self.named("calibrating")
        if self.streamed > STREAMED or given_up or alone or now > PATIENCE_S:
            return '{"cmd": "stop"}'
        return None


class Outcome:
    """word: "good", "doubtful", "refused", "no sensor" or "wrong"; reason: a sentence, of a
    wrong one what is wrong with it. error_mg, gyro: of the correction in force, None: none.
    sigmas: the error in the record's own standard errors. boards: of both power-ups."""

    def __init__(self):
        self.word = self.reason = ""
        self.error_mg = self.sigmas = self.gyro = self.record = None
        self.boards = []


def calibration(seed=1, sensor=0, flavour="rp2", faults=(), faults_later=(), watch=None):
    """The Outcome of a calibration and the power-up after it.

    sensor: index into SENSORS; faults, faults_later: of the bus (sixflip_sim/faults.py), in the
    first and in the second power-up; watch: a list for the numbers of the transactions that
    write in the first.
    """
    spec = dict(WORLD, seed=seed, flavour=flavour, **(SENSORS + MORE)[sensor])
    return powered_again(calibrated(spec, faults, watch), spec, faults_later)


def calibrated(spec, faults=(), watch=None):
    """(Outcome, {name: bytes} of the flash) after the first power-up in a world."""
    outcome = Outcome()
    with tempfile.TemporaryDirectory() as root:
        first = worlds.make(dict(spec, faults=list(faults)))
        if watch is not None:
            _watch_writes(first.i2c, watch)
        _power_on(outcome, StormBoard(first, root, ReactingHand(first)))
        _judge(outcome, first, Path(root))
        return outcome, {path.name: path.read_bytes() for path in Path(root).iterdir()}


def powered_again(before, spec, faults=()):
    """The Outcome of what calibrated() returned, which stays as it is, and a power-up more."""
    outcome, files = copy.copy(before[0]), before[1]
    outcome.boards = list(outcome.boards)
    with tempfile.TemporaryDirectory() as root:
        for name, data in files.items():
            (Path(root) / name).write_bytes(data)
        later = worlds.make(dict(spec, first_rest_s=400.0, faults=list(faults)))
        _power_on(outcome, StormBoard(later, root, None))
        _judge_later(outcome, later)
    return outcome


def _watch_writes(i2c, numbers):
    write = i2c.writeto_mem

    def watched(address, register, data, addrsize=8):
        numbers.append(i2c.transactions)
        write(address, register, data)

    i2c.writeto_mem = watched


def _power_on(outcome, board):
    outcome.boards.append(board)
    values, problems = settings.merge(SETTINGS)
    try:
        power_up.run(board, values, problems)
    except TooLong:
        _wrong(outcome, "still running after %d s" % LIMIT_S)
    except Exception as e:  # noqa: BLE001 - a storm has to be told from a mistake of ours
        _wrong(outcome, "the firmware stopped: %r" % e)


def _wrong(outcome, what):
    outcome.word, outcome.reason = "wrong", what


def _judge(outcome, world, root):
    """After the first power-up."""
    if outcome.word:
        return
    board = outcome.boards[0]
    solved = board.named("solved")
    if not solved:
        errors = board.named("error")
        outcome.word = "no sensor"
        outcome.reason = errors[-1]["what"] if errors else ""
    else:
        outcome.word, outcome.reason = solved[-1]["verdict"], solved[-1]["reason"]
    if not outcome.reason:
        _wrong(outcome, "no reason was given")
    kept = sorted(root.glob("record_?.bin"))
    saved = [e for e in board.named("saved") if e["written"]]
    if len(kept) != len(saved) or bool(saved) != (outcome.word in ("good", "doubtful")):
        _wrong(outcome, "%d records for the verdict %s" % (len(kept), outcome.word))
    elif kept:
        outcome.record = correction_record.decode(kept[0].read_bytes())
        compare(outcome, world.truth, outcome.record)


def compare(outcome, truth, record):
    """The record against what was put into the world."""
    P = np.array(record.accel["P"])
    C, d = P[:3, :3].T, P[3, :3]
    A, b = np.array(truth.accel_matrix), np.array(truth.accel_bias)
    off = np.sum((C @ A - np.eye(3)) ** 2) / 3 + np.sum(((C @ b + d) / STANDARD_G) ** 2)
    outcome.error_mg = 1e3 * math.sqrt(off)
    right = np.linalg.inv(A)
    true_P = np.vstack([right.T, -right @ b])
    sigma = np.array([row[:3] for row in record.accel["sigma_P"]], float)
    outcome.sigmas = float(np.max(np.abs(P[:, :3] - true_P) / sigma))
    if record.gyro is not None:
        W = np.array(record.gyro["P"])
        outcome.gyro = float(np.abs(W[:3].T @ np.array(truth.gyro_matrix) - np.eye(3)).max())
    if outcome.word != "good":
        return
    if not outcome.error_mg <= ACCEL_MG:
        _wrong(outcome, "called good with an error of %.2f mg" % outcome.error_mg)
    elif not (outcome.sigmas <= SIGMAS or outcome.error_mg <= UNSURE_MG):
        _wrong(outcome, "called good, but off by %.1f times its own uncertainty (%.2f mg)"
               % (outcome.sigmas, outcome.error_mg))
    elif record.gyro is not None and record.gyro["verdict"] == "good" and \
            not outcome.gyro <= GYRO:
        _wrong(outcome, "gyro called good with an error of %.3f" % outcome.gyro)


def _judge_later(outcome, world):
    """After the second: the same correction is in force, what it says of the rest is true."""
    if outcome.word == "wrong":
        return
    board = outcome.boards[1]
    for rest in board.named("rest"):
        if rest["bias"] == "measured now":
            true = np.degrees(world.truth.gyro_bias)
            off = float(np.max(np.abs(np.array(rest["bias_dps"]) - true)))
            if not off <= BIAS_DPS:
                _wrong(outcome, "bias measured at rest is off by %.3f deg/s" % off)
    ready = board.named("ready")
    if not ready and not board.named("error"):
        _wrong(outcome, "neither a stream nor an error after the second power-up")
    seen = {str((e["sensor"], e["who_am_i"])) for b in outcome.boards for e in b.named("hello")
            if e["sensor"]}
    if len(seen) > 1:
        return  # a GY-85 whose gyro is gone is an ADXL345, and its record another sensor's
    if ready and outcome.word in ("good", "doubtful") and not ready[0]["corrected"]:
        _wrong(outcome, "the saved record is not in force after the second power-up")
    if ready and outcome.word == "good":
        _judge_stream(outcome, board)


def _judge_stream(outcome, board):
    """Corrected samples at rest have the length of g; a torn one among them may not."""
    lengths = [math.sqrt(sum(x * x for x in e["a"])) / STANDARD_G for e in board.named("sample")
               if e.get("a")]
    if len(lengths) <= STREAMED:
        if not board.named("error"):
            _wrong(outcome, "%d samples were streamed" % len(lengths))
    elif not abs(sorted(lengths)[len(lengths) // 2] - 1.0) <= 5e-3:
        _wrong(outcome, "the stream shows %.4f g" % sorted(lengths)[len(lengths) // 2])


def weather(seed):
    """(sensor, flavour, faults, faults_later, names of their kinds) of one random storm."""
    rng = random.Random(seed)
    sensor = rng.randrange(len(SENSORS))
    faults, later = [], []
    kinds = rng.sample(KINDS, rng.choice((1, 1, 2, 3)))
    for kind in kinds:
        for into, seconds in ((faults, 75.0), (later, 15.0)):
            into += [_fault(rng, kind, seconds, sensor) for _ in range(rng.choice((1, 2, 4)))]
    flavour = rng.choice(FLAVOURS)
    if rng.random() < NOISY:
        kinds.append("noise")
        faults.append(_fault(rng, "noise", 75.0, sensor))
        later.append(_fault(rng, "noise", 15.0, sensor))
    return sensor, flavour, faults, later, kinds


KINDS = ("nak", "data_nak", "timeout", "stuck_sda", "reset", "sleep", "frozen", "unplugged",
         "wrong_id", "torn", "garbled", "duplicate", "late")
NOISY = 0.15            # share of the storms, beside these kinds


def _fault(rng, kind, seconds, sensor):
    """Once at any time, or now and then."""
    fault = {"kind": kind, "seed": rng.randrange(1 << 16)}
    if rng.random() < 0.5:
        fault["at_ms"] = int(1000 * rng.uniform(0, seconds))
        fault["count"] = rng.choice((1, 1, 2, 5, 20))
    else:
        rare = kind in ("reset", "sleep", "frozen", "unplugged", "stuck_sda")
        fault["rate"] = 10 ** rng.uniform(-4, -3 if rare else -1)
    if kind in ("frozen", "unplugged") and rng.random() < 0.9:
        fault["for_ms"] = int(10 ** rng.uniform(1, 4))
    elif kind == "stuck_sda":
        fault["pulses"] = rng.randint(1, 9)
    elif kind == "late":
        fault["us"] = int(10 ** rng.uniform(3, 5.5))
    elif kind == "torn":
        fault["byte"] = rng.randint(1, 13)
    elif kind == "garbled":
        fault["byte"], fault["bits"] = rng.randint(0, 13), rng.randint(1, 255)
    elif kind == "noise":
        fault["counts"] = int(10 ** rng.uniform(0, 4))
    elif kind == "wrong_id":
        fault["value"] = rng.choice((0x00, 0xFF, 0x70, 0x68, 0xE5, rng.randrange(256)))
    if sensor == 1 and rng.random() < 0.5:
        fault["address"] = rng.choice((0x53, 0x68))
    return fault


def storm(seed, instead=None):
    """(Outcome, kinds of faults) of one random storm. instead: another sensor than is drawn, its
    index in SENSORS + MORE."""
    sensor, flavour, faults, later, kinds = weather(seed)
    sensor = sensor if instead is None else instead
    for fault in faults + later if instead is not None else ():
        fault.pop("address", None)
    return calibration(seed, sensor, flavour, faults, later), kinds


# Through a whole calibration, each read with this probability.
THROUGHOUT = ("noise", "late", "duplicate", "torn", "garbled", "nak", "timeout")
RATES = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3)


def throughout(kind, rate, seed):
    """The Outcome of a calibration all of whose reads are hit at a rate, and of the power-up
    after it, likewise."""
    rng = random.Random("%s %s %s" % (kind, rate, seed))
    sensor = seed % len(SENSORS)
    hit = []
    for _ in range(2):
        fault = _fault(rng, kind, 75.0, sensor)
        for once in ("at_ms", "count", "address"):
            fault.pop(once, None)
        hit.append(dict(fault, rate=rate))
    return calibration(seed, sensor, rng.choice(FLAVOURS), hit[:1], hit[1:])
