"""The drawings show a box that exists: right-handed, turned by half a turn, in bounds."""

import pytest

from sixflip.poses.faces import FACES
from sixflip_host.guide import box_drawings as drawings


def axis(name):
    return tuple((1 if name[1] == "+" else -1) if letter == name[0] else 0 for letter in "XYZ")


def cross(a, b):
    return tuple(a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]
                 for k in range(3))


@pytest.mark.parametrize("face", FACES)
def test_right_times_away_is_up(face):
    for front, right in (drawings.SEEN[face], drawings.turned(drawings.SEEN[face])):
        away = axis(drawings.opposite(front))
        assert cross(axis(right), away) == axis(face)


@pytest.mark.parametrize("face", FACES)
def test_the_names_stand_on_the_drawing(face):
    front, right = drawings.SEEN[face]
    text = "\n".join(drawings.placed(face))
    assert text.index(face) < text.index(right) < text.index(front)
    both = "\n".join(drawings.flip(face))
    assert both.count(face) == 2
    assert all(name in both for name in (front, right, *drawings.turned((front, right))))


@pytest.mark.parametrize("kind", ["place", "hold", "rest", "flip", "lean"])
@pytest.mark.parametrize("face", FACES)
def test_every_drawing_fits_beside_the_table_and_has_an_ascii_form(kind, face):
    lines = drawings.drawing(kind, face)
    assert 0 < len(lines) <= 9 and max(map(len, lines)) <= 50
    ascii_lines = [drawings.ascii_only(line) for line in lines]
    assert [len(line) for line in ascii_lines] == [len(line) for line in lines]
    assert all(line.isascii() and "?" not in line for line in ascii_lines)


def test_the_second_placement_is_drawn_turned():
    assert drawings.drawing("hold", "X+b") != drawings.drawing("hold", "X+a")
    assert "Z-" in "".join(drawings.drawing("hold", "X+b"))


def test_nothing_to_draw():
    assert drawings.drawing("wait", "") == []
