"""Tables in CSV with comment lines (`#`), a header and one row a line; complaints name the line.

A spreadsheet takes a cell that begins with = + - @ or a tab for a formula and may execute it,
whoever wrote it: a place of somebody's catalogue, the name of a record.  Tables are written with an
apostrophe before such words (`as_words`), as OWASP advises on CSV injection, and read without it
(`from_words`).

Spreadsheets of many countries write semicolons or tabulators between cells and commas in numbers,
and empty columns at the end: these are read.  A number that may be one of two is refused.
"""

import csv
import math
import re
from pathlib import Path

import numpy as np
import pandas as pd

from damage.checks import check_file
from damage.errors import InputError
from damage.files import text_lines

MOST_MB = 50
"""Largest size of a file [MB], which is read in seconds and in less than a gigabyte."""
MOST_ROWS = 500_000
"""Largest number of rows of a file."""

_FORMULA = re.compile(r"[=+\-@\t\r\n]")
_COMMA, _POINT = (rf"[-+]?\d*{mark}\d+(?:[eEdD][-+]?\d+)?" for mark in (",", r"\."))
_THOUSANDS = r"[-+]?[1-9]\d{0,2}(?:,\d{3})+"
_NO_NUMBER = re.compile(r"[<>~\u2264\u2265\u2248]|[\d.,]+ *[-\u2013\u2026] *\d")
"""How a cell begins that is a bound or a range."""
_ONE_NUMBER = (
    "; of a bound or a range give one number, the best estimate (how far widths of a survey may be"
    " off is width_error_mm)"
)


def as_words(table):
    """A DataFrame whose words no spreadsheet takes for a formula; numbers stay, as text, too."""
    return _in_words(
        table, lambda word: f"'{word}" if _FORMULA.match(word) and not is_number(word) else word
    )


def from_words(table):
    """The DataFrame that `as_words` was given."""
    return _in_words(
        table, lambda word: word[1:] if word[:1] == "'" and _FORMULA.match(word[1:]) else word
    )


def _in_words(table, change):
    texts = [name for name in table if not pd.api.types.is_numeric_dtype(table[name])]
    return table.assign(
        **{
            name: table[name].map(lambda cell: change(cell) if isinstance(cell, str) else cell)
            for name in texts
        }
    )


def as_float(cell):
    """The number of a cell, with an exponent of Fortran, too; ValueError where it is none.

    >>> [as_float(cell) for cell in ("1.5D-03", "-.25", "0.15-101")]
    [0.0015, -0.25, 1.5e-102]
    """
    try:
        return float(cell.replace("_", " "))  # which Python passes over between digits
    except ValueError:
        cell = re.sub(r"(?<=[\d.])[dD](?=[-+\d])", "e", cell)
    has_exponent = "." not in cell or "e" in cell.lower()
    return float(cell if has_exponent else re.sub(r"(?<=\d)([-+]\d{3})$", r"e\1", cell))


def is_number(cell):
    """Whether a cell is a number with a decimal point; so are nan and inf."""
    try:
        as_float(cell)
    except ValueError:
        return False
    return True


