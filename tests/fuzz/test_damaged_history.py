"""A damaged history is exit code 4 and one line: tests/fuzz/damaged_history.py runs thousands."""


import pytest

from sixflip_host.history import store
from tests.fuzz import damaged_history


@pytest.mark.parametrize("part", range(3))
def test_damaged_histories(part):
    codes = set()
    for seed in range(part, 60, 3):
        for code, why in damaged_history.damaged(seed):
            assert why == "", seed
            codes.add(code)
    assert codes >= {0, 4}


def test_a_row_that_could_not_be_read_again_is_not_written(tmp_path):
    row = store.Happened("ab", "check", "check", 1.0, "holds", answer={"scale": [10 ** 400] * 3})
    with pytest.raises(ValueError, match="expected"):
        store.add(tmp_path / "history.sqlite", [row])
    assert store.read(tmp_path / "history.sqlite") == []
