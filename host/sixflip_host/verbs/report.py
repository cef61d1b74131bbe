"""sixflip report: one page to look at, of a calibration, its verification and its gap."""

import os
import tempfile
from pathlib import Path

from .. import atomic_write, file_kinds, progress
from ..calibrate import solution, verify_files
from ..capture import capture_file
from ..errors import BadFile, UsageError
from ..file_arguments import add_input, add_output
from ..terminal import plain

EXAMPLE = ("sixflip report pulled/e6614c311b4c5a2f -o report.html\n"
           "         sixflip report warming.csv cooling.csv --gap -o gap.html")


def add_arguments(parser):
    """The options of the verb."""
    add_input(parser, "files", nargs="+", metavar="DIR | CAPTURE [RECORD]",
              help="the folder `pull` made, or a capture, or a capture and its record; with --gap "
                   "more captures, a session each")
    add_output(parser, "-o", "--output", default="report.html", metavar="FILE.html",
               kinds=(file_kinds.PAGE,), help="default: report.html")
    parser.add_argument("--gap", action="store_true",
                        help="diagnose the captures too (takes a while)")


def run(args):
    """Write the page; 0 whatever it says."""
    if not args.output.endswith((".html", ".htm")):
        raise UsageError("-o %s: expected the name of an .html file" % args.output)
    with progress.during("report"):
        path, capture, record_path, record, more = _find(args.files, args.gap)
        atomic_write.write_text(args.output, page(path, capture, record_path, record,
                                                  [path, *more] if args.gap else []))
    print(plain(args.output))
    return 0


def _find(files, gap):
    """(path, Capture, path or None, Record or None, further captures)."""
    if len(files) == 1 and os.path.isdir(files[0]):
        return (*verify_files.find(files), [])
    captures = [name for name in files if not _is_record(name)]
    records = [name for name in files if name not in captures]
    if not captures or len(records) > 1 or (len(captures) > 1 and not gap):
        raise UsageError("%d captures and %d records: expected DIR, or one capture with one "
                         "record at most (several captures with --gap)" % (
                             len(captures), len(records)))
    record = verify_files.read_record(records[0]) if records else None
    return (captures[0], capture_file.read(captures[0]), records[0] if records else None, record,
            captures[1:])


def _is_record(name):
    if os.path.isdir(name):
        raise BadFile("%s: is a folder, expected it alone, or captures" % name)
    return file_kinds.kind_of(name) == file_kinds.RECORD


def page(path, capture, record_path, record, gap_of=()):
    """The HTML. gap_of: captures to diagnose; record_path and record may be None."""
    from ..present import sections
    from ..present.page import Page
    board = capture.meta.get("device_id")
    board = str(board)[:sections.LONGEST] if board else None
    solved = solution.solve(capture, None if record is None else record.g)
    html = Page("Sixflip: %s" % (board or os.path.basename(str(path))),
                "Calibration of %s" % ("board " + board if board else os.path.basename(str(path))))
    sections.facts(html, capture, record, board)
    sections.calibration(html, solved, record)
    sections.session(html, capture)
    if record is not None:
        sections.verification(html, capture, record_path, record)
    sections.board_history(html, board)
    if gap_of:
        with tempfile.TemporaryDirectory(prefix="sixflip-report-") as folder:
            sections.gap(html, Path(folder), gap_of)
    return html.html()
