"""Draws the pictures of these pages: python docs/draw.py writes docs/pictures/*.svg."""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "host"))
from sixflip_host.guide import box_drawings  # noqa: E402

SEEN = box_drawings.SEEN
HERE = Path(__file__).resolve().parent / "pictures"
SIZE = (1.5, 1.25, 1.0)  # of the box along its own x, y, z: the printable one's, box.md
SCALE = 52.0             # pixels a unit of it
INK, PAPER, FAINT, TABLE = "#222222", "#ffffff", "#bbbbbb", "#e9e2d6"
COLOURS = {"X": "#c0392b", "Y": "#1e8449", "Z": "#1f618d"}
ORDER = ("Z+", "X+", "Y+", "Z-", "X-", "Y-")
CUBE = [(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
SIDES = {"X": 0, "Y": 1, "Z": 2}


def attitude(up, seen):
    """Rows: where the box's x, y and z point in the world (x right, y away, z up), from the
    names of the faces on top, in front and on the right."""
    axes = [None] * 3
    for face, (k, sign) in zip((up, *seen), ((2, 1), (1, -1), (0, 1))):
        sign = sign if face[1] == "+" else -sign
        axes[SIDES[face[0]]] = tuple(sign * (i == k) for i in range(3))
    return axes


def turned(axes, point):
    """A point of the box (its own axes) in the world."""
    return tuple(sum(axes[i][k] * point[i] for i in range(3)) for k in range(3))


def flat(point, centre):
    """World to paper, seen from the front, right and above; the table is z = 0, centre the
    middle of what lies on it."""
    x, y, z = point
    return (centre[0] + SCALE * (0.92 * x + 0.42 * y),
            centre[1] - SCALE * (0.95 * z + 0.42 * y - 0.18 * x))


def line(a, b, colour=INK, width=1.5, dash=""):
    return ('<line x1="%.1f" y1="%.1f" x2="%.1f" y2="%.1f" stroke="%s" stroke-width="%g"%s/>'
            % (*a, *b, colour, width, ' stroke-dasharray="%s"' % dash if dash else ""))


def text(at, words, size=13, colour=INK, anchor="middle", weight="normal"):
    return ('<text x="%.1f" y="%.1f" font-size="%d" fill="%s" text-anchor="%s" '
            'font-weight="%s">%s</text>' % (*at, size, colour, anchor, weight, words))


def arrow(a, b, colour, width=2.5):
    dx, dy = b[0] - a[0], b[1] - a[1]
    n = max((dx * dx + dy * dy) ** 0.5, 1e-9)
    dx, dy = dx / n, dy / n
    tip = ["%.1f,%.1f" % (b[0] + u * dx - v * dy, b[1] + u * dy + v * dx)
           for u, v in ((0, 0), (-9, 4), (-9, -4))]
    return line(a, (b[0] - 6 * dx, b[1] - 6 * dy), colour, width) + (
        '<polygon points="%s" fill="%s"/>' % (" ".join(tip), colour))


def ring_of(points, fill, stroke=INK):
    return '<polygon points="%s" fill="%s" stroke="%s" stroke-width="1.5"/>' % (
        " ".join("%.1f,%.1f" % p for p in points), fill, stroke)


def table(centre, half=1.45):
    """The table's top under a box, a little larger than it."""
    corners = ((-half, -1.15), (half, -1.15), (half, 1.15), (-half, 1.15))
    return ring_of([flat((x, y, 0.0), centre) for x, y in corners], TABLE, FAINT)


def box(axes, centre, letters=None):
    """The box on the table in an attitude, with the names of the faces that are seen; letters:
    {face: (along, along)}, where a name stands off the middle of its face, in half sizes."""
    out = []
    height = sum(abs(axes[i][2]) * SIZE[i] for i in range(3))

    def on_paper(point):
        x, y, z = turned(axes, point)
        return flat((x, y, z + height / 2), centre)

    for letter, i in SIDES.items():
        for sign in (1, -1):
            normal = turned(axes, [sign * (k == i) for k in range(3)])
            if normal[2] > 0.5 or normal[1] < -0.5 or normal[0] > 0.5:  # seen
                corners = [c for c in CUBE if c[i] == sign]
                ring = [corners[0], corners[1], corners[3], corners[2]]
                points = [on_paper([c[k] * SIZE[k] / 2 for k in range(3)]) for c in ring]
                shade = "#f2f2f2" if normal[2] > 0.5 else "#dddddd" if normal[1] < -0.5 \
                    else "#cccccc"
                out.append(ring_of(points, shade))
                aside = list((letters or {}).get(letter + "-+"[sign > 0], (0, 0)))
                middle = on_paper([SIZE[k] / 2 * (sign if k == i else aside.pop(0))
                                   for k in range(3)])
                size = 10 if letters else 14
                out.append(text((middle[0], middle[1] + 0.35 * size),
                                letter + ("+" if sign > 0 else "−"), size, COLOURS[letter],
                                weight="bold"))
    return "".join(out)


def picture(width, height, parts):
    return ('<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" '
            'viewBox="0 0 %d %d" font-family="sans-serif"><rect width="100%%" height="100%%" '
            'fill="%s"/>%s</svg>\n' % (width, height, width, height, PAPER, "".join(parts)))


def faces():
    """The six faces in the order that the board asks for them."""
    parts = []
    for k, name in enumerate(ORDER):
        centre = (120 + 220 * (k % 3), 140 + 220 * (k // 3))
        parts += [table(centre), box(attitude(name, SEEN[name]), centre),
                  text((centre[0], centre[1] + 64), "%d.  %s up" % (
                      k + 1, name.replace("-", "−")), 15, weight="bold")]
    return picture(680, 450, parts)


def turn_on_the_table(centre, start, end, radius=1.38, steps=40):
    """An arrow that lies on the table round what stands there; angles in degrees, from x
    (right) over y (away), anticlockwise from above."""
    points = []
    for k in range(steps + 1):
        angle = math.radians(start + (end - start) * k / steps)
        points.append(flat((radius * math.cos(angle), radius * math.sin(angle), 0.0), centre))
    path = " ".join("%.1f,%.1f" % p for p in points[:-2])
    return '<polyline points="%s" fill="none" stroke="%s" stroke-width="2.5"/>' % (path, INK) \
        + arrow(points[-4], points[-1], INK)


def flip():
    """The half turn on one face."""
    parts = []
    half = {"Z+a": SEEN["Z+"], "Z+b": box_drawings.turned(SEEN["Z+"])}
    for k, (name, seen) in enumerate(half.items()):
        centre = (135 + 340 * k, 120)
        parts += [table(centre, 1.6)]
        if not k:
            parts.append(turn_on_the_table(centre, 10, 170))
        parts.append(box(attitude("Z+", seen), centre))
        if not k:
            parts.append(turn_on_the_table(centre, 190, 350))
        parts.append(text((centre[0], 200), name, 15, weight="bold"))
    parts += [arrow((270, 105), (342, 105), INK), text((306, 80), "half a turn"),
              text((306, 95), "on the table", 12),
              text((306, 228), "the same face stays up; it is turned round, not tipped over",
                   13),
              text((306, 248), "what the table's tilt adds changes its sign, "
                      "what the sensor adds does not", 12)]
    return picture(612, 262, parts)


CABLE, HOLLOW = "#b9770e", "#8f8f8f"


def on_box(axes, points, centre):
    """Points of the box, in parts of its half sizes, on paper."""
    height = sum(abs(axes[i][2]) * SIZE[i] for i in range(3))
    for point in points:
        x, y, z = turned(axes, [p * s / 2 for p, s in zip(point, SIZE)])
        yield flat((x, y, z + height / 2), centre)


def cable(points):
    return ('<polyline points="%s" fill="none" stroke="%s" stroke-width="4" '
            'stroke-linejoin="round"/>' % (" ".join("%.1f,%.1f" % p for p in points), CABLE))


def printed_box():
    """The printable box (box/sixflip_box.scad) on Z-, on X- and on Y-, with its cable."""
    pocket = ((-0.5, -0.48, 1), (-0.13, -0.48, 1), (-0.13, -1, 1), (0.13, -1, 1), (0.13, -0.48, 1),
              (0.5, -0.48, 1), (0.5, 0.48, 1), (-0.5, 0.48, 1))
    slot = ((-0.13, -1, 1), (0.13, -1, 1), (0.13, -1, -0.4), (-0.13, -1, -0.4))
    shown = (("Z+", SEEN["Z+"], "Z+ up", ((0, -1, -0.3), (0, -1.9, -0.3), (-0.6, -2.3, -0.9))),
             ("X+", SEEN["X+"], "X+ up", ((0, -1, 0.2), (0.02, -1.7, 0.2), (-0.8, -2.3, 0.5))),
             ("Y+", SEEN["Y+"], "Y+ up, slot below", ((0, -0.93, 1), (0, -0.95, 1.7),
                                                      (0.5, -0.98, 2.6))))
    parts = []
    for k, (up, seen, words, way) in enumerate(shown):
        centre, axes = (120 + 220 * k, 140), attitude(up, seen)
        parts += [table(centre, 1.7), box(axes, centre, {"Z+": (0, 0.75), "Y-": (-0.57, 0)})]
        parts.append(ring_of(on_box(axes, pocket, centre), HOLLOW))
        if up != "Y+":
            parts.append(ring_of(on_box(axes, slot, centre), HOLLOW))
        parts.append(cable(list(on_box(axes, way, centre))))
        parts.append(text((centre[0], centre[1] + 66), words, 15, weight="bold"))
    return picture(680, 225, parts)


BOARDS = {
    "pico": ("Raspberry Pi Pico", ("3V3 (36)", "GND (38)", "GP4 SDA (6)", "GP5 SCL (7)")),
    "esp32": ("ESP32", ("3V3", "GND", "GPIO21 SDA", "GPIO22 SCL")),
    "stm32": ("pyboard, STM32", ("3V3", "GND", "X10 SDA", "X9 SCL")),
    "raspberry_pi": ("Raspberry Pi", ("3V3 (1)", "GND (6)", "GPIO2 SDA (3)", "GPIO3 SCL (5)"))}


def wiring(board):
    """Four wires from a board to the sensor."""
    name, pins = BOARDS[board]
    parts = ['<rect x="20" y="30" width="190" height="190" rx="8" fill="#e8f0e8" stroke="%s"/>'
             % INK, text((115, 55), name, 15, weight="bold"),
             '<rect x="390" y="30" width="170" height="190" rx="8" fill="#e8ecf4" stroke="%s"/>'
             % INK, text((475, 55), "GY-85 or MPU6050", 15, weight="bold")]
    colours = ("#c0392b", "#222222", "#1f618d", "#b9770e")
    for k, (pin, other, colour) in enumerate(zip(pins, ("VCC", "GND", "SDA", "SCL"), colours)):
        y = 90 + 35 * k
        parts += [line((210, y), (390, y), colour, 3),
                  text((200, y + 5), pin, 13, anchor="end"),
                  text((402, y + 5), other, 13, anchor="start")]
    return picture(580, 240, parts)


def pictures():
    found = {"faces.svg": faces(), "flip.svg": flip(), "box.svg": printed_box()}
    found.update(("wiring-%s.svg" % board, wiring(board)) for board in BOARDS)
    return found


if __name__ == "__main__":
    HERE.mkdir(exist_ok=True)
    for name, svg in pictures().items():
        (HERE / name).write_text(svg)
        print(HERE / name, file=sys.stderr)
