"""Files that are there whole or not at all."""

import contextlib
import os
import secrets

from .errors import BadFile
from .narration import log

LARGEST = 64 << 20      # bytes of a file that is read in one go


def write_bytes(path, data):
    """Write `data` beside `path` under another name, then rename: never half a file."""
    write_pieces(path, [data])


def write_pieces(path, pieces):
    """The same of an iterable of bytes, none of which has to be there before its turn."""
    path = os.path.realpath(path) if os.path.islink(path) else os.fspath(path)
    folder = os.path.dirname(path) or "."
    if os.path.isdir(path):
        raise BadFile("%s: is a folder, expected the name of a file to write" % path)
    log.info("writing %s", path)
    if os.path.exists(path) and not os.path.isfile(path):
        return _into(path, pieces)      # a device, a pipe: never put a file in its place
    # named before it is there: Ctrl-C at any moment leaves nothing that is not taken away
    temporary = os.path.join(folder, "%s.%s.new" % (
        os.path.basename(path)[:60], secrets.token_hex(4)))
    try:
        with open(temporary, "xb") as file:
            file.writelines(pieces)
        os.replace(temporary, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        if isinstance(error, OSError):
            raise BadFile("%s: cannot be written: %s" % (path, error.strerror))
        raise


def _into(path, pieces):
    try:
        with open(path, "wb") as file:
            file.writelines(pieces)
    except OSError as error:
        raise BadFile("%s: cannot be written: %s" % (path, error.strerror))


def write_text(path, text):
    """write_bytes of UTF-8 text with the newlines it has."""
    write_bytes(path, text.encode("utf-8"))


def read_bytes(path):
    """The bytes of a file that is no recording, or BadFile saying why not."""
    log.info("reading %s", path)
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST + 1)
    except OSError as error:
        raise BadFile("%s: cannot be read: %s" % (os.fspath(path), error.strerror))
    if len(data) > LARGEST:
        raise BadFile("%s: more than %d MB, expected a record, a plan or the like" % (
            os.fspath(path), LARGEST >> 20))
    return data
