"""Capture, records and settings of a board into a folder here."""

import json
from pathlib import Path

from sixflip.capture import reader as capture_reader

from .. import file_kinds
from ..atomic_write import write_bytes
from ..capture import capture_binary, capture_file
from ..errors import BadFile, NoBoard
from ..file_arguments import may_replace
from ..terminal import plain
from .byte_progress import Bytes

CAPTURES = ("capture.bin", "unsaved.bin", "refused.bin")
LONGEST_HEADER = 8192   # bytes, many times what the firmware writes in front of the samples
WANTED = ("record_a.bin", "record_b.bin", "sixflip.json", *CAPTURES)
# What a file there may be to be replaced, those of convert() with them.
KINDS = {"record_a.bin": (file_kinds.RECORD,), "record_b.bin": (file_kinds.RECORD,),
         "sixflip.json": (file_kinds.JSON,),
         **dict.fromkeys(CAPTURES, (file_kinds.BOARD_CAPTURE,)),
         **{name.replace(".bin", ".csv"): (file_kinds.CAPTURE,) for name in CAPTURES}}


def folder_name(board_id):
    """A name for a folder made of a board's id, which is not to be trusted."""
    return "".join(c for c in board_id if c.isalnum() and c.isascii())[:40] or "board"


def fetch(link, output, say=print, force=False):
    """Copy what is there into output/<board id>; returns that folder.

    force: replace there what is none of a board's files, too.

    Only names of WANTED are asked for and written: no name of the board's reaches a path here.
    A capture there of another session than the board's is kept: keep_earlier().
    """
    present = link.files([])
    names = [name for name in WANTED if name in present]
    if not names:
        raise NoBoard("%s: nothing of sixflip is on this board: sixflip provision" % link.port)
    folder = Path(output) / folder_name(link.board_id())
    may_replace([(folder / name, kinds) for name, kinds in KINDS.items()], force)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadFile("%s: cannot be made: %s" % (folder, error.strerror)) from None
    done = 0
    with Bytes("fetching", sum(present[name][0] for name in names)) as bar:
        for name in names:
            data = link.get(name, lambda n, base=done: bar.at(base + n), present[name][0])
            if name in CAPTURES:
                keep_earlier(folder / name, session_of(data), say, force)
            write_bytes(folder / name, data)
            done += len(data)
            say("%s (%d bytes)" % (plain(folder / name), len(data)))
    for name in set(CAPTURES).difference(names):
        keep_earlier(folder / name, None, say, force)
    return folder


def session_of(data):
    """The number of a board's capture's session, None where the file does not tell."""
    try:
        header = capture_reader.read(data[:LONGEST_HEADER]).meta_bytes
        number = json.loads(header)["session"]
    except (KeyError, TypeError, ValueError, RecursionError):
        return None
    return number if type(number) is int and 0 <= number < 1 << 32 else None


def keep_earlier(path, session, say, force):
    """Renames a capture of an earlier session, with its text form, to NAME-SESSION: the board
    keeps one of a kind, and what is here may be all that is left of it.

    session  of the board's capture of that name, None where the board has none
    """
    earlier = session_of(path.read_bytes()) if path.exists() else None
    if earlier in (None, session):
        return
    moves = [(was, was.with_name("%s-%08x%s" % (was.stem, earlier, was.suffix)))
             for was in (path, path.with_suffix(".csv")) if was.exists()]
    may_replace([(to, KINDS[was.name]) for was, to in moves], force)
    for was, to in moves:
        was.replace(to)
    say("%s: the capture of an earlier session that was pulled here" % plain(moves[0][1]))


def convert(folder, say=print):
    """Write a .csv beside every capture that holds samples; a BadFile for each that is none."""
    unreadable = []
    for name in CAPTURES:
        path = Path(folder) / name
        if not path.exists():
            continue
        data = path.read_bytes()
        if capture_binary.is_empty(data):
            say("%s is empty: its session ended before anything was captured" % plain(path))
            continue
        try:
            capture = capture_binary.decode(data, str(path))
        except BadFile as error:
            unreadable.append(error)
            continue
        if len(capture.t_us):
            table = path.with_suffix(".csv")
            capture_file.write(table, capture)
            say("%s (%d samples)" % (plain(table), len(capture.t_us)))
        else:
            say("%s holds the poses' sums only, no samples" % plain(path))
    return unreadable
