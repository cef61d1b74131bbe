"""What a sample and a solve cost on a Cortex-M3, in instructions counted by QEMU (-icount), and
what the same costs as it is usually written, with floats in lists (on_board/float_lists.py).

Both take the same session from the same tape and solve the same twelve means.
"""

import sys

from tests.debian_tier import Unavailable, exit_code_without
from tests.on_qemu.board import QemuBoard, cortex_m3
from tests.on_qemu.firmware import POSE_SAMPLES, build

COUNTED = ["-icount", "shift=6,sleep=off"]


def measure(elf):
    """{name: [numbers]} of on_board/instructions.py."""
    with QemuBoard(cortex_m3(elf), COUNTED) as board:
        printed = board.exec("import instructions\ninstructions.run(%d)" % POSE_SAMPLES)
    return {line.split()[0]: [float(x) for x in line.split()[1:]]
            for line in printed.strip().splitlines()}


def row(name, ours, theirs, form="%.0f"):
    return "| %s | %s | %s | %.1f |" % (name, form % ours, form % theirs, theirs / ours)


def table(found):
    n, total, worst, garbage, held = found["session"]
    list_n, list_total, list_worst, list_garbage, list_held = found["lists"]
    (solve, rounds), (list_solve, list_rounds) = found["solve"], found["solve_lists"]
    return "\n".join([
        "| | sixflip | floats in lists | times |", "|---|---|---|---|",
        row("instructions a sample, mean of %d" % n, total / n, list_total / list_n),
        row("instructions of the longest sample", worst, list_worst),
        row("bytes allocated a sample", garbage / n, list_garbage / list_n),
        row("bytes of heap held, most", held, list_held),
        row("instructions of the solve, %d rounds and %d" % (rounds, list_rounds), solve,
            list_solve),
        "",
        "Keeping a sample in the capture: %.0f instructions more. The solutions are %.1e apart."
        % (found["capture"][1] / found["capture"][0], found["apart"][0])])


def main():
    try:
        elf = build()
    except Unavailable as error:
        return exit_code_without("emulated Cortex-M3", error)
    found = measure(elf)
    print(table(found))
    return 0 if found["session"][1] < found["lists"][1] else 1


if __name__ == "__main__":
    sys.exit(main())
