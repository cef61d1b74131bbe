"""What differs between float32 and float64, over 40 sessions: an emulated Cortex-M3 and CPython
solve from the same integers. Fails above 0.01 mg. With a number as argument: so many sessions."""

import sys

from tests.debian_tier import Unavailable, exit_code_without
from tests.on_qemu.board import QemuBoard, cortex_m3
from tests.on_qemu.firmware import build
from tests.on_qemu.float_widths import LIMIT_MG, compare, table


def main(sessions):
    try:
        elf = build()
    except Unavailable as error:
        return exit_code_without("emulated Cortex-M3", error)
    with QemuBoard(cortex_m3(elf)) as board:
        found = compare(board, range(sessions))
    print(table(found, sessions))
    return 0 if found[2] < LIMIT_MG else 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 40))
