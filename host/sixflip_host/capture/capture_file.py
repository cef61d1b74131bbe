"""A capture in memory, read from text or board files and written as text.

The text format is sixflip-capture 1: a version line, a JSON line, column names, whole numbers.
"""

import itertools
import json
import zlib

import numpy as np

from sixflip.poses.faces import pose_name

from .. import atomic_write, sample_limit
from ..errors import BadFile
from . import board_extras, capture_binary
from .capture import Capture
from .capture_header import (
    LONGEST_LINE,
    VERSION,
    check_meta,
    parse_header,
)
from .capture_rows import parse_rows, quoted
from .unpack import Source

BOARD_MAGIC = b"6CAP"
FAR = 5.0               # times an interval that is no drift of a clock any more but another rate
FEW_TIMES = 20          # too few to say what is usual
ROWS_WRITTEN = 10_000    # at a time: as Python objects they take half a kilobyte each


def read(path, gyro_alone=False):
    """Read a capture: text, gzipped text, or the binary file of a board.

    gyro_alone  one without an accelerometer will do
    Raises BadFile with one line: the file, the line in it, what was found and expected.
    """
    pieces = Source(path).pieces()
    head = _begins(pieces, lambda head: len(head) < len(BOARD_MAGIC))
    if head.startswith(BOARD_MAGIC):
        data = bytearray(head)
        for piece in pieces:
            data += piece
            sample_limit.check_samples(path, len(data) // capture_binary.MOST_BYTES)
        capture = capture_binary.decode(data, str(path))
    else:
        capture = _parse(path, head, pieces)
    check_times(path, capture.t_us, capture.meta["rate_hz"])
    return capture if gyro_alone else with_accelerometer(path, capture)


def with_accelerometer(path, capture):
    """The same capture; BadFile where it is a gyro's alone."""
    if capture.accel is None:
        raise BadFile("%s: it holds a gyro alone, expected ax ay az as well: only sixflip show, "
                      "diagnose and exports of noise do without" % path)
    return capture


def check_times(path, t_us, rate_hz):
    """BadFile for times that stand still, or that are far from the sample rate.

    Both the usual and the mean interval have to be: gaps lengthen one, coarse stamps the other.
    """
    if len(t_us) < 2:
        return
    span = int(t_us[-1]) - int(t_us[0])
    if not span:
        raise BadFile("%s: all %d samples have the time %d us, expected times that run" % (
            path, len(t_us), t_us[0]))
    if len(t_us) < FEW_TIMES:
        return
    usual, mean = capture_binary.usual_us(t_us), span / (len(t_us) - 1)
    for off in (lambda us: us * rate_hz > FAR * 1e6, lambda us: us * rate_hz * FAR < 1e6):
        if off(usual) and off(mean):
            raise BadFile("%s: its samples are %.4g us apart, expected about %.4g: rate_hz is %g; "
                          "correct the one that is wrong, times are in microseconds"
                          % (path, usual, 1e6 / rate_hz, rate_hz))


def _begins(pieces, more, head=b""):
    """The head of a file: pieces joined as long as more(head) asks for them."""
    while more(head):
        piece = next(pieces, None)
        if piece is None:
            break
        head += piece
    return head


def read_samples(path):
    """read() for what needs every sample: BadFile where the board kept the poses' sums only."""
    return with_samples(path, read(path))


def with_samples(path, capture):
    """The same capture; BadFile where the board kept the poses' sums only."""
    if capture.sums_only:
        raise BadFile("%s: the board's flash was full, so it kept the sums of its poses and not "
                      "the samples this needs; sixflip solve works with the sums, and sixflip "
                      "verify checks what was solved from them" % path)
    return capture


def parse(path, data):
    """A capture from the bytes of its text; `path` is for the error."""
    return _parse(path, data, iter(()))


def _parse(path, head, pieces):
    """A capture from the beginning of its text, and the pieces behind that."""
    head = _begins(pieces, lambda head: head.count(b"\n") < 3 and len(head) <= 3 * LONGEST_LINE,
                   head)
    meta, columns, samples, offset = parse_header(path, head)
    values = parse_rows(path, itertools.chain([head[offset:]], pieces), columns, 4, samples)
    rows = len(values["t_us"])
    if not rows:
        raise BadFile.at(path, 4, "no rows", "%s rows" % samples if samples else "a row a sample")
    if samples is not None and rows != samples:
        raise BadFile.at(path, 3 + rows, "%s after %d rows" % (
            "the file was cut short" if rows < samples else "the file goes on", rows),
            "the %d rows its header promises" % samples)
    capture = Capture(meta, values["t_us"], values.get("ax"), values.get("gx"), values.get("temp"),
                      values.get("mx"), values.get("pose"))
    board_extras.take(capture, path)
    return capture


def write(path, capture):
    """Write a capture as text, gzipped when the name ends in .gz; whole or not at all.

    The same capture gives the same bytes, always.
    """
    pieces = _text(capture)
    atomic_write.write_pieces(path, _gzipped(pieces) if str(path).endswith(".gz") else pieces)


def _gzipped(pieces):
    packer = zlib.compressobj(9, wbits=31)      # no name and no time in it
    for piece in pieces:
        yield packer.compress(piece)
    yield packer.flush()


def text(capture):
    """The bytes of a text capture."""
    return b"".join(_text(capture))


def _text(capture):
    """The same piece by piece."""
    if not len(capture):
        raise BadFile("the board kept only the sums of this capture: no samples to write")
    columns = capture.columns()
    if "samples" in capture.meta:
        raise BadFile("a capture's header says how many rows there are, leave `samples` to it")
    check_meta(capture.meta, columns, lambda found, expected: BadFile(
        "the capture cannot be written: %s, expected %s" % (found, expected)))
    try:
        header = json.dumps(dict(capture.meta, samples=len(capture)), allow_nan=False)
    except (TypeError, ValueError) as error:
        raise BadFile("the capture's header cannot be written as JSON: %s" % quoted(str(error)))
    head = "# sixflip-capture %d\n# %s\n%s\n" % (VERSION, header, ",".join(columns))
    yield head.encode("utf-8")
    names = None if capture.pose is None else {
        code: pose_name(code) if code else "" for code in np.unique(capture.pose).tolist()}
    row = ",".join(["%d"] * (len(columns) - (names is not None))
                   + ["%s"] * (names is not None)) + "\n"
    for first in range(0, len(capture), ROWS_WRITTEN):
        some = slice(first, first + ROWS_WRITTEN)
        fields = [capture.t_us[some].tolist()]
        for block in (capture.accel, capture.gyro, capture.temp, capture.mag):
            if block is not None:
                fields += block[some].reshape(len(fields[0]), -1).T.tolist()
        if names is not None:
            fields.append([names[code] for code in capture.pose[some].tolist()])
        yield "".join([row % values for values in zip(*fields)]).encode()
