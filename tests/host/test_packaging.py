"""What is shipped against what is in the tree: packages, mip's package.json, the manifest."""

import json
import re
from pathlib import Path

import pytest

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
