"""A chip of the catalogue is whole: what is missing of it is named, with where it belongs."""

import re
from pathlib import Path

import pytest

from sixflip.chips import catalogue
from sixflip_sim import worlds
from sixflip_sim.effects import datasheets, typical

ROOT = Path(__file__).resolve().parents[2]
DRIVERS, SIMULATED = ROOT / "shared/sixflip/chips", ROOT / "host/sixflip_sim/chips"
NO_DRIVERS = {"__init__", "banked", "catalogue", "fifo", "header", "lsm6", "magnetometers",
              "probe", "registers", "six_axis"}
CHIPS = [name for name in catalogue.SENSORS if name not in worlds.SEEN]


def missing(sensor):
    """Sentences on what a chip lacks."""
    said = []
    row = catalogue.row_of(sensor)
    if len(sensor) > 16:
        said.append("catalogue.py: the name %s has more than a record's 16 characters" % sensor)
    module, _, name = row[1].partition(".")
    if not (DRIVERS / (module + ".py")).exists():
        return said + ["shared/sixflip/chips/%s.py: the driver" % module]
    driver = catalogue.driver(sensor)
    text = (DRIVERS / (module + ".py")).read_text()
    if not re.search(r"rev\. \S+", text.split('"""')[1]):
        said.append("%s.py: the data sheet's number and revision at its top" % module)
    if driver.sensor != sensor:
        said.append("%s.%s: sensor = %r" % (module, name, sensor))
    for what in ("ACCEL_RANGES", "GYRO_RANGES", "COLUMNS", "setup", "READY"):
        if not any(getattr(driver, what, None) or ()):
            said.append("%s.%s: %s" % (module, name, what))
    for what in ("gyro_tolerance", "zero_rate_dps", "zero_rate_dps_per_c"):
        if not 0 < (getattr(driver, what, None) or 0) < 100:
            said.append("%s.%s: %s" % (module, name, what))
    for full_scale, counts, _ in getattr(driver, "ACCEL_RANGES", ()):
        if not 28000 < full_scale * counts < 32850 or round(counts, 3) != counts:
            said.append("%s.%s: %g counts per g at ±%g g, three decimals at most, about 32768 "
                        "over the range" % (module, name, counts, full_scale))
    if not (SIMULATED / (module + ".py")).exists():
        return said + ["host/sixflip_sim/chips/%s.py: the simulated chip" % module]
    try:
        chip = worlds.simulated(sensor)
    except (AttributeError, KeyError):
        return said + ["host/sixflip_sim/chips/%s.py: SIMULATED = {%r: its class}"
                       % (module, sensor)]
    if not chip.TRAPS:
        said.append("%s: TRAPS, what another program may have left" % chip.__name__)
    if not chip.self_clearing:
        said.append("%s: self_clearing, the register of its reset" % chip.__name__)
    for kind, table in (("accel", datasheets.ACCEL), ("gyro", datasheets.GYRO)):
        if sensor not in table:
            said.append("effects/datasheets.py: its row in %s" % kind.upper())
        elif len(table[sensor]) != len(datasheets.FIELDS):
            said.append("effects/datasheets.py: %s of its row in %s" % (
                " ".join(datasheets.FIELDS), kind.upper()))
    if not re.search(r"rev\. \S+", datasheets.SOURCE.get(sensor, "")):
        said.append("effects/datasheets.py: its SOURCE, with a revision")
    return said


@pytest.mark.parametrize("sensor", CHIPS)
def test_nothing_is_missing(sensor):
    assert not missing(sensor), "\n".join(["%s is not whole:" % sensor, *missing(sensor)])


def test_what_is_missing_is_named(monkeypatch):
    rows = (*catalogue.CHIPS, ("bmi323", "bmi323.BMI323", (0x68,), 0x00, {0x43: "BMI323"}, None,
                               0xFF))
    monkeypatch.setattr(catalogue, "CHIPS", rows)
    assert missing("bmi323") == ["shared/sixflip/chips/bmi323.py: the driver"]
    monkeypatch.setitem(datasheets.SOURCE, "lsm6dsv", "a leaflet")
    monkeypatch.delitem(datasheets.GYRO, "lsm6dsv")
    monkeypatch.setattr(catalogue.driver("lsm6dsv"), "gyro_tolerance", None)
    assert missing("lsm6dsv") == [
        "lsm6dsv.LSM6DSV: gyro_tolerance", "effects/datasheets.py: its row in GYRO",
        "effects/datasheets.py: its SOURCE, with a revision"]


def test_every_driver_has_its_row():
    """A file that nobody can be found by is one that somebody forgot to make known."""
    known = {row[1].split(".")[0] for row in catalogue.CHIPS if row[1]}
    assert {path.stem for path in DRIVERS.glob("*.py")} - NO_DRIVERS == known
    for row in catalogue.CHIPS:
        assert row[0] in catalogue.NOT_DRIVEN or row[0] in catalogue.SENSORS


def test_the_pages_name_every_sensor():
    for page in ("wiring.md", "settings.md"):
        text = (ROOT / "docs" / page).read_text()
        assert [name for name in catalogue.SENSORS if "`%s`" % name not in text] == []


@pytest.mark.parametrize("sensor", [*CHIPS, "mpu6050", "gy85"])
def test_simulator_plan_and_prior_have_one_and_the_same_figure(sensor):
    for kind in ("accel", "gyro"):
        chip = typical.chip_of(sensor, kind)
        for axis in "xyz":
            assert typical.size("thermal_bias", sensor, kind, axis) == (
                datasheets.figures(sensor, kind, "offset_per_c")["xyz".index(axis)],
                datasheets.source(sensor, kind))
        sigma = worlds.usual_noise(sensor)[kind == "gyro"]
        assert typical.NOISE[chip][0] == (sigma,) * 3
        for effect in typical.SIZES:
            if kind in ("accel", "gyro") and "mpu6050-" + kind in typical.SIZES[effect]:
                size, source = typical.size(effect, sensor, kind)
                assert size > 0 and source, effect
                assert ("rev" in source or "not stated" in source or sensor in worlds.SEEN
                        or source.startswith("as the MPU6050: ")), (effect, source)


def test_a_part_is_drawn_within_what_its_sheet_allows():
    for sensor in CHIPS:
        for seed in range(20):
            matrix, bias, gyro, gyro_bias = worlds.part(sensor, seed)
            off = [abs(b) / 9.80665 * 1000 for b in bias]
            assert max(off) <= datasheets.figure(sensor, "accel", "offset")
            assert max(abs(gyro[i][i] - 1) for i in range(3)) <= 0.01 * datasheets.figure(
                sensor, "gyro", "scale")
            assert max(abs(b) for b in gyro_bias) * 57.3 <= datasheets.figure(
                sensor, "gyro", "offset") * 1.001
            assert abs(matrix[0][1]) <= 0.01 * datasheets.figure(sensor, "accel", "cross_axis")
