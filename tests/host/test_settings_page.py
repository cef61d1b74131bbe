"""docs/settings.md has every pattern of the lamp, every setting and every key of a scenario, with
the defaults of the code, and none that the code does not know."""

import json
import re
from pathlib import Path

import pytest

from sixflip_device import led, settings
from sixflip_host.board import board_settings
from sixflip_host.cli import main
from sixflip_host.simulation import scenario, scenario_checks
from sixflip_sim import worlds
from sixflip_sim.effects.library import EFFECTS

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "settings.md").read_text()
TABLES = dict(zip(("lamp", "settings", "scenario", "world", "effects"),
                  re.findall(r"\|---.*\n((?:\|.*\n)+)", PAGE)))
KEYS = {"settings": settings.KNOWN, "scenario": scenario.KEYS, "effects": EFFECTS,
        "world": [k for k in worlds.DEFAULTS if k not in scenario_checks.OURS]}


def rows(table):
    """Cells of each row, the first one without its backticks."""
    found = [[cell.strip() for cell in line.strip("|").split("|")]
             for line in TABLES[table].splitlines()]
    return [[cells[0].strip("`"), *cells[1:]] for cells in found]


def quoted(cell):
    return re.findall(r"`([^`]*)`", cell)


def test_the_lamps_patterns_are_those_of_the_firmware():
    known = sorted(value for name, value in vars(led).items()
                   if name.isupper() and isinstance(value, int))
    told = [int(cells[0].replace("■", "1").replace("□", "0"), 2) for cells in rows("lamp")]
    assert len(known) > 5 and sorted(told) == known


@pytest.mark.parametrize("table", KEYS)
def test_a_table_has_the_keys_of_the_code_and_no_others(table):
    told = [cells[0] for cells in rows(table)]
    assert sorted(told) == sorted(KEYS[table])


def test_the_settings_have_the_defaults_and_ranges_of_the_code():
    for name, default, low, high, _ in rows("settings"):
        known, kind, smallest, largest = settings.KNOWN[name]
        assert (json.loads(quoted(default)[0]) if quoted(default) else None) == known, name
        if kind in ("int", "float", "pin"):
            assert (float(low), float(high)) == (smallest, largest), name


def test_the_help_says_what_each_setting_does_and_its_limits(capsys):
    assert board_settings.DOES.keys() == settings.KNOWN.keys()
    assert main(["provision", "--help"]) == 0
    said = capsys.readouterr().out
    for name, (default, kind, _, high) in settings.KNOWN.items():
        line = next(line for line in said.splitlines() if line.startswith("  %s " % name))
        assert board_settings.DOES[name] in line
        assert default is None or str(default) in line
        assert kind not in ("int", "float", "pin") or board_settings.number(high) in line


def test_a_scenario_of_the_defaults_that_are_written_is_the_one_of_none():
    told = {table: {cells[0]: json.loads(quoted(cells[1])[0]) for cells in rows(table)
                    if quoted(cells[1])} for table in ("scenario", "world")}
    assert len(told["world"]) > 8
    given = scenario.from_dict(dict(told["scenario"], world=told["world"]))
    assert [dict(worlds.DEFAULTS, **w) for w in given.worlds] == [
        dict(worlds.DEFAULTS, **w) for w in scenario.from_dict({}).worlds]


def test_an_effects_sizes_and_parameters_are_those_of_its_class():
    for name, sizes, _, _, parameters in rows("effects"):
        assert quoted(sizes) == list(EFFECTS[name].keys), name
        assert quoted(parameters) == list(EFFECTS[name].shapes), name
        for parameter, default in re.findall(r"`(\w+)` \(([-\d.e+]+)", parameters):
            assert float(default) == EFFECTS[name].shapes[parameter][0], (name, parameter)
