"""What the firmware writes in each scenario of power_cuts.py, by its own code, and what must be
on the flash however early it was cut off. Runs on MicroPython."""

import json
from array import array

from sixflip.capture import reader as capture_reader
from sixflip.capture.blocks import ACCEL, GYRO, TEMP
from sixflip.chips import catalogue
from sixflip.poses.placement import Placement
from sixflip.record.record import Record
from sixflip_device import flash_files
from sixflip_device.capture import meta as capture_meta
from sixflip_device.capture.store import CaptureStore
from sixflip_device.record import record_slots, saving
from sixflip_device.session import redo_session, sampling
from sixflip_device.session.session_values import Calibration, SessionRequest, SessionResult

MASK = ACCEL | GYRO | TEMP
POSES = 12
RECORDS = ("record_a.bin", "record_b.bin")
FULL = RECORDS + (flash_files.GOOD, flash_files.REFUSED)
P = [[1.01, 0.01, 0.02, 0.0], [-0.03, 0.99, 0.0, 0.0], [0.01, 0.02, 1.03, 0.0],
     [0.03, -0.2, 1.1, 1.0]]
REFUSED, OLD, NEW = 3, 7, 50  # sessions: one refused, the last one, the one now


class Imu:
    """As much of a driver as the records want."""

    sensor = "mpu6050"
    who_am_i = (0x68, 0x68)
    accel_range_g, gyro_range_dps = 2, 500
    accel_lsb_per_g, gyro_lsb_per_dps = 16384, 65.5
    accel_rail = gyro_rail = 32767
    has_gyro = has_temp = True
    temp_lsb_per_c = 340

    def metadata(self):
        return {"sensor": self.sensor, "who_am_i": self.who_am_i, "rate_hz": 100,
                "accel_lsb_per_g": self.accel_lsb_per_g,
                "gyro_lsb_per_dps": self.gyro_lsb_per_dps}


def as_chip(sensor):
    """From now on everything is of this sensor, at its widest ranges."""
    driver = catalogue.driver(sensor)
    Imu.sensor = sensor
    if len(catalogue.ids_of(sensor)):
        Imu.who_am_i = (min(catalogue.ids_of(sensor)),) * 2
    Imu.accel_range_g, Imu.accel_lsb_per_g, _ = driver.ACCEL_RANGES[-1]
    Imu.gyro_range_dps, Imu.gyro_lsb_per_dps, _ = driver.GYRO_RANGES[-1]


class Nothing:
    """An object to hang attributes on."""


class Events:
    def __init__(self):
        self.told = []

    def emit(self, event, **fields):
        self.told.append((event, fields))

    def error(self, what, expected="", **fields):
        self.told.append(("error", {"what": what}))


def unit_at(root):
    """A Firmware, as far as load_record, saving and redo_session look at one."""
    unit = Nothing()
    unit.events = Events()
    unit.board = Nothing()
    unit.board.root, unit.board.name, unit.board.unique_id = root, "cut", "00"
    unit.settings = {"g": 9.80665, "rate_hz": 100, "pose_samples": 50}
    unit.sensor = Nothing()
    unit.sensor.imu = Imu()
    unit.sensor.read_into = lambda sample: 0
    unit.record = unit.slot = unit.correction = unit.bias_dps = unit.request = None
    unit.first = True
    return unit


def record(session):
    r = Record()
    r.session = session
    r.chip, r.who_am_i = Imu.sensor, Imu.who_am_i
    r.accel_range_g, r.gyro_range_dps = Imu.accel_range_g, Imu.gyro_range_dps
    r.accel_lsb_per_g, r.gyro_lsb_per_dps = Imu.accel_lsb_per_g, Imu.gyro_lsb_per_dps
    r.temp_c = 25.0
    r.accel = {"P": [[x + session * 1e-3 for x in row] for row in P],
               "sigma_P": [[1e-5] * 4] * 4, "tilt_deg": 1.0, "tilt_spread_deg": 0.01,
               "residual_rms_g": 1e-4, "noise_g": 3e-3, "level": "tilt solved",
               "verdict": "good", "reason": "session %d" % session}
    r.gyro_bias = {"bias_dps": [0.5, -1.25, 2.0], "temp_c": 24.0}
    return r


def pose(k, n, first):
    return Placement(1 + k, first, n, [n * (k + 1)] * 7, [1.0] * 6, 10000 * n)


