"""The command `sixflip`: the verbs of verb_table.py, one module each, loaded when asked for.

A verb's module has EXAMPLE, add_arguments(parser) and run(args) -> exit code, and more() where its
help ends in a text.
"""

import argparse
import contextlib
import importlib
import os
import re
import shutil
import sys
import textwrap
import traceback

from . import ctrl_c, file_arguments, sample_limit
from .did_you_mean import closest, instead
from .errors import SixflipError, UsageError, internal_error
from .narration import log, narrated
from .terminal import plain
from .verb_table import VERBS

# For every verb, and wherever they stand on the command line.
GLOBAL = {
    "--quiet": "print nothing but errors, and what --json or a stream prints",
    "--verbose": "say on stderr what is being done",
    "--debug": "show where an error came from",
}
TALKS = ("stream", "completion", "virtual-board", "ui")    # what they print is what they are for

EXIT_CODES = ("exit codes: 0 done, 1 a check failed or a calibration was refused, "
              "2 wrong command line, 3 no board or no chip, 4 a bad file;\n"
              "130 stopped with Ctrl-C, 70 an error of sixflip's own: please report it, with\n"
              "what the same command says with --debug, sixflip --version, and the file if any")
INTERNAL_ERROR = 70     # sysexits.h EX_SOFTWARE
INTERRUPTED = 130       # what shells report after Ctrl-C
BROKEN_PIPE = 141       # what shells report after SIGPIPE
LONGEST_LINE = 1000     # of an error: what a file or a board holds must not flood a terminal


class Parser(argparse.ArgumentParser):
    """argparse whose complaints are one line, like every other error of this tool, and ask what
    was meant; whose help keeps within the line."""

    def error(self, message):
        raise UsageError("%s (see %s --help)" % (self.asked_back(message), self.prog))

    def asked_back(self, message):
        """argparse's sentence on an unknown option or choice, with the nearest one there is."""
        option = re.search(r"unrecognized arguments: (--[^ =]+)", message)
        if option:
            near = closest(option[1], self._option_string_actions)
            return message + (", did you mean %s?" % near if near else "")
        choice = re.search(r"invalid choice: (.*) \(choose from (.*)\)", message)
        if choice:
            near = closest(choice[1].strip("'"), re.findall(r"[^', ]+", choice[2]))
            return message + (", did you mean %s?" % near if near else "")
        return message

    def format_help(self):
        return "\n".join(filled(line) for line in super().format_help().split("\n"))


def filled(line):
    """A line of help broken between words at the width of the terminal, 80 in a pipe; its
    further lines begin where its text began, behind a column of names."""
    columns = shutil.get_terminal_size().columns
    if len(line) <= columns:
        return line
    indent = re.match(r" *(\S+ {2,})?", line).end()
    return textwrap.fill(line, max(40, columns), subsequent_indent=" " * indent,
                         break_long_words=False, break_on_hyphens=False)


def overview():
    """The text of `sixflip --help`: every verb with its line."""
    lines = ["usage: sixflip VERB [options]", "",
             "On-board calibration of an inertial sensor, and its check on the host.", ""]
    for verb in VERBS:
        lines.append("  %-14s %s" % (verb, VERBS[verb][1]))
    lines += ["", "sixflip VERB --help says more about one of them. With every verb:"]
    lines += ["  %-14s %s" % item for item in GLOBAL.items()]
    lines += ["", EXIT_CODES]
    return "\n".join(filled(line) for line in lines)


def load(verb):
    """The module behind a verb."""
    return importlib.import_module(VERBS[verb][0])


def parser_for(verb):
    """The argument parser of one verb."""
    module = load(verb)
    parser = Parser(prog="sixflip " + verb, description=VERBS[verb][1], allow_abbrev=False,
                    epilog="example: %s\n\n%s%s" % (
                        module.EXAMPLE, module.more() if hasattr(module, "more") else "",
                        EXIT_CODES),
                    formatter_class=argparse.RawDescriptionHelpFormatter)
    add_global(parser)
    module.add_arguments(parser)
    return parser


def add_global(parser):
    """The options of every verb; main() has obeyed GLOBAL before a parser sees the rest."""
    for name, words in GLOBAL.items():
        parser.add_argument(name, action="store_true", help=words)
    parser.add_argument("--limit", type=int, default=sample_limit.USUAL, metavar="SAMPLES",
                        help="how many there may be in a file (default: %(default)d)")


def run(argv):
    """Do what the command line says; returns the exit code, raises what went wrong."""
    if not argv or argv[0] in ("-h", "--help", "help"):
        print(overview())
        return 0 if argv else UsageError.exit_code
    if argv[0] == "--version":
        from sixflip import __version__
        print("sixflip", __version__)
        return 0
    verb = argv[0]
    if verb.startswith("-"):
        raise UsageError("no option %r, %s" % (verb, instead(verb, ("--help", "--version"))))
    if verb not in VERBS:
        raise UsageError("there is no verb %r, %s" % (verb, instead(verb, VERBS)))
    parser = parser_for(verb)
    args = parser.parse_args(argv[1:])
    file_arguments.check(parser, args)
    with sample_limit.at_most(args.limit):
        return load(verb).run(args) or 0


def main(argv=None):
    """Entry point. Whatever happens, one line on stderr and an exit code; no traceback."""
    argv = sys.argv[1:] if argv is None else list(argv)
    debug, verbose = "--debug" in argv, "--verbose" in argv
    quiet = "--quiet" in argv and "--json" not in argv and not set(TALKS) & set(argv)
    argv = [word for word in argv if word not in GLOBAL]
    prepare_streams()
    try:
        with narrated(verbose), silenced(quiet), ctrl_c.kept():
            log.info("sixflip %s", " ".join(argv))
            code = run(argv)
            sys.stdout.flush()
            log.info("exit code %d", code)
        return code
    except SystemExit as stop:      # argparse after --help
        return stop.code or 0
    except KeyboardInterrupt:
        return complain("stopped", INTERRUPTED, debug)
    except BrokenPipeError:         # `sixflip show x | head`: not an error worth a word
        throw_away_stdout()
        return BROKEN_PIPE
    except SixflipError as error:
        return complain(str(error), error.exit_code, debug)
    except OSError as error:
        name = "%s: " % error.filename if error.filename else ""
        code = 4 if error.filename else 1
        try:
            sys.stdout.flush()
        except OSError:                 # a full disk behind stdout: Python would say so again
            throw_away_stdout()
        return complain("%s%s" % (name, error.strerror or error), code, debug)
    except MemoryError:
        return complain("there is not enough memory for this", 4, debug)
    except Exception as error:      # a bug of ours: still one line
        return complain(internal_error(error), INTERNAL_ERROR, debug)


@contextlib.contextmanager
def silenced(wanted):
    """While it lasts nothing is printed on stdout, if that is wanted."""
    if not wanted:
        yield
        return
    with open(os.devnull, "w", encoding="utf-8") as nowhere, contextlib.redirect_stdout(nowhere):
        yield


def prepare_streams():
    """A stream that is closed swallows; one that cannot show ± or ² writes it as \\xb1."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w"))
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def throw_away_stdout():
    """Whatever is still to be printed goes nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def complain(line, code, debug):
    """Print the one line; with --debug also where it came from."""
    if debug:
        traceback.print_exc()
    line = plain(line)
    print("sixflip:", line if len(line) <= LONGEST_LINE else line[:LONGEST_LINE] + " ...",
          file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
