"""What is shipped against what is in the tree: packages, mip's package.json, the manifest."""

import json
import re
from pathlib import Path

import pytest

from sixflip_host import optional
from sixflip_host.board import mip_package

ROOT = Path(__file__).resolve().parents[2]

try:
    import tomllib
except ImportError:  # Python 3.10
    import tomli as tomllib


def packages_below(folder):
    """Dotted names of every folder below that holds Python files."""
    found = {path.parent for path in folder.rglob("*.py")}
    return {".".join(path.relative_to(folder).parts) for path in found if path != folder}


@pytest.fixture(scope="module")
def setuptools_table():
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]


def test_every_package_of_the_tree_is_shipped(setuptools_table):
    wanted = set()
    for root in ("shared", "device", "host"):
        wanted |= packages_below(ROOT / root)
    packed = "sixflip_host._board_files."
    wanted |= {packed + "shared." + name for name in packages_below(ROOT / "shared")}
    wanted |= {packed + "device." + name for name in packages_below(ROOT / "device")}
    wanted.add(packed + "device")
    assert set(setuptools_table["packages"]) == wanted


def test_the_authors_are_those_of_the_license():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    holder = re.search(r"Copyright \(c\) \d+ (.+)", (ROOT / "LICENSE").read_text())[1]
    assert [one["name"] for one in project["authors"]] == [holder]
    assert project["license"]["text"] + " License" in (ROOT / "LICENSE").read_text()


@pytest.mark.parametrize("extra", ["ui", "data", "pico"])
def test_what_to_install_names_the_libraries_and_needs_no_index_that_has_sixflip(
        extra, monkeypatch):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    names = [re.match(r"[\w-]+", one)[0] for one in project["optional-dependencies"][extra]]
    said = optional.how(extra)
    assert all("'%s" % name in said for name in names) and "sixflip[" not in said
    monkeypatch.setattr(optional.metadata, "requires", lambda name: None)   # not installed
    assert optional.how(extra).endswith("-m pip install '%s[%s]'" % (ROOT, extra))


def test_package_json_lists_the_tree():
    text = (ROOT / "package.json").read_text()
    assert text == mip_package.text(), "package.json is out of date: run `make package.json`"
    for _, path in json.loads(text)["urls"]:
        assert (ROOT / path).is_file()


def test_the_manifest_freezes_what_the_board_gets():
    text = (ROOT / "manifest.py").read_text()
    named = dict(re.findall(r'^package\("(\w+)", base_path="(\w+)"\)', text, re.M))
    on_board = {name.split("/")[0] for name, _ in json.loads(
        (ROOT / "package.json").read_text())["urls"]}
    assert set(named) == on_board
    for package, base in named.items():
        assert (ROOT / base / package / "__init__.py").is_file()
