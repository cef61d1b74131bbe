"""A MicroPython for the virtual board: found on PATH, or Debian's package unpacked without root.

`make micropython` calls this file. Nothing is installed: the package and the libraries it
needs are unpacked into the cache, and a wrapper starts it with the loader that came along.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from ..errors import NoBoard, SixflipError
from . import debian_packages
from .debian_packages import cache_dir

OLDEST = (1, 21)
SUITE = "trixie"  # the oldest Debian whose MicroPython (1.25) has the vfs module
PACKAGES = ("micropython", "libc6", "libffi8", "libmbedcrypto16", "libmbedtls21", "libmbedx509-7")
WRAPPER = """#!/bin/sh
here=$(dirname "$(readlink -f "$0")")
lib=$(echo "$here"/usr/lib/*-linux-*)
loader=$(echo "$lib"/ld-linux*.so.*)
exec "$loader" --library-path "$lib" "$here/usr/bin/micropython" "$@"
"""
MISSING = ("no MicroPython %d.%d or newer on this machine: install it (Debian 13: apt install "
           "micropython) or run `make micropython`" % OLDEST)


def version(executable):
    """(major, minor) of a MicroPython executable, or None when it is not one."""
    try:
        answer = subprocess.run(
            [str(executable), "-c", "import sys; print(sys.implementation)"],
            capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)
    except (OSError, subprocess.TimeoutExpired):
        return None
    match = re.search(r"name='micropython', version=\((\d+), (\d+)", answer.stdout)
    return tuple(map(int, match.groups())) if match else None


def find():
    """Path of a usable MicroPython, or None. A wrong SIXFLIP_MICROPYTHON is an error."""
    named = os.environ.get("SIXFLIP_MICROPYTHON")
    if named:
        its_version = version(named)
        if its_version is None or its_version < OLDEST:
            raise NoBoard("SIXFLIP_MICROPYTHON=%s is not a MicroPython %d.%d or newer"
                          % ((named,) + OLDEST))
        return named
    for candidate in (shutil.which("micropython"), cache_dir() / "micropython" / "micropython"):
        if candidate and os.path.exists(candidate) and (version(candidate) or (0, 0)) >= OLDEST:
            return str(candidate)
    return None


def unpack(work, target):
    """Download and unpack the packages below work, then move them to target in one step."""
    debian_packages.prepare(work, SUITE, "install MicroPython %d.%d or newer by hand and name "
                            "it in SIXFLIP_MICROPYTHON" % OLDEST)
    debian_packages.unpack(work, PACKAGES)
    wrapper = work / "root" / "micropython"
    wrapper.write_text(WRAPPER)
    wrapper.chmod(0o755)
    if (version(wrapper) or (0, 0)) < OLDEST:
        raise SixflipError("the unpacked MicroPython does not start on this machine")
    if target.exists():
        shutil.rmtree(target)
    os.rename(work / "root", target)


def fetch(say=print):
    """Path of a MicroPython, fetched when none is found; SixflipError when it cannot be had."""
    path = find()
    if path:
        return path
    if not debian_packages.can_unpack():
        raise SixflipError("there is no apt-get and dpkg here to unpack one with; "
                           "put MicroPython %d.%d or newer on PATH" % OLDEST)
    cache = cache_dir()
    cache.mkdir(parents=True, exist_ok=True)
    say("fetching MicroPython (Debian %s) into %s" % (SUITE, cache / "micropython"))
    work = Path(tempfile.mkdtemp(prefix="micropython-", dir=cache))
    try:
        unpack(work, cache / "micropython")
    except subprocess.SubprocessError as error:
        raise SixflipError("unpacking MicroPython failed: %s" % error) from None
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return str(cache / "micropython" / "micropython")


def main():
    try:
        path = fetch()
    except SixflipError as error:
        print("sixflip: %s" % error, file=sys.stderr)
        return error.exit_code
    print("MicroPython %d.%d: %s" % (version(path) + (path,)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
