"""The box to print: its STL is closed, of the size and shape that the OpenSCAD source says."""

import re
from collections import Counter
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "box"


def numbers():
    """The source's {name: mm}."""
    text = (FOLDER / "sixflip_box.scad").read_text()
    return {name: float(value)
            for name, value in re.findall(r"^(\w+) = ([\d.]+);", text, re.MULTILINE)}


def triangles():
    """(n, 3, 3), mm."""
    found = re.findall(r"vertex (\S+) (\S+) (\S+)", (FOLDER / "sixflip_box.stl").read_text())
    assert len(found) > 300
    return np.array(found, dtype=float).reshape(-1, 3, 3)


def test_every_edge_has_two_sides_that_run_against_each_other():
    edges = Counter()
    for a, b, c in triangles():
        edges.update((tuple(p), tuple(q)) for p, q in ((a, b), (b, c), (c, a)))
    assert set(edges.values()) == {1}
    assert all((q, p) in edges for p, q in edges)


def test_it_is_as_large_as_the_source_says():
    of = numbers()
    corners = triangles().reshape(-1, 3)
    assert np.allclose(np.ptp(corners, axis=0), [of["length"], of["width"], of["height"]])


def test_its_volume_is_the_block_less_pocket_slot_and_letters():
    of, at = numbers(), triangles()
    volume = np.einsum("ni,ni->n", at[:, 0], np.cross(at[:, 1], at[:, 2])).sum() / 6
    wall = (of["width"] - of["pocket_width"]) / 2
    hollow = (of["height"] - of["floor"]) * (
        of["pocket_length"] * of["pocket_width"] + of["slot"] * wall)
    letters = of["length"] * of["width"] * of["height"] - hollow - volume
    assert 0.2 < letters / (12 * of["letter_size"] ** 2 * of["engraved"]) < 0.8  # ink of a letter


def test_every_face_rests_on_four_corners():
    of = numbers()
    half = np.array([of["length"], of["width"], of["height"]]) / 2
    corners = {tuple(p) for p in triangles().reshape(-1, 3) if np.allclose(np.abs(p), half)}
    assert len(corners) == 8
