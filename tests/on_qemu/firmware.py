"""MicroPython for an emulated Cortex-M3 (QEMU mps2-an385) with our shared code frozen in.

Single-precision floats, 31-bit small ints, 140 KB of heap: what most boards have. The source
is Debian's micropython package, built once into the cache with Debian's cross compiler; a
change of the frozen files costs a few seconds. Nothing here runs as part of the product.
"""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from sixflip_host.atomic_write import write_bytes
from sixflip_host.board.board_files import board_files
from sixflip_host.board.compiled_firmware import FORMAT, for_board
from sixflip_host.errors import SixflipError
from sixflip_host.virtual.debian_packages import KEYRING, apt_get, cache_dir, debian_mirror
from sixflip_host.virtual.micropython_fetch import SUITE
from tests.debian_tier import Unavailable, alone, install
from tests.on_micropython import session_tape

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("qemu-system-arm", "gcc-arm-none-eabi", "libnewlib-arm-none-eabi")
# The session on tape, shorter than a person's: POSE_SAMPLES of each pose.
WORLD = {"tilt_deg": 2.0, "first_rest_s": 6.0, "dwell_s": 3.5, "move_s": 1.5}
POSE_SAMPLES = 200
ALL_CHIPS = bool(os.environ.get("SIXFLIP_QEMU_CHIPS"))  # as `make test-qemu` says
# What the host alone needs of the formats, and the shared tests to hold the board's side against.
HOST_CODECS = ("sixflip_host/__init__.py", "sixflip_host/record_terms.py",
               "sixflip_host/board/__init__.py", "sixflip_host/board/stream_reader.py")
TOOLS = ("qemu-system-arm", "arm-none-eabi-gcc", "make", "gcc")


def frozen_files():
    """{path in the firmware: file of the project}: shared code, its tests, their runner, and
    what whole sessions need beside the firmware itself."""
    files = {}
    for part, folder in (("shared", ROOT / "shared"), ("sim", ROOT / "host")):
        for path in sorted(folder.rglob("*.py")):
            name = path.relative_to(folder).as_posix()
            if part == "shared" or name.startswith("sixflip_sim/") and "/micropython/" not in name:
                files[name] = path
    for path in sorted((ROOT / "tests" / "shared").glob("*.py")):
        if "sixflip_sim" not in path.read_text():
            files[path.name] = path
    for path in sorted((ROOT / "tests" / "on_qemu" / "on_board").glob("*.py")):
        files[path.name] = path
    for name in HOST_CODECS:
        files[name] = ROOT / "host" / name
    for name in ("unittest.py", "locked_loop.py", "redo_late.py"):
        files[name] = ROOT / "tests" / "on_micropython" / name
    return files


def sources():
    """{path on a board: bytes}: the firmware uncompiled."""
    return {name: path.read_bytes() for name, path in board_files().items()}


def provisioned():
    """The same as it is provisioned, compiled."""
    files, why = for_board(sources(), FORMAT)
    if why:
        raise RuntimeError("the firmware stays source: " + why)
    return files


def missing_tools():
    return [tool for tool in TOOLS if not shutil.which(tool)]


def fetch_source(target):
    """Debian's source package of MicroPython, unpacked to target in one step."""
    target.parent.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(prefix="source-", dir=target.parent))
    try:
        for name in ("lists/partial", "archives/partial", "tree"):
            (work / name).mkdir(parents=True)
        signed = " [signed-by=%s]" % KEYRING if os.path.exists(KEYRING) else ""
        (work / "sources.list").write_text(
            "deb-src%s %s %s main\n" % (signed, debian_mirror(
                "the emulated boards' tests need one"), SUITE))
        apt_get(work, "update")
        apt_get(work, "source", "--download-only", "micropython")
        for archive in work.glob("micropython_*.orig.tar.*"):
            subprocess.run(["tar", "-xf", str(archive), "--strip-components=1",
                            "-C", str(work / "tree")], check=True, timeout=300)
        # The build asks for this submodule's marker although nothing of it is used.
        (work / "tree" / "lib" / "micropython-lib").mkdir(parents=True, exist_ok=True)
        (work / "tree" / "lib" / "micropython-lib" / "README.md").touch()
        os.rename(work / "tree", target)
    finally:
        shutil.rmtree(work, ignore_errors=True)