class Written:
    """One scenario, of a chip as "save1:lsm6dsox" (else an MPU6050): prepare() before, act() is
    what the power fails in.

    seen      sessions whose record was found in force after a cut
    may_stay  files that may be on the flash after a cut, and need not be
    """

    def __init__(self, scenario, samples):
        self.scenario, _, chip = scenario.partition(":")
        if chip:
            as_chip(chip)
        self.samples = samples
        self.seen = set()
        self.flushed = []      # (operations so far, poses that were on the flash by then)
        self.whole = {}        # session: the bytes of its capture when it was finished
        self.may_stay = (flash_files.REFUSED, flash_files.GOOD)

    # -- before

    def prepare(self, root):
        if self.scenario[:4] == "save":
            self.before = int(self.scenario[4:])
        elif self.scenario == "restore":
            self.before = 2
        else:
            self.before = 1
        for session in range(OLD - self.before + 1, OLD + 1):
            if self.has_captures():
                self.session(root, session, [])
                self.save(root, session)
            else:
                record_slots.RecordSlots(root).save(record(session))
        if self.has_captures():
            self.session(root, REFUSED, [], poses=2)
            self.save(root, REFUSED, "timed out")

    def has_captures(self):
        return self.scenario in ("session", "refused", "redo")

    # -- what the power fails in

    def act(self, root, log):
        self.flushed = []
        if self.scenario[:4] == "save":
            record_slots.RecordSlots(root).save(record(NEW))
        elif self.scenario == "restore":
            record_slots.RecordSlots(root).restore(lambda r: "")
        else:
            if self.scenario == "redo":
                self.redo(root, log)
            else:
                self.session(root, NEW, log, POSES if self.scenario == "session" else 5)
            self.save(root, NEW, "timed out" if self.scenario == "refused" else "complete")

    def session(self, root, number, log, poses=POSES):
        """What sampling.py does with the store."""
        unit = unit_at(root)
        meta = capture_meta.meta_bytes(unit, number)
        store = CaptureStore(root, meta, MASK, 20000)
        self.sample(store, number, log, poses, 0)

    def sample(self, store, number, log, poses, have):
        sample = array("h", [0] * 7)
        for k in range(poses):
            first = store.samples + 12
            for i in range(12 + self.samples):
                for axis in range(7):
                    sample[axis] = (number * 1009 + k * 31 + i * 7 + axis) % 30011
                store.add(10000, sample)
            store.pose(pose(k, self.samples, first))
            self.flushed.append((len(log), have + k + 1))
        store.finish(poses == POSES, [])

    def redo(self, root, log):
        """What redo_session.py and sampling.py do: the old capture copied, then a face more."""
        unit = unit_at(root)
        flash_files.remove(root + flash_files.REFUSED)  # of the good session, this time
        redo_session.session_number = lambda board: NEW
        request = redo_session.run(unit, SessionRequest(goes_on=True, face=0))
        if request is None:
            raise ValueError(unit.events.told)
        store = sampling.new_store(unit, request)[1]
        self.sample(store, NEW, log, 2, POSES - 2)

    def save(self, root, number, how="complete"):
        """What saving.py does; the capture's bytes are kept for comparison."""
        with open(root + flash_files.NEW, "rb") as f:
            self.whole[number] = f.read()
        unit = unit_at(root)
        if number == NEW:
            unit.slot, unit.record, _ = record_slots.RecordSlots(root).load(lambda r: "")
        session = SessionResult(number, how, "it ended", [], [], [], True)
        calibration = Calibration(record(number), "good", "fine", {}, {})
        saving.run(unit, session, calibration if how == "complete" else None)
        errors = [t for t in unit.events.told if t[0] == "error"]
        if errors:
            raise ValueError(errors)

    # -- after the cut

    def sessions(self, at):
        """Sessions whose record may be in force."""
        old = OLD if self.before else None
        if self.scenario == "restore":
            return (OLD, OLD - 1)
        if self.scenario == "refused":
            return (old,)
        return (old, NEW)

    def look(self, root, session, at, found):
        self.seen.add(session)
        if not self.has_captures():
            return
        captures = {}
        for name in (flash_files.GOOD, flash_files.REFUSED, flash_files.NEW):
            number, data = self.content(root + name, found)
            if number is not None:
                captures[number] = data
                if name == flash_files.NEW:
                    found.append(("leftover", "capture.new of session %d" % number))
                if name == flash_files.GOOD and number != session:
                    found.append(("capture", "capture.bin is of session %s, the record of %s"
                                  % (number, session)))
        if session not in captures:
            found.append(("capture", "the capture of the record in force is gone"))
        self.under_way(captures, found, at)

    def content(self, name, found):
        """(session, bytes) of a capture file; (None, b"") when there is none."""
        try:
            with open(name, "rb") as f:
                data = f.read()
        except OSError:
            return None, b""
        try:
            blocks = capture_reader.read(data)
        except ValueError as e:
            found.append(("capture", "%s: %s" % (name, e)))
            return None, b""
        number = json.loads(str(blocks.meta_bytes, "utf-8"))["session"]
        whole = self.whole.get(number)
        end = len(data) if blocks.truncated_at is None else blocks.truncated_at
        if whole is None or data[:end] != whole[:end]:
            found.append(("capture", "%s holds what nobody wrote" % name))
        return number, blocks

    def under_way(self, captures, found, at):
        """What was flushed before the cut is still there, unless a longer one was refused."""
        poses = 0
        for operations, there in self.flushed:
            if operations <= at:
                poses = there
        have = len(captures[NEW].placements) if NEW in captures else 0
        if have < poses and not (NEW not in captures and REFUSED in captures and
                                 len(captures[REFUSED].placements) >= poses):
            found.append(("last pose" if have == poses - 1 else "poses",
                          "%d of %d poses that were on the flash" % (have, poses)))
