"""Draws the pictures of these pages: python docs/draw.py writes docs/pictures/*.svg."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent / "pictures"
SIZE = (1.5, 1.0, 0.5)  # of the box along its own x, y, z
INK, PAPER, FAINT = "#222222", "#ffffff", "#bbbbbb"
COLOURS = {"X": "#c0392b", "Y": "#1e8449", "Z": "#1f618d"}
# Rows: where the box's x, y and z point in the world (x right, y away, z up).
ATTITUDES = {
    "Z+": ((1, 0, 0), (0, 1, 0), (0, 0, 1)), "Z-": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "X+": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)), "X-": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "Y+": ((1, 0, 0), (0, 0, 1), (0, -1, 0)), "Y-": ((1, 0, 0), (0, 0, -1), (0, 1, 0))}
ORDER = ("Z+", "X+", "Y+", "Z-", "X-", "Y-")
CUBE = [(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
SIDES = {"X": 0, "Y": 1, "Z": 2}


def turned(axes, point):
    """A point of the box (its own axes) in the world."""
    return tuple(sum(axes[i][k] * point[i] for i in range(3)) for k in range(3))


def flat(point, centre, scale=46.0):
    """World to paper, seen from the front, right and above."""
    x, y, z = point
    return (centre[0] + scale * (0.92 * x + 0.42 * y),
            centre[1] - scale * (0.95 * z + 0.42 * y - 0.18 * x))


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


def box(axes, centre):
    """The box in an attitude, its faces named, its axes as arrows from the middle of a face."""
    out = []
    for letter, i in SIDES.items():
        for sign in (1, -1):
            normal = turned(axes, [sign * (k == i) for k in range(3)])
            if normal[2] > 0.5 or normal[1] < -0.5 or normal[0] > 0.5:  # seen
                corners = [c for c in CUBE if c[i] == sign]
                ring = [corners[0], corners[1], corners[3], corners[2]]
                points = [flat(turned(axes, [c[k] * SIZE[k] / 2 * 1.3 for k in range(3)]), centre)
                          for c in ring]
                shade = "#f2f2f2" if normal[2] > 0.5 else "#dddddd" if normal[1] < -0.5 \
                    else "#cccccc"
                out.append('<polygon points="%s" fill="%s" stroke="%s" stroke-width="1.5"/>' % (
                    " ".join("%.1f,%.1f" % p for p in points), shade, INK))
                middle = flat(turned(axes, [0.65 * sign * SIZE[k] * (k == i) for k in range(3)]),
                              centre)
                out.append(text((middle[0], middle[1] + 4), letter + ("+" if sign > 0 else "−"),
                                13, COLOURS[letter], weight="bold"))
    return "".join(out)


def picture(width, height, parts):
    return ('<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" '
            'viewBox="0 0 %d %d" font-family="sans-serif"><rect width="100%%" height="100%%" '
            'fill="%s"/>%s</svg>\n' % (width, height, width, height, PAPER, "".join(parts)))


def faces():
    """The six faces in the order that the board asks for them."""
    parts = []
    for k, name in enumerate(ORDER):
        centre = (120 + 220 * (k % 3), 110 + 210 * (k // 3))
        axes = ATTITUDES[name]
        parts.append(line((centre[0] - 95, centre[1] + 62), (centre[0] + 95, centre[1] + 62),
                          FAINT, 2))
        parts.append(box(axes, centre))
        parts.append(text((centre[0], centre[1] + 88), "%d.  %s up" % (
            k + 1, name.replace("-", "−")), 15, weight="bold"))
    return picture(680, 430, parts)


def flip():
    """The half turn on one face."""
    parts = []
    half = {"a": ATTITUDES["Z+"], "b": ((-1, 0, 0), (0, -1, 0), (0, 0, 1))}
    for k, (name, axes) in enumerate(half.items()):
        centre = (125 + 330 * k, 100)
        parts.append(line((centre[0] - 100, 165), (centre[0] + 100, 165), FAINT, 2))
        parts.append(box(axes, centre))
        parts.append(text((centre[0], 192), "Z+%s" % name, 15, weight="bold"))
    parts.append('<path d="M 245 70 C 275 30, 315 30, 342 66" fill="none" stroke="%s" '
                 'stroke-width="2.5"/>' % INK)
    parts.append(arrow((338, 59), (346, 74), INK))
    parts.append(text((292, 26), "180°, flat on the table"))
    parts.append(text((292, 215), "what the table's tilt adds changes its sign, "
                      "what the sensor adds does not", 12))
    return picture(585, 230, parts)


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
    found = {"faces.svg": faces(), "flip.svg": flip()}
    found.update(("wiring-%s.svg" % board, wiring(board)) for board in BOARDS)
    return found


if __name__ == "__main__":
    HERE.mkdir(exist_ok=True)
    for name, svg in pictures().items():
        (HERE / name).write_text(svg)
        print(HERE / name, file=sys.stderr)
