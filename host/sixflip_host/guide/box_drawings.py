"""Drawings of the box on its table, made of characters: every face up, and the half turn.

A box has the names of its faces written on it, as far as they are seen: on top, in front, on
the right. They are right-handed: right x away from the reader = up.
"""

# face that is up: (in front, on the right); where it can be, the chip's side Z+ is in front.
SEEN = {"Z+": ("Y-", "X+"), "Z-": ("Y+", "X+"), "X+": ("Z+", "Y-"), "X-": ("Z+", "Y+"),
        "Y+": ("Z+", "X+"), "Y-": ("Z+", "X-")}
ASCII = str.maketrans("─│┌┐└┘╱╲▶═✓·█░▒•", "-|++++/\\>=x.#.:o")
BIG = (
    "      ┌─────────────┐",
    "     ╱      {t}     ╱│",
    "    ╱      up     ╱ │",
    "   ┌─────────────┐{r}│",
    "   │             │  │",
    "   │     {f}      │ ╱",
    "   │             │╱",
    "   └─────────────┘",
)
SMALL = (
    "   ┌───────┐",
    "  ╱  {t}   ╱│",
    " ┌───────┐{r}│",
    " │  {f}   │ ╱",
    " └───────┘╱ ",
)
LEANING = (
    "",
    "          ╱╲",
    "        ╱    ╲",
    "      ╱        ╲┌──────┐",
    "      ╲        ╱│ some │",
    "        ╲    ╱  │ thing│",
    "          ╲╱    │      │",
)
TABLE = "═"


def opposite(face):
    return face[0] + ("-" if face[1] == "+" else "+")


def turned(seen):
    """(front, right) after half a turn on the table."""
    return opposite(seen[0]), opposite(seen[1])


def filled(lines, top, front, right):
    return [line.format(t=top, f=front, r=right) for line in lines]


def placed(face, half_turned=False):
    """The box with a face up: nine lines."""
    front, right = turned(SEEN[face]) if half_turned else SEEN[face]
    return filled(BIG, face, front, right) + [TABLE * 24]


def flip(face):
    """The box before and after the half turn, side by side."""
    seen = SEEN[face]
    left = filled(SMALL, face, *seen)
    right = filled(SMALL, face, *turned(seen))
    between = ("         ", " 180 deg ", "  ───▶   ", "         ", "         ")
    rows = [a.ljust(13) + b + c for a, b, c in zip(left, between, right)]
    return ["", "         half a turn", *rows, TABLE * 36, ""]


def leaning():
    return [*LEANING, TABLE * 30]


def drawing(kind, pose):
    """Lines for a next_step.Step's kind and pose; [] where there is nothing to draw."""
    face = pose[:2]
    if kind == "lean":
        return leaning()
    if face not in SEEN:
        return []
    return flip(face) if kind == "flip" else placed(face, pose[2:] == "b")


def ascii_only(text):
    """The same where only ASCII can be shown."""
    return text.translate(ASCII).encode("ascii", "replace").decode()
