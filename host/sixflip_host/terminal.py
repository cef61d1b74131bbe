"""Words and tables for a person: escaped, coloured where colour is wanted, never cut.

On a terminal sentences break between words; in a pipe each stays one line. A table that is
wider than the terminal, or than PIPE_WIDTH in a pipe, is folded: every row becomes its first
cell and below it the others, each with its column's name.
"""

import os
import re
import sys

PIPE_WIDTH = 100
NARROWEST = 40          # of text: below it a terminal may break the lines itself
PROSE_WIDTH = 30        # least width of a column of sentences; with less the table is folded


def plain(text):
    """Text from a file or a board with everything a terminal would obey made visible.

    Control characters, escape sequences, bidirectional overrides and lone surrogates come out
    as \\x1b, \\u202e and the like, so that no capture can move the cursor or hide a line.
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape", "replace").decode()
                   for c in str(text))


def width():
    """Columns that a pipe gets, or None: rich asks the terminal. COLUMNS decides in a pipe."""
    columns = os.environ.get("COLUMNS", "")
    return max(NARROWEST, int(columns)) if columns.isdecimal() else PIPE_WIDTH


def console(stderr=False):
    """A rich console; rich itself honours NO_COLOR, and a pipe gets no colour at all."""
    from rich.console import Console
    from rich.text import Text
    on_terminal = (sys.stderr if stderr else sys.stdout).isatty()

    class OurConsole(Console):
        """Strings and Texts are sentences: they break between words, or not at all."""

        def print(self, *objects, sep=" ", **more):
            if objects and all(isinstance(item, (str, Text)) for item in objects):
                objects = [Sentence(Text(sep).join(
                    item if isinstance(item, Text) else Text(item) for item in objects))]
            super().print(*objects, sep=sep, crop=False, **more)

        def on_broken_pipe(self):
            """rich itself ends the program with 1 when a pipe is closed."""
            raise BrokenPipeError

    ours = OurConsole(stderr=stderr, highlight=False, markup=False, emoji=False,
                      width=None if on_terminal else width())
    ours.breaks_lines = on_terminal
    return ours


class Sentence:
    """A line of text: where it has to break it goes on `hanging` columns in, by default two more
    than it begins with, or none where it begins at the edge."""

    def __init__(self, text, hanging=None):
        self.text, self.hanging = text, hanging

    def __rich_console__(self, console, options):
        for line in self.text.split("\n", allow_blank=True) or [self.text]:
            if not getattr(console, "breaks_lines", True):
                yield whole(line)
                continue
            indent = len(line.plain) - len(line.plain.lstrip(" "))
            hanging = self.hanging
            if hanging is None:
                hanging = indent + 2 if indent else 0
            yield from wrapped(line[indent:], options.max_width, indent, hanging)


def whole(line):
    """A Text that rich leaves alone."""
    line = line.copy()
    line.no_wrap, line.overflow = True, "ignore"
    return line


def wrapped(text, columns, indent, hanging):
    """Lines of a Text; a word that is longer than a line, a path say, is not broken. rich
    breaks it, so that it cannot be copied."""
    from rich.cells import cell_len
    from rich.text import Text
    lines, begin, end = [], 0, 0
    for word in re.finditer(r"\S+", text.plain):
        room = columns - (hanging if lines else indent)
        if end > begin and cell_len(text.plain[begin:word.end()]) > room:
            lines.append((begin, end))
            begin = word.start()
        end = word.end()
    for number, (first, last) in enumerate([*lines, (begin, end)]):
        yield whole(Text(" " * (hanging if number else indent)) + text[first:last])


class Table:
    """rows of strings or Texts under their columns, or folded where that is too wide.

    prose: the last column holds sentences; it is flush left and may break into several lines.
    """

    def __init__(self, title, columns, rows, prose=False):
        self.title = plain(title) if title else ""
        self.columns = [plain(column) for column in columns]
        self.rows = [[_text(cell) for cell in row] for row in rows]
        self.prose = prose

    def __rich_console__(self, console, options):
        from rich.text import Text
        if self.title:
            yield Sentence(Text(self.title, style="bold"))
        table = self._table()
        room = options.max_width
        if self._widest(console, table) <= room or self.prose and self._least(console) <= room:
            yield table
        else:
            yield from self._folded(options)
        yield Text("")

    def _table(self):
        from rich import box
        from rich.table import Table as RichTable
        from rich.text import Text
        drawn = RichTable(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
        last = len(self.columns) - 1
        for number, column in enumerate(self.columns):
            prose = self.prose and number == last
            drawn.add_column(Text(column), justify="left" if prose or not number else "right",
                             no_wrap=not prose)
        for row in self.rows:
            drawn.add_row(*row)
        return drawn

    @staticmethod
    def _widest(console, table):
        from rich.measure import Measurement
        return Measurement.get(console, console.options.update(width=10000), table).maximum

    def _least(self, console):
        """The width with the last column as narrow as a sentence can be read in."""
        shorter = Table("", self.columns[:-1], [row[:-1] for row in self.rows])
        return self._widest(console, shorter._table()) + PROSE_WIDTH + 3

    def _folded(self, options):
        """The first cell of a row alone, then the others behind the names of their columns, as
        many in a line as there is room for."""
        from rich.text import Text
        for row in self.rows:
            yield from wrapped(row[0], options.max_width, 2, 4)
            line = Text()
            for column, cell in list(zip(self.columns, row))[1:]:
                if not cell.plain:
                    continue
                piece = (Text(column + ": ") if column else Text()) + cell
                if line and 4 + line.cell_len + 3 + piece.cell_len > options.max_width:
                    yield from wrapped(line, options.max_width, 4, 6)
                    line = Text()
                line = line + Text("   ") + piece if line else piece
            if line:
                yield from wrapped(line, options.max_width, 4, 6)


def _text(cell):
    from rich.text import Text
    return cell if isinstance(cell, Text) else Text(plain(cell))


def table(title, columns, rows, prose=False):
    """A Table to print; the first column is flush left, the others flush right."""
    return Table(title, columns, rows, prose)


def say(lines):
    """Print lines of sentences, escaped."""
    printer = console()
    for line in lines:
        printer.print(plain(line))


def styled(text, style):
    """A piece of text for a table or a print, in a colour where colours are shown."""
    from rich.text import Text
    return Text(plain(text), style=style)


VERDICT_STYLE = {"good": "bold green", "doubtful": "bold yellow", "refused": "bold red"}


def verdict_text(verdict):
    """`good`, `doubtful` or `refused` in the colour of its meaning."""
    return styled(verdict, VERDICT_STYLE.get(verdict, ""))
