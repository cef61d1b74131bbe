"""Power cuts at every block operation of what the firmware writes, on a real file system:

    micropython power_cuts.py lfs2|fat SCENARIO WAYS EVERY SAMPLES [twice]

SCENARIO: save0..save3 (a record, with so many before it), restore, session (a second session's
capture and its record), refused (one that times out), redo (a face again: the capture before is
copied); with ":lsm6dsox" behind it that chip's. WAYS: "whole" operations are done or not;
"halves": torn ones leave old and new;
"data": garbage too, but of FAT's sectors not in those of its table and root folder; "all":
everywhere. EVERY: each n-th cut only; SAMPLES: of a pose; twice: the power fails once more, at
each operation of the mending. After each cut the flash is mounted again, the firmware's own
power-up looks at it, and the next save must work. Prints JSON lines: a "loss" for what should
not be, at the end {"cuts", "operations", ...}.
"""

import json
import os
import struct
import sys

HERE = __file__[: __file__.rindex("/")] if "/" in __file__ else "."
ROOT = HERE + "/../.."
sys.path[:0] = [HERE, ROOT + "/shared", ROOT + "/device"]

import vfs  # noqa: E402
from cut_flash import ERASE, SYNC, WAYS, Cuts, Random, Recorded  # noqa: E402
from written import FULL, Written, record, unit_at  # noqa: E402

from sixflip_device import flash_files  # noqa: E402
from sixflip_device.record import load_record, record_slots  # noqa: E402

FLASH = "/flash"
SHAPES = {"lfs2": (64, 4096, False), "fat": (512, 512, True)}
BYSTANDERS = {"main.py": b"# starts the firmware\n" * 40, "sixflip.json": b'{"rate_hz": 100}'}


def file_system(kind, device, new=False):
    made = vfs.VfsLfs2 if kind == "lfs2" else vfs.VfsFat
    if new:
        made.mkfs(device)
    return made(device)


def on(kind, device, act):
    """act(root) with the device mounted; unmounted afterwards whatever happens."""
    vfs.mount(file_system(kind, device), FLASH)
    try:
        return act(FLASH + "/")
    finally:
        vfs.umount(FLASH)


def files(root):
    """{name: size}, folders too."""
    try:
        return {entry[0]: entry[3] for entry in os.ilistdir(root)}
    except UnicodeError:
        raise OSError("names that are none")


def bystanders(root):
    for name in BYSTANDERS:
        with open(root + name, "wb") as f:
            f.write(BYSTANDERS[name])


def spared(root):
    """"" or which file that nobody was writing has suffered."""
    for name in BYSTANDERS:
        try:
            with open(root + name, "rb") as f:
                if f.read(4096) != BYSTANDERS[name]:
                    return "%s has changed" % name
        except OSError as e:
            return "%s cannot be read: %s" % (name, e)
    return ""


def first_data(boot):
    """Number of the first sector behind FAT's tables and root folder, by its boot sector."""
    size, _, reserved, tables, entries = struct.unpack_from("<HBHBH", boot, 11)
    return reserved + tables * struct.unpack_from("<H", boot, 22)[0] + 32 * entries // size


