"""What can go wrong for a user of the host tool: one line and one exit code each."""


class SixflipError(Exception):
    """Ends the program with one line on stderr and `exit_code`; never a traceback."""

    exit_code = 1


def internal_error(error):
    """The one line for a bug of ours, for a terminal or a page."""
    return ("internal error: %s: %s; please report it, with what the same command says with "
            "--debug, sixflip --version, and the file or board it was about"
            % (type(error).__name__, error))


class CheckFailed(SixflipError):
    """Something was measured or compared, and the answer is no."""

    exit_code = 1


class UsageError(SixflipError):
    """The command line asks for something that cannot be."""

    exit_code = 2


class Interrupted(SixflipError):
    """Ctrl-C, and what became of the work under way."""

    exit_code = 130


class NoBoard(SixflipError):
    """No board, no chip, no answer, or a port that somebody else holds."""

    exit_code = 3


class BadFile(SixflipError):
    """A file that is missing, damaged or not what it should be.

    The line names the file, the place in it where there is one, and what was expected:
    `walk.csv line 17: az is "1.5", expected a whole number of counts`.
    """

    exit_code = 4

    @classmethod
    def at(cls, path, line, fault, expected=None):
        """BadFile for one line of a text file; `line` counts from 1, 0 is the whole file."""
        where = "%s line %d" % (path, line) if line else str(path)
        return cls("%s: %s" % (where, fault) + (", expected %s" % expected if expected else ""))
