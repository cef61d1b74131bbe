"""A State as a screen: 80 by 24 characters, readable without colour. Pure: no terminal here."""

from rich.text import Text

from ..board.event_words import ROUND, saved
from . import box_drawings
from .gauges import bar, measured
from .next_step import HOLD, next_step, why_it_waits
from .session_state import CALIBRATING, OVER, WAITING

WIDTH, HEIGHT = 80, 24
LEFT = 30               # columns of the table of faces
DRAWN = 9               # rows of a drawing
KEYS = "r redo a face   u undo   q quit   ? help"
KEYS_OVER = "r redo a face   q or Enter leave   ? help"
REDO = "redo which face?  " + "  ".join("%d %s" % item for item in enumerate(ROUND, 1)) + \
    "   Esc none"
QUIT = "quit? What is captured stays on the board: y yes   n go on"
HELP = (
    "The letters X Y Z are the axes printed beside the sensor's chip; Z+ up is the",
    "chip's printed side up. X+ up: the side the X arrow points to is up.",
    "",
    "Lay the box on a face and let go: the board sees by itself that it lies still,",
    "which face is up, and when it has enough. Then turn it by half a turn, flat on",
    "the table, same face up. Faces may come in any order.",
    "",
    "  r  take a face again, both placements    u  the same for the last face taken",
    "  q  quit; sixflip calibrate --continue goes on with what was captured",
    "  Ctrl-C  the same, without a question",
    "",
    "noise: how much the last quarter second shakes, against the sensor's own noise,",
    "learnt at the start; above the limit the box is not at rest.",
    "",
    "any key closes this",
)
VERDICT = {"good": "bold green", "doubtful": "bold yellow", "refused": "bold red"}


def lasting_s(seconds):
    return "%d:%02d" % divmod(int(seconds), 60)


def fit(text, width):
    return text if len(text) <= width else text[:width - 1] + "…"


def title(state, where):
    parts = ("sixflip calibrate", state.chip, state.board and "board " + state.board, where)
    return Text(fit("   ".join(part for part in parts if part), WIDTH), "bold")


def mark(state, pose):
    """(text, style) of a placement in the table of faces."""
    if state.box == "capturing" and state.pose == pose:
        return "%3d %%" % (100 * state.progress / max(1, state.total)), "bold cyan"
    if pose in state.taken:
        return "  ✓  ", "green"
    return "  ·  ", ""


def faces(state, step):
    """The table of faces, or what a plan has done: lines of LEFT columns."""
    if state.plan:
        share = state.at / max(1, state.planned)
        return [Text("placements of the plan", "bold"),
                Text("%d of %d" % (state.at, state.planned)),
                Text(bar(share, LEFT - 4)), Text(""), Text("next  " + state.next),
                Text("now   " + (state.pose or state.box))]
    lines = [Text("face      first  turned", "bold")]
    for number, face in enumerate(ROUND, 1):
        here = step.face == face and state.stage == CALIBRATING
        line = Text("%s%d %s up   " % ("▶" if here else " ", number, face),
                    "bold" if here else "")
        for letter in "ab":
            line.append(" ")
            line.append(*mark(state, face + letter))
        lines.append(line)
    done = sum(1 for pose in state.taken if len(pose) == 3)
    lines.append(Text(""))
    lines.append(Text("%d of 12 taken" % done))
    return lines


def result(state):
    """The verdict and its numbers: beside the table once it is over."""
    if not state.verdict:
        return [Text("no calibration came of this session", "bold")]
    solved = state.solved
    lines = [Text.assemble("verdict: ", (state.verdict, VERDICT.get(state.verdict, ""))), Text("")]
    for piece in wrapped(str(solved.get("reason") or ""), WIDTH - LEFT - 2)[:4]:
        lines.append(Text(piece))
    for name, key, unit in (("table tilt", "tilt_deg", "deg"),
                            ("faces agree in it within", "tilt_spread_deg", "deg"),
                            ("residual", "residual_mg_rms", "mg")):
        if isinstance(solved.get(key), float):
            lines.append(Text("%s %.2f %s" % (name, solved[key], unit)))
    gyro = solved.get("gyro")
    if isinstance(gyro, dict):
        lines.append(Text("gyro: %s" % gyro.get("verdict")))
    if state.saved:
        lines += [Text(piece) for piece in wrapped(saved(state.saved), WIDTH - LEFT - 2)[:3]]
        lines.append(Text("next: sixflip pull, and sixflip verify"))
    return lines