def run_make(folder, *words):
    answer = subprocess.run(["make", "-C", str(folder), "-j2", *words], capture_output=True,
                            text=True, timeout=1200, stdin=subprocess.DEVNULL,
                            env={k: v for k, v in os.environ.items()
                                 if k not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")})
    if answer.returncode:
        raise RuntimeError("make in %s failed:\n%s" % (folder.name, answer.stderr[-2000:]))


def stage(folder, files):
    """Write the frozen files to one tree, only those that changed, and its manifest."""
    wanted = set()
    for name, data in files.items():
        place = folder / name
        wanted.add(place)
        if not place.exists() or place.read_bytes() != data:
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(data)
    for old in folder.rglob("*.py"):
        if old not in wanted:
            old.unlink()
    manifest = folder.parent / "manifest.py"
    text = "freeze(%r)\n" % str(folder)
    if not manifest.exists() or manifest.read_text() != text:
        manifest.write_text(text)
    return manifest


def tape_module():
    """Path of a module with the bursts of a session of each sensor, {sensor: [bytes]}; made
    anew when the simulator changed."""
    digest = hashlib.sha256(Path(session_tape.__file__).read_bytes()
                            + repr((WORLD, ALL_CHIPS)).encode())
    for path in sorted((ROOT / "host" / "sixflip_sim").rglob("*.py")) + sorted(
            (ROOT / "shared" / "sixflip" / "chips").rglob("*.py")):
        digest.update(path.read_bytes())
    made = cache_dir() / "qemu" / ("tapes-%s.py" % digest.hexdigest()[:16])
    if not made.exists():
        for old in made.parent.glob("tapes-*.py"):
            old.unlink()
        bursts = {}
        for sensor in session_tape.SENSORS if ALL_CHIPS else session_tape.SENSORS[:2]:
            with tempfile.TemporaryDirectory() as folder:
                session_tape.write(Path(folder), sensor, WORLD)
                files = sorted(Path(folder).glob("*.tape"))
                bursts[sensor] = [file.read_bytes() for file in files]
        write_bytes(made, ("BURSTS = %r\n" % bursts).encode())
    return made


def tape_bursts():
    names = {}
    exec(tape_module().read_text(), names)
    return names["BURSTS"]


def build(board="MPS2_AN385"):
    """Path of the firmware with today's shared code, built when something changed."""
    install(PACKAGES, missing_tools)
    with alone("qemu"):
        return _build(board)


def _build(board):
    cache = cache_dir() / "qemu"
    source = cache / "micropython"
    if not (source / "ports" / "qemu").is_dir():
        if not shutil.which("apt-get"):
            raise Unavailable("no apt-get to get MicroPython's source package with")
        try:
            fetch_source(source)
        except (SixflipError, subprocess.SubprocessError) as error:
            raise Unavailable("MicroPython's source package cannot be had: %s" % error) from None
    files = {name: path.read_bytes() for name, path in frozen_files().items()}
    files["provisioned.py"] = ("FILES = %r\nSOURCES = %r\n" % (provisioned(), sources())).encode()
    files["tapes.py"] = tape_module().read_bytes()
    digest = hashlib.sha256()
    for name, data in sorted(files.items()):
        digest.update(name.encode() + b"\0" + data)
    stamp = cache / ("built-" + board)
    elf = source / "ports" / "qemu" / ("build-" + board) / "firmware.elf"
    if elf.exists() and stamp.exists() and stamp.read_text() == digest.hexdigest():
        return elf
    run_make(source / "mpy-cross")
    manifest = stage(cache / "frozen", files)
    manifest.touch()
    run_make(source / "ports" / "qemu", "BOARD=" + board, "FROZEN_MANIFEST=" + str(manifest))
    stamp.write_text(digest.hexdigest())
    return elf


if __name__ == "__main__":
    try:
        print(build())
    except Unavailable as error:
        sys.exit("sixflip: %s" % error)
