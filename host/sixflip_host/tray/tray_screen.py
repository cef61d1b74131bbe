"""A Tray as a screen: what to do, a drawing, what was said, and a row a board. Pure."""

from rich.text import Text

from ..board.event_words import ROUND
from ..guide import box_drawings
from ..guide.next_step import FLIP, HOLD, PLACE, WAIT
from ..guide.screen import HEIGHT, QUIT, REDO, VERDICT, WIDTH, beside, fit, in_ascii, wrapped
from ..guide.session_state import CALIBRATING
from .member import SHORT
from .tray_words import headline, keeps_still, status

DRAWN = 10              # rows of drawing and log
LEFT = 39               # columns of the drawing
KEYS = "r redo a face   u undo   q quit   ? help"
KEYS_OVER = "r redo a face   q or Enter leave   ? help"
HELP = (
    "All boards lie in one jig and are turned together. X Y Z are the axes of the board",
    "with the number that the title names; the others may lie in the jig in any way.",
    "",
    "Every board sees for itself that it lies still, and takes its pose. One that misses",
    "a pose says why; its face comes again when all the others are done. One that fails",
    "leaves the tray, and the rest goes on.",
    "",
    "marks of a face: both placements, first and turned, ✓ taken, · still to come",
    "",
    "  r  take a face again, by all boards      u  the same for the last face taken",
    "  q  quit; sixflip calibrate --all --continue goes on with what was captured",
    "  Ctrl-C  the same, without a question",
    "",
    "any key closes this",
)


def title(tray):
    there = [member for member in tray.members if not member.gone]
    words = ["sixflip calibrate --all", "%d of %d boards in the tray" % (
        len(there), len(tray.members))]
    if tray.reference:
        words.append("X Y Z as on board %d" % tray.member(tray.reference).number)
    return Text(fit("   ".join(words), WIDTH), "bold")


def marks(member, face):
    """The two placements on a face of the jig."""
    own, state = member.own(face), member.state
    cell = Text(" ")
    for letter in "ab":
        name = own + letter
        if own and state.stage == CALIBRATING and state.box == "capturing" and state.pose == name:
            cell.append("•", "bold cyan")
        elif own and name in state.taken:
            cell.append("✓", "green")
        else:
            cell.append("·", "dim" if member.gone else "")
    cell.append(" ")
    return cell


def row(tray, member):
    """Number, id, faces and what it does, in WIDTH columns."""
    awaited = member in tray.awaited()
    line = Text("%s%2d %-8s" % ("▶" if awaited else " ", member.number,
                                member.state.board[:SHORT]), "dim" if member.gone else "")
    for face in ROUND:
        line.append(marks(member, face))
    verdict = member.state.verdict
    style = "red" if member.gone else VERDICT.get(verdict, "")
    line.append("  ")
    line.append(fit(status(tray, member), WIDTH - len(line)), style)
    return line


def heading(tray):
    line = Text("   board    ", "bold")
    for face in ROUND:
        line.append(" %s " % face, "bold cyan" if face == tray.face and not tray.over else "bold")
    return line


def drawn(tray):
    """The kind of drawing, of next_step's kinds."""
    if not tray.running or not tray.face:
        return WAIT
    if keeps_still(tray):
        return HOLD
    return FLIP if tray.letter == "b" else PLACE


def drawing(tray):
    """The jig as it is to be laid."""
    kind = drawn(tray)
    if kind == WAIT:
        return []
    pose = tray.face + (tray.letter if kind == HOLD else "")
    return [Text(line) for line in box_drawings.drawing(kind, pose)]


def told(tray, rows, columns):
    """The newest lasting lines, broken into so many columns."""
    lines = []
    for said in tray.log[-rows:] if rows else ():
        lines += wrapped(said, columns)
    return [Text(line, "dim") for line in lines[-rows:]]


def screen(tray, asking="", note="", ascii_only=False, height=HEIGHT):
    """So many lines of rich Text. asking: "", redo, quit or help; note: a line of the host's."""
    rule = Text("─" * WIDTH, "dim")
    lines = [title(tray), rule]
    if asking == "help":
        lines += [Text(" " + line) for line in HELP]
    else:
        boards = [row(tray, member) for member in tray.members]
        room = max(0, height - 6)       # without title, rules, headline, heading and foot
        if len(boards) > room:
            boards = boards[:room - 1] + [Text("   and %d more" % (len(boards) - room + 1))]
        rows = room - len(boards)
        picture = drawing(tray) if rows >= DRAWN - 1 else []
        lines.append(Text(fit(note or headline(tray), WIDTH),
                          "bold yellow" if note else "bold cyan"))
        left = LEFT if picture else 1
        lines += beside(picture, told(tray, rows, WIDTH - left), rows, left)
        lines += [rule, heading(tray), *boards]
    lines += [Text("")] * (height - 1 - len(lines))
    lines = [*lines[:height - 1], foot(tray, asking)]
    for line in lines:
        line.truncate(WIDTH)
    return [in_ascii(line) for line in lines] if ascii_only else lines


def foot(tray, asking):
    if asking in ("redo", "quit"):
        return Text(REDO if asking == "redo" else QUIT.replace("board", "boards"),
                    "bold reverse")
    return Text(KEYS_OVER if tray.over else KEYS, "dim")