def wrapped(text, width):
    """Lines of whole words."""
    lines, line = [], ""
    for word in text.split():
        while len(word) > width:
            lines.append((line + " " + word)[:width].strip())
            word, line = (line + " " + word)[width:].strip(), ""
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = ""
        line = (line + " " + word).strip()
    return lines + [line] if line else lines


def instruction(state, step):
    """Headline, drawing and detail: beside the table of faces."""
    if state.stage == OVER:
        return result(state)
    lines = [Text(fit(step.head, WIDTH - LEFT), "bold cyan")]
    details = wrapped(step.detail, WIDTH - LEFT)
    drawn = box_drawings.drawing(step.kind, state.pose if step.kind == HOLD else step.face)
    lines += [Text(line) for line in details[:2 if drawn else DRAWN]]
    return lines + [Text(line) for line in drawn]


def clock(state):
    """Time gone, time left at this pace, and until the board gives up."""
    if state.stage != CALIBRATING:
        return ""
    words = ["session %s" % lasting_s(state.now - state.since)]
    left = state.left()
    if left is not None:
        words.append("about %s left" % lasting_s(left))
    if state.box not in ("capturing", "resting", "") and 0 < state.left_s < 100:
        words.append("the board gives up in %d s" % state.left_s)
    return ", ".join(words)


def foot(state, asking):
    if asking == "redo":
        return Text(REDO, "bold reverse")
    if asking == "quit":
        return Text(QUIT, "bold reverse")
    if state.stage == WAITING:
        return Text("q quit   ? help", "dim")
    return Text(KEYS_OVER if state.stage == OVER else KEYS, "dim")


def beside(left, right, rows, columns=LEFT):
    """Two columns as one; so many columns of the left one."""
    lines = []
    for k in range(rows):
        line = left[k].copy() if k < len(left) else Text("")
        line.append(" " * max(0, columns - len(line)))
        lines.append(line + right[k] if k < len(right) else line)
    return lines


def screen(state, where="", asking="", note="", step=None, ascii_only=False, height=HEIGHT):
    """So many lines of rich Text. where: the port; asking: "", redo, quit or help; note: a line
    of the host's own; step: of a plan, see Console."""
    rule = Text("─" * WIDTH, "dim")
    if asking == "help":
        lines = [title(state, where), rule] + [Text(" " + line) for line in HELP]
    else:
        here = next_step(state, step)
        lines = [title(state, where), rule]
        lines += beside(faces(state, here), instruction(state, here), DRAWN + 2)
        waits = note or why_it_waits(state)
        timed = clock(state)
        lines.append(Text("── " + timed + " " + "─" * max(0, WIDTH - 4 - len(timed)), "dim")
                     if timed else rule)
        lines += measured(state)
        lines.append(Text(fit(" " + waits, WIDTH), "bold yellow") if waits else Text(""))
        room = height - len(lines) - 1
        told = [Text(" " + fit(line, WIDTH - 1)) for line in state.log[-room:]]
        lines += told + [Text("")] * (room - len(told))
    lines += [Text("")] * (height - 1 - len(lines))
    lines.append(foot(state, asking))
    for line in lines:
        line.truncate(WIDTH)
    if ascii_only:
        lines = [in_ascii(line) for line in lines]
    return lines


def in_ascii(line):
    """The same line in characters every terminal has; styles stay where they were."""
    plain = box_drawings.ascii_only(line.plain)
    return Text(plain, line.style, spans=line.spans)
