"""Power cuts while a record and a capture are written, on real littlefs and FAT. Records are cut
everywhere, captures at a part of their operations: tests/studies/bench/power_cuts.py does all."""

import json

import pytest

from sixflip.chips import catalogue

RECORDS = ("save0", "save1", "save2", "save3", "restore")
CAPTURES = ("session", "refused", "redo")


@pytest.fixture
def cut(micropython):
    def run(fs, scenario, ways, every=1, twice=False):
        done = micropython("power_cuts.py", fs, scenario, ways, str(every), "30",
                           *["twice"] * twice, heap="64m")
        assert done.returncode == 0, done.stdout[-300:] + done.stderr[-1500:]
        return json.loads(done.stdout.splitlines()[-1])
    return run


@pytest.mark.parametrize("fs, ways", [("lfs2", "all"), ("fat", "data")])
@pytest.mark.parametrize("scenario", RECORDS)
def test_a_record_is_the_old_or_the_new_one(cut, fs, ways, scenario):
    found = cut(fs, scenario, ways)
    assert found["cuts"] > 15 and len(found["seen"]) == 2
    assert found["losses"] == {}


@pytest.mark.parametrize("sensor", [name for name in catalogue.SENSORS
                                    if name not in ("mpu6050", "adxl345")])
def test_a_record_of_every_chip_is_the_old_or_the_new_one(cut, sensor):
    found = cut("lfs2", "save1:" + sensor, "whole")
    assert found["cuts"] > 5 and len(found["seen"]) == 2
    assert found["losses"] == {}


@pytest.mark.parametrize("fs, ways", [("lfs2", "all"), ("fat", "halves")])
def test_the_power_fails_again_while_the_first_cut_is_mended(cut, fs, ways):
    found = cut(fs, "save2", ways, twice=True)
    assert found["cuts"] > 100
    assert found["losses"] == {}


@pytest.mark.parametrize("fs, ways, every", [("lfs2", "all", 9), ("fat", "halves", 1)])
@pytest.mark.parametrize("scenario", CAPTURES)
def test_a_capture_is_readable_to_its_last_whole_block(cut, fs, ways, every, scenario):
    found = cut(fs, scenario, ways, every)
    assert found["cuts"] > 60
    assert found["losses"] == {}


@pytest.mark.parametrize("scenario", CAPTURES)
def test_garbage_in_a_sector_of_fat_costs_no_more_than_the_last_pose(cut, scenario):
    found = cut("fat", scenario, "data", every=3)
    assert set(found["losses"]) <= {"last pose"}


def test_garbage_in_fats_own_tables_is_more_than_two_slots_can_carry(cut):
    """What the README says is not promised; were it otherwise, it could be promised."""
    assert cut("fat", "save2", "all")["losses"]["record"] > 0
