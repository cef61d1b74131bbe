"""Words for a person on a terminal: escaped, coloured only where colour is wanted."""

import sys

PIPE_WIDTH = 200        # of tables that go into a file: no line is broken


def plain(text):
    """Text from a file or a board with everything a terminal would obey made visible.

    Control characters, escape sequences, bidirectional overrides and lone surrogates come out
    as \\x1b, \\u202e and the like, so that no capture can move the cursor or hide a line.
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape", "replace").decode()
                   for c in str(text))


def console(stderr=False):
    """A rich console; rich itself honours NO_COLOR, and a pipe gets no colour at all."""
    from rich.console import Console

    class OurConsole(Console):
        """rich itself ends the program with 1 when a pipe is closed."""

        def on_broken_pipe(self):
            raise BrokenPipeError

    on_terminal = (sys.stderr if stderr else sys.stdout).isatty()
    return OurConsole(stderr=stderr, highlight=False, markup=False, emoji=False,
                      width=None if on_terminal else PIPE_WIDTH)


def table(title, columns, rows):
    """A rich table of plain strings; the first column is flush left, the others flush right."""
    from rich import box
    from rich.table import Table
    from rich.text import Text
    out = Table(title=Text(plain(title)) if title else None, title_justify="left",
                title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for number, column in enumerate(columns):
        out.add_column(Text(plain(column)), justify="right" if number else "left", no_wrap=True)
    for row in rows:
        out.add_row(*[cell if isinstance(cell, Text) else Text(plain(cell)) for cell in row])
    return out


def styled(text, style):
    """A piece of text for a table or a print, in a colour where colours are shown."""
    from rich.text import Text
    return Text(plain(text), style=style)


VERDICT_STYLE = {"good": "bold green", "doubtful": "bold yellow", "refused": "bold red"}


def verdict_text(verdict):
    """`good`, `doubtful` or `refused` in the colour of its meaning."""
    return styled(verdict, VERDICT_STYLE.get(verdict, ""))
