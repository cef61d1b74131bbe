"""Link to a board over a serial port: what the board is, and the files on it."""

import base64
import contextlib
import hashlib
from pathlib import PurePosixPath

from ..errors import NoBoard, SixflipError
from .board_answers import NoSpace, parse
from .board_schema import ANSWERS
from .on_board_scripts import STAGED, UPDATE, script
from .raw_repl import WHOLE_S, RawRepl

FILES_S = 60.0  # of silence while it hashes every file it has, or moves them
LONGEST_S = 300.0  # a full flash read through a UART at 115200 Bd takes two minutes
SLOWEST = 2000  # bytes of a file a second, of which a UART at 115200 Bd carries four times as many
LONGEST_FILE = 1 << 25  # bytes of a file in base64: no board's flash is larger
CHUNK = 1024
BASE64 = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=\r\n\x04"


def safe_name(name):
    """True for a relative name below the folder it is kept in; names from boards are untrusted."""
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts and not (
        set(name) & set("\\:\0\r\n"))


class MpremoteLink(RawRepl):
    """A RawRepl that knows the board's particulars and files: they are read, written whole or not
    at all, and removed. Every method raises NoBoard as a RawRepl's do."""

    def version(self):
        """(MicroPython's version, what the board calls itself), as text."""
        printed = self.run("import os\ntry:\n u = os.uname()\n print((u[3], u[4]))\nexcept "
                           "AttributeError:\n import sys\n print((sys.version, sys.platform))\n",
                           "asking for its version")
        return parse(self.port, printed, ANSWERS["version"])

    def platform(self):
        """sys.platform of the board: rp2, esp32, pyboard, linux …"""
        return parse(self.port, self.run("import sys\nprint(repr(sys.platform))",
                                         "asking for its version"), ANSWERS["platform"])

    def mpy(self):
        """sys.implementation._mpy: format and architecture of the .mpy files it loads, or None."""
        return parse(self.port, self.run(
            "import sys\nprint(repr(getattr(sys.implementation, '_mpy', None)))",
            "asking for its version"), ANSWERS["mpy"])

    def board_id(self):
        """machine.unique_id() in hex; "board" where the port has none."""
        printed = self.run("import binascii\ntry:\n import machine\n print(binascii.hexlify("
                           "machine.unique_id()).decode())\n"
                           "except (ImportError, AttributeError):\n print()\n",
                           "asking for its id").decode("ascii", "replace").strip()
        return "".join(c for c in printed if c in "0123456789abcdef")[:32] or "board"

    # -- files

    def files(self, hashed=None, alone=False):
        """{name: (size, sha256 in hex)} of all files; with `hashed` only those are hashed.

        alone: list only those, and each has to be there.
        """
        wanted = None if hashed is None else set(hashed)
        printed = self.run(script("list_files", wanted=wanted, staged=STAGED, alone=alone),
                           "listing its files", timeout=FILES_S)
        files = {}
        for line in printed.splitlines():
            name, size, digest = parse(self.port, line, ANSWERS["file"])
            if safe_name(name):
                files[name] = (size, digest)
        missing = set(wanted or ()) - set(files) if alone else ()
        if missing:
            raise NoBoard("%s: the board says nothing of %s, expected its size and hash"
                          % (self.port, ", ".join(sorted(missing))))
        return files

    def get(self, name, progress=None, size=None):
        """The bytes of a file. progress(done bytes) is called on the way; size: where it is
        known, so that no file takes longer than so many bytes may."""
        text = bytearray()

        def take(piece):
            if piece not in BASE64:
                self.raw = False
                raise NoBoard("%s: %s arrived damaged; try again" % (self.port, name))
            text.extend(piece.replace(b"\x04", b""))
            if progress and piece == b"\n":
                progress(len(text) * 3 // 4)

        whole = LONGEST_S if size is None else min(LONGEST_S, WHOLE_S + size / SLOWEST)
        self.run(script("send_file", name=name), "reading " + name, take, most=LONGEST_FILE,
                 whole=whole)
        try:
            data = base64.b64decode(bytes(text).replace(b"\r", b"").replace(b"\n", b""),
                                    validate=True)
        except ValueError:
            raise NoBoard("%s: %s arrived damaged; try again" % (self.port, name)) from None
        size, digest = self.files([name], alone=True)[name]
        if len(data) != size or hashlib.sha256(data).hexdigest() != digest:
            raise NoBoard("%s: %s arrived damaged; try again" % (self.port, name))
        return data

    def put(self, name, data, progress=None):
        """Write NAME.new, compare its hash on the board, then rename it to NAME."""
        self.write(name + ".new", name, data, progress)
        self.run(script("replace_file", name=name), "copying " + name)

    def stage(self, name, data, progress=None):
        """Write NAME below STAGED, where it waits for commit()."""
        self.write(STAGED + name, name, data, progress)

    def commit(self, names, stale=()):
        """Every file that was staged takes its place, and the stale files go: all or nothing,
        even if the power fails meanwhile, for main.py goes on with it at the next power-up."""
        self.put(UPDATE, script("put_in_place", names=names, stale=list(stale),
                                staged=STAGED).encode())
        self.finish()

    def finish(self):
        """Go on with a commit that was cut off."""
        self.run("exec(open(%r).read())" % UPDATE, "putting the files in their places",
                 timeout=FILES_S)

    def write(self, fresh, name, data, progress=None):
        """Write the file `fresh`, for NAME, and compare its hash on the board."""
        doing = "copying " + name
        parents = [str(p) for p in reversed(PurePosixPath(fresh).parents) if str(p) != "."]
        if parents:
            self.run(script("make_folders", folders=parents), doing)
        try:
            self.run("f = open(%r, 'wb')\nw = f.write" % fresh, doing)
            for start in range(0, len(data), CHUNK):
                self.run("w(%r)" % data[start:start + CHUNK], doing)
                if progress:
                    progress(min(start + CHUNK, len(data)))
            self.run("f.close()", doing)
        except NoSpace:
            with contextlib.suppress(SixflipError):
                self.run("f.close()", doing)
            with contextlib.suppress(SixflipError):
                self.remove(fresh)
            raise
        if self.files([fresh], alone=True)[fresh][1] != hashlib.sha256(data).hexdigest():
            self.remove(fresh)
            raise NoBoard("%s: %s arrived damaged on the board; the old one is still in force, "
                          "try again" % (self.port, name))

    def remove(self, name):
        """Remove a file."""
        self.run("import os\nos.remove(%r)" % name, "removing " + name)
