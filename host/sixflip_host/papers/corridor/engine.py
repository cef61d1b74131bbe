"""rbpf-slam of MRPT: found on PATH, or Debian's package unpacked without root, for this alone.

The package's dependencies are those of a dozen programs with windows. Only the libraries that
rbpf-slam itself loads stay in the cache, in one folder beside the loader that came along.
"""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from ...errors import NoBoard, SixflipError
from ...virtual import debian_packages

SUITE = "bookworm"          # MRPT 2.5.8; trixie's 2.14.7 reads the same logs
PACKAGE = "mrpt-apps"
# Libraries are in packages called so; what is not loaded by rbpf-slam is not even downloaded
# where it is large: drivers of screens, interpreters, tables.
LIBRARIES = re.compile(r"lib|ocl-icd|zlib1g")
LARGE = re.compile(r"libllvm|libgl1-mesa-dri|libz3|libperl|libpython|.*-data$|.*-common$"
                   r"|libsystemd-shared|libopencv-contrib|libcap2-bin|.*-plugins$")
WRAPPER = """#!/bin/sh
here=$(dirname "$(readlink -f "$0")")
exec "$here"/lib/ld-linux* --library-path "$here/lib" "$here/lib/rbpf-slam" "$@"
"""
INSTEAD = "install MRPT's rbpf-slam by hand (Debian: apt install mrpt-apps)"
MISSING = "no rbpf-slam on this machine: " + INSTEAD


def find():
    """Path of a rbpf-slam on PATH or in the cache, or None."""
    for candidate in (shutil.which("rbpf-slam"), kept() / "rbpf-slam"):
        if candidate and os.path.exists(candidate):
            return str(candidate)
    return None


def kept():
    """The folder of the cache it is unpacked into."""
    return debian_packages.cache_dir() / "rbpf-slam"


def fetch(say=print):
    """Path of a rbpf-slam, fetched when none is found; NoBoard or SixflipError where it cannot
    be had."""
    program = find()
    if program:
        return program
    if not debian_packages.can_unpack():
        raise NoBoard(MISSING + "; there is no apt-get and dpkg here to unpack one with")
    target = kept()
    target.parent.mkdir(parents=True, exist_ok=True)
    say("fetching MRPT's rbpf-slam (Debian %s, 120 MB) into %s" % (SUITE, target))
    work = Path(tempfile.mkdtemp(prefix="rbpf-slam-", dir=target.parent))
    try:
        unpack(work)
        if not target.exists():
            os.rename(work / "engine", target)
    except (subprocess.SubprocessError, OSError) as error:
        raise SixflipError("unpacking rbpf-slam failed: %s; %s" % (error, INSTEAD)) from None
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return str(target / "rbpf-slam")


def unpack(work):
    """The engine, its libraries and its loader in work/engine; SixflipError where one lacks."""
    debian_packages.prepare(work, SUITE, INSTEAD)
    listed = debian_packages.apt_get(work, "install", "--no-install-recommends", "-y",
                                     "--print-uris", PACKAGE)
    names = re.findall(r"^'\S+' ([^_\s]+)_", listed, re.M)
    root = debian_packages.unpack(work, [PACKAGE] + [
        name for name in names if LIBRARIES.match(name) and not LARGE.match(name)])
    (loader,) = root.glob("lib/*/ld-linux*.so.*")
    folders = sorted({str(path.parent) for path in root.rglob("*.so.*")})
    program = root / "usr" / "bin" / "rbpf-slam"
    answer = subprocess.run(
        [str(loader), "--library-path", ":".join(folders), "--list", str(program)],
        capture_output=True, text=True, timeout=60, stdin=subprocess.DEVNULL)
    needed = re.findall(r"^\s*(\S+) => (\S+) \(", answer.stdout, re.M)
    # What only this machine happens to have installed is no part of the engine.
    missing = re.findall(r"^\s*(\S+) => not found", answer.stdout, re.M) + [
        name for name, path in needed if not path.startswith(str(root))]
    if answer.returncode or missing or not needed:
        raise SixflipError("the unpacked rbpf-slam does not start on this machine: %s; %s" % (
            " ".join(missing) or answer.stderr.strip(), INSTEAD))
    lib = work / "engine" / "lib"
    lib.mkdir(parents=True)
    for path in [str(program), str(loader), *(path for _, path in needed)]:
        if not (lib / Path(path).name).exists():
            shutil.copy(path, lib)
    for name, path in needed:
        if not os.path.isabs(name) and not (lib / name).exists():
            os.symlink(Path(path).name, lib / name)
    wrapper = work / "engine" / "rbpf-slam"
    wrapper.write_text(WRAPPER)
    wrapper.chmod(0o755)
