"""Tables that are in memory already: arrays out of NumPy's .npz and MATLAB's .mat files."""

import math
import zipfile

import numpy as np

from ... import sample_limit
from ...errors import BadFile, UsageError
from ..capture_rows import quoted
from ..unpack import Source
from . import mat_file
from .csv_table import Block

ROWS = 1 << 16
MATLAB_5, MATLAB_HDF5 = b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file"
ZIP, OLD_SPREADSHEET = b"PK\x03\x04", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
SHEETS = ("xl/workbook.xml", "xl/workbook.bin", "content.xml")      # of .xlsx, .xlsb, .ods
TABLES = {"timetable": "writetimetable", "table": "writetable"}     # and what writes them
EXPECTED = "such as accel (n, 3), gyro (n, 3) and t (n,)"
RATES = ("fs", "samplerate", "sample_rate", "rate", "rate_hz")


class ArrayTable:
    """Columns (n,) of one length, to be read like a csv_table.Table.

    units   {sensor: unit} that the format says; rate_hz: that the file says, or None
    """

    def __init__(self, path, columns, units=None, rate_hz=None):
        self.path, self._columns = path, columns
        self.names = list(columns)
        self.width = len(columns)
        self.preamble, self.passed_over = (), {}
        self.units, self.rate_hz = units or {}, rate_hz
        sample_limit.check_samples(path, max(map(len, columns.values()), default=0))

    def index(self, column):
        """Position of a column given by name."""
        if column in self.names:
            return self.names.index(column)
        raise BadFile("%s: there is no column %s, expected one of %s" % (
            self.path, quoted(column), " ".join(self.names)))

    def holds_numbers(self, column):
        """Every column does."""
        return True

    def blocks(self, columns, label=None):
        """csv_table.Block after Block of columns; BadFile for values that are no numbers."""
        if label is not None:
            raise UsageError("%s: arrays have no column of labels, expected --sections"
                             % self.path)
        wanted = [self._columns[self.names[self.index(column)]] for column in columns]
        rows = len(wanted[0])
        for column, values in zip(columns, wanted):
            if len(values) != rows:
                raise BadFile("%s: %s has %d rows and %s %d, expected as many" % (
                    self.path, columns[0], rows, column, len(values)))
        if not rows:
            raise BadFile("%s: no rows in it, expected at least one" % self.path)
        for first in range(0, rows, ROWS):
            values = np.stack([one[first:first + ROWS] for one in wanted], axis=1).astype(float)
            bad = ~np.isfinite(values)
            if bad.any():
                row, column = np.argwhere(bad)[0]
                raise BadFile("%s: row %d of %s is %s, expected a finite number" % (
                    self.path, first + row + 1, columns[column], values[row, column]))
            yield Block([0] * len(values), values, None)


def is_spreadsheet(path, head):
    """Whether a file that begins with head is a workbook of Excel or LibreOffice."""
    if not head.startswith(ZIP):
        return head.startswith(OLD_SPREADSHEET)
    try:
        with zipfile.ZipFile(path) as file:
            return not {*file.namelist()}.isdisjoint(SHEETS)
    except (OSError, ValueError, zipfile.BadZipFile):
        return False


def read_npz(path):
    """ArrayTable of an .npz with arrays (n,) and (n, 3)."""
    try:
        # a file that NumPy cannot make sense of it leaves open; one that is handed in is closed
        with sample_limit.little_memory(), open(path, "rb") as data, \
                np.load(data, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except MemoryError:
        raise _too_large(path) from None
    except Exception as error:      # a library that is fed with whatever the file holds
        raise BadFile("%s: cannot be read as .npz: %s" % (path, _first_line(error))) from None
    return _table(path, arrays)


def read_mat(path):
    """ArrayTable of a .mat of MATLAB's format 5 (save -v6 or -v7)."""
    try:
        data = b"".join(Source(path).pieces())
        arrays, objects = mat_file.arrays(data, sample_limit.memory())
    except (ValueError, MemoryError) as error:
        raise BadFile("%s: cannot be read as a MAT-file: %s" % (path, _first_line(error))) \
            from None
    if objects and not any(value.size > 1 for value in arrays.values()):
        writer = next((TABLES[one] for one in objects if one in TABLES), None)
        raise BadFile("%s: holds nothing but objects of MATLAB's own (%s), expected %s" % (
            path, " ".join(sorted(set(objects))), "a CSV of one, as %s(NAME, 'FILE.csv') writes "
            "it" % writer if writer else EXPECTED))
    return _table(path, arrays)


def _too_large(path):
    return BadFile("%s: its arrays need more than %d MB, expected less, or --limit with the "
                   "number of samples there may be" % (path, sample_limit.memory() >> 20))


def _first_line(error):
    return (str(error) or type(error).__name__).splitlines()[0][:200]


def _table(path, arrays):
    """ArrayTable of the arrays that are columns; three columns for one of (n, 3)."""
    columns, rate = {}, None
    for name, value in arrays.items():
        if not isinstance(value, np.ndarray) or value.dtype.kind not in "iuf":
            continue
        if value.size == 1 and name.lower().rpartition(".")[2] in RATES:
            rate = float(value.ravel()[0])
            continue
        value = np.squeeze(value)
        if value.ndim == 2 and value.shape[0] == 3 != value.shape[1]:
            value = value.T
        if value.ndim == 1 and value.size > 1:
            columns[name] = value
        elif value.ndim == 2 and value.shape[1] == 3:
            columns.update({"%s[%d]" % (name, axis): value[:, axis] for axis in range(3)})
    if not columns:
        raise BadFile("%s: no array of (n,) or (n, 3) numbers in it, expected %s" % (
            path, EXPECTED))
    if rate is not None and not (math.isfinite(rate) and 0 < rate < 1e6):
        rate = None
    return ArrayTable(path, columns, rate_hz=rate)
