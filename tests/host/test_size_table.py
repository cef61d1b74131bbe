"""device/README.md says how much flash each module of the firmware takes; does it still?"""

import re
from pathlib import Path

import pytest

from tests.studies.bench import size

ROOT = Path(__file__).resolve().parents[2]
ROW = re.compile(r"\| `([^`]+)` \| (\d+) \| (\d+) \| (\d+|-) \|")
WRITE = "python -m tests.studies.bench.size --write"


@pytest.fixture(scope="module")
def written():
    """{module: (bytes of .py, bytes of .mpy, bytes of heap or "-")}."""
    rows = ROW.findall(size.TABLE.read_text())
    return {name: (int(py), int(mpy), heap) for name, py, mpy, heap in rows}


def test_every_module_is_in_the_table(written):
    assert set(written) == set(size.modules()), WRITE


def test_flash_is_what_the_table_says(written):
    """Within a tenth in all and a third for each: the table need not follow every line."""
    found = size.flash()
    for i in (0, 1):
        assert sum(sizes[i] for sizes in found.values()) == pytest.approx(
            sum(sizes[i] for sizes in written.values()), rel=0.1), WRITE
        for name, sizes in found.items():
            if name not in written:  # the test above says so
                continue
            assert sizes[i] == pytest.approx(written[name][i], rel=0.33, abs=200), (name, WRITE)


def test_heap_was_measured_for_all_that_a_board_imports(written):
    assert {name for name, sizes in written.items() if sizes[2] == "-"} == set(size.NOT_IMPORTED)
