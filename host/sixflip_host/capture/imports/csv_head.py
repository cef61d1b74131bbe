"""The first lines of somebody's CSV: its delimiter, and the line with the column names."""

import csv

from ...errors import BadFile
from . import text_lines

DELIMITERS = (",", ";", "\t", None)     # None: any run of blanks
SEARCH = 200            # lines in which the column names must appear
COMMENT = ("#", "//")


def first_lines(path, source, wanted):
    """The first lines of a file, some more than are wanted where there are as many."""
    lines = [""]
    for _, text in text_lines.texts(path, source, head=wanted):
        more = text.replace("\0", "").split("\n")
        lines = [*lines[:-1], lines[-1] + more[0], *more[1:]]
        if len(lines) > wanted:
            break
    if not any(line.strip() for line in lines):
        raise BadFile.at(path, 1, "the file is empty", "a CSV file")
    return lines


def find(path, lines, delimiter, skip, is_header):
    """(index of the line of column names or None, lines before the rows, delimiter)."""
    choices = DELIMITERS if delimiter == "auto" else \
        (None if delimiter == "blank" else delimiter,)
    start = skip or 0
    if start >= len(lines):
        raise BadFile.at(path, len(lines), "only %d lines" % len(lines),
                         "more than the %d to skip" % start)
    search = range(start, min(len(lines), start + SEARCH)) if skip is None else (start,)
    for number in search:
        for separator in choices:
            if is_header and is_header(cells_of(lines[number].lstrip("#"), separator)):
                return number, number + 1, separator
    while skip is None and start + 1 < len(lines) and (
            not lines[start].strip() or lines[start].startswith(COMMENT)):
        start += 1
    separator = max(choices, key=lambda one: (len(cells_of(lines[start], one)), one is not None))
    points = lines[start] if separator == "," else lines[start].replace(",", ".")
    cells = cells_of(points, separator)
    if any(all_numbers([cell]) for cell in cells):     # no line of names has numbers in it
        return None, start, separator
    return start, start + 1, separator


def cells_of(line, separator):
    """The cells of a line without the blanks and the quotes around them."""
    if separator is None:
        return [cell.strip('"') for cell in line.split()]
    if '"' in line:
        try:
            cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
            return [cell.strip() for cell in cells]
        except csv.Error:       # what it calls a line has an end inside
            pass
    return [cell.strip() for cell in line.strip().split(separator)] if separator != "\t" \
        else [cell.strip() for cell in line.rstrip("\r").split(separator)]


def all_numbers(cells):
    try:
        return bool([float(cell) for cell in cells])
    except ValueError:
        return False