class Run:
    """One scenario on one file system."""

    def __init__(self, kind, scenario, samples):
        self.kind = kind
        self.written = Written(scenario, samples)
        blocks, size, bare = SHAPES[kind]
        device = Recorded(blocks, size, bare)
        file_system(kind, device, new=True)
        on(kind, device, self._prepare)
        self.before = device.image()
        self.first_data = 0 if kind == "lfs2" else first_data(device.block(0))
        device.log = []
        on(kind, device, lambda root: self.written.act(root, device.log))
        self.device = device
        self.clean = {}
        for done in (False, True):  # what a flash is like that nobody cut
            base = self.before if not done else device.image()
            self.clean[done] = self._tidy(Recorded(blocks, size, bare, base))

    def _prepare(self, root):
        bystanders(root)
        self.written.prepare(root)

    def _tidy(self, device):
        """After a power-up and one more save: (names, free bytes)."""
        self.power_up(device)
        on(self.kind, device, self._save_again)
        return on(self.kind, device, lambda root: (sorted(files(root)),
                                                   flash_files.free_bytes(root)))

    def _power_up(self, root):
        unit = unit_at(root)
        load_record.run(unit)
        return unit

    def _save_again(self, root):
        """The next calibration's save, and what a power-up makes of it."""
        record_slots.RecordSlots(root).save(record(99))
        unit = self._power_up(root)
        return unit.record is not None and unit.record.session == 99

    def power_up(self, device):
        return on(self.kind, device, self._power_up)

    def look(self, device, at):
        """What is wrong after a cut before operation `at`: a list of (kind, sentence)."""
        found = []
        try:
            unit = self.power_up(device)
        except OSError as e:
            return [("mount", "no file system: %s" % e)]
        session = None if unit.record is None else unit.record.session
        if session not in self.written.sessions(at):
            found.append(("record", "the record in force is of session %s" % session))
        on(self.kind, device, lambda root: self.written.look(root, session, at, found))
        harm = on(self.kind, device, spared)
        if harm:
            found.append(("bystander", harm))
        try:
            if not on(self.kind, device, self._save_again):
                found.append(("save", "the next record is not in force"))
        except OSError as e:
            found.append(("save", "the next save fails: %s" % e))
        try:
            names, free = on(self.kind, device, lambda root: (
                files(root), flash_files.free_bytes(root)))
        except OSError as e:
            found.append(("mount", "the folder cannot be listed: %s" % e))
            return found
        strange = [n for n in names if n not in FULL and n not in BYSTANDERS]
        if strange:
            found.append(("leftover", "files %s" % strange))
        least = min([self.clean[done][1] for done in self.clean])
        spent = sum([names.get(n, 0) + 4096 for n in self.written.may_stay])
        if free is None or free < least - spent:
            found.append(("space", "%s bytes free, %d without a cut" % (free, least)))
        return found


class Tally:
    """Tries what is wrong after cuts; every loss is printed."""

    def __init__(self, run, ways):
        self.run = run
        self.ways = ways
        self.random = Random(1)
        self.cuts = 0
        self.losses = {}

    def look(self, device, at, **where):
        self.cuts += 1
        for what, sentence in self.run.look(device, at):
            self.losses[what] = self.losses.get(what, 0) + 1
            print(json.dumps(dict(where, loss=what, at=at, **{"is": sentence})))

    def each(self, cuts, every=1):
        """(device, operation, how) of every cut."""
        while True:
            kind = cuts.kind()
            if cuts.done % every == 0 or kind is None:
                for how in self._ways(cuts):
                    yield cuts.after_cut(how, self.random), cuts.done, how, kind == ERASE
            if kind is None:
                return
            cuts.advance()

    def _ways(self, cuts):
        if cuts.kind() in (SYNC, None):
            return WAYS["whole"]
        if self.ways == "data" and cuts.block_number() < self.run.first_data:
            return WAYS["halves"]
        return WAYS[self.ways]

    def everywhere(self, every, twice):
        run = self.run
        for device, at, how, erase in self.each(Cuts(dict(run.before), run.device.log,
                                                     run.device), every):
            if twice:
                self.again(device, at)
            else:
                self.look(device, at, torn=how, erase=erase)

    def again(self, device, at):
        """The power-up after a cut, cut as well."""
        like = Recorded(device.blocks, device.size, device.bare, device.image())
        try:
            self.run.power_up(like)
        except OSError:
            return  # that the file system is gone is counted where it was cut once
        for second, then, how, erase in self.each(Cuts(device.image(), like.log, device)):
            self.look(second, at, then=then, torn=how, erase=erase)


def main(kind, scenario, ways, every, samples, twice=""):
    run = Run(kind, scenario, int(samples))
    tally = Tally(run, ways)
    tally.everywhere(int(every), bool(twice))
    print(json.dumps({"fs": kind, "scenario": scenario, "ways": ways, "cuts": tally.cuts,
                      "operations": len(run.device.log), "losses": tally.losses,
                      "seen": sorted([str(s) for s in run.written.seen])}))


main(*sys.argv[1:])