def uncommented(lines):
    """The lines of a text that are neither empty nor comments: a list of (number, line)."""
    return [
        (number, line)
        for number, line in enumerate(lines, 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]


class CsvTable:
    """The rows of a CSV file.

    path: of the file; names: of its columns; lines: of the rows, a list of (number, text);
    separator: between the cells, None for blanks; columns: {name: Column} of those that may be
    there, by default words under any name.

    rows: DataFrame, with all of `columns`: numbers as floats, NaN where a cell is empty or the
    column is missing, and words (dtype "U") as text; line: number of each row's line.
    Raises InputError with the line that does not fit.
    """

    def __init__(self, path, names, lines, separator, columns=None):
        self.path = path
        self.names = names
        self.line = []
        text = pd.DataFrame(self._cells(lines, separator), columns=names, dtype=object)
        self._take_decimal_commas(text, separator)
        self.rows = (
            text
            if columns is None
            else pd.DataFrame(
                {name: self._column(name, column, text) for name, column in columns.items()}
            )
        )

    def _cells(self, lines, separator):
        """The cells of each row, as many as there are names."""
        numbers = [number for number, _ in lines]
        width = len(self.names)
        texts = (line for _, line in lines)
        reader = csv.reader(texts, delimiter=separator or " ", skipinitialspace=True)
        rows = []
        try:
            for row in reader:
                rows.append(_filled([cell.strip() for cell in row], width))
                self.line.append(numbers[reader.line_num - 1])  # quotes may reach over several
        except csv.Error as error:
            raise InputError(
                f"{self.path} cannot be read as CSV ({error}); expected commas between short cells"
            ) from error
        for row, cells in enumerate(rows):
            if len(cells) != width:
                more = "; decimal commas need semicolons between cells" * (len(cells) > width)
                raise self.error(
                    row, f"{len(cells)} cells; expected {width}, {', '.join(self.names)}{more}"
                )
        return rows

    def _take_decimal_commas(self, text, separator):
        """Write numbers with a decimal point.  Refuses what may be a comma of thousands."""
        commas = text.apply(lambda column: column.str.fullmatch(_COMMA))
        if not commas.any(axis=None):
            return
        points = text.apply(lambda column: column.str.fullmatch(_POINT))
        self.refuse(
            points.any(axis=1),
            "a number with a decimal point in a file with decimal commas; expected one "
            "of them, and nothing between thousands",
        )
        for name in text.columns[commas.any()]:
            thousands = text[name].str.fullmatch(_THOUSANDS)
            if separator == "," and thousands.equals(commas[name]):
                self.refuse(
                    thousands,
                    f"{name} has a number in quotes whose comma may be of decimals or of thousands;"
                    " expected a decimal point",
                )
            text[name] = text[name].mask(commas[name], text[name].str.replace(",", "."))

    def _column(self, name, column, text):
        """The values of a column as its Column says."""
        cells = text[name] if name in text else pd.Series([""] * len(text), dtype=object)
        if column.dtype == "U":
            return cells
        values = np.array([as_float(cell) if is_number(cell) else math.nan for cell in cells])
        for row in np.flatnonzero((cells != "") & ~np.isfinite(values))[:1]:
            hint = _ONE_NUMBER if _NO_NUMBER.match(cells[row]) else ""
            raise self.error(
                row,
                f"{name} = {cells[row]!r}: expected a finite number, or nothing where it is unknown"
                f"{hint}",
            )
        for row in np.flatnonzero((values < column.least) | (values > column.most))[:1]:
            raise self.error(
                row,
                f"{name} = {cells[row]}: expected {column.least:g} to {column.most:g}; look at the"
                " unit",
            )
        return values

    def error(self, row, problem):
        """InputError about a row (index)."""
        return InputError(f"{self.path} line {self.line[row]}: {problem}")

    def refuse(self, wrong, problem):
        """Raise `error` of the first row where `wrong`, (n_rows,) bool, if there is one."""
        if np.any(wrong):
            raise self.error(int(np.argmax(wrong)), problem)

    def refuse_empty(self, *names):
        """Raise `error` of the first row that lacks a number or a word of these columns."""
        for name in names:
            column = self.rows[name]
            self.refuse(
                column.isna() | (column == ""), f"no {name}; expected it in every row, give it"
            )


def read_csv(path, columns=None, required=(), most_rows=MOST_ROWS):
    """The CsvTable of a file with a header.

    columns: {name: Column} of those that may be there, by default words under any name; required:
    names of those that must be.  Raises InputError where the file is missing or empty, or its
    header or rows do not fit.
    """
    path = Path(path)
    lines = uncommented(_lines(path))
    if not lines:
        raise InputError(
            f"{path} is empty: expected a header with the columns {', '.join(required)}"
        )
    (number, header), *lines = lines
    if len(lines) > most_rows:
        raise InputError(
            f"{path} has {len(lines)} rows: expected up to {most_rows}; take fewer points"
        )
    if not lines:
        raise InputError(f"{path} has a header and no row: expected at least one; add some")
    separator = max(",;\t", key=header.count)
    names = _filled([cell.strip() for cell in next(csv.reader([header], delimiter=separator))], 0)
    _check_header(f"{path} line {number}", names, columns or names, required)
    return CsvTable(path, names, lines, separator, columns)


def _check_header(where, names, known, required):
    missing = [name for name in required if name not in names]
    unknown = [repr(name) for name in names if name not in known]
    if missing or unknown or len(set(names)) < len(names):
        optional = [name for name in known if name not in required]
        wrong = (
            f"no column {', '.join(missing)}"
            if missing
            else f"unknown column {', '.join(unknown)}"
            if unknown
            else "a column twice"
        )
        names = [", ".join(required)] * bool(required)
        names += ["any of " + ", ".join(optional)] * bool(optional)
        raise InputError(f"{where}: {wrong}; expected {' and '.join(names)}")


def _filled(cells, least):
    """Cells without empty ones at the end, beyond so many."""
    while len(cells) > least and not cells[-1]:
        cells = cells[:-1]
    return cells


def _lines(path):
    check_file(path, "a CSV file", MOST_MB)
    try:
        data = path.read_bytes()
        lines = text_lines(path, data, 2 * MOST_ROWS)
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path} cannot be read as text ({error}); expected CSV in UTF-8"
        ) from error
    if any("\0" in line for line in lines):
        raise InputError(
            f"{path} holds a zero byte; expected text, CSV in UTF-8; write the file again"
        )
    return lines
