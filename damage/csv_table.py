"""Tables in CSV with comment lines (`#`), a header and one row a line; complaints name the line.

A spreadsheet takes a cell that begins with = + - @ or a tab for a formula and may execute it, whoever wrote it: a place
of somebody's catalogue, the name of a record.  Tables are written with an apostrophe before such words (`as_words`), as
OWASP advises on CSV injection, and read without it (`from_words`).

Spreadsheets of many countries write semicolons or tabulators between cells and commas in numbers, and empty columns at
the end: these are read.  A number that may be one of two is refused.
"""

import csv
import re
from pathlib import Path

import numpy as np
import pandas as pd

from damage.checks import check_file
from damage.errors import InputError
from damage.files import text_lines

MOST_MB, MOST_ROWS, MOST_LEVELS = 50, 500_000, 1000
"""Size of a file, its rows, its load levels: what is read in seconds and in less than a gigabyte."""

_FORMULA = re.compile(r"[=+\-@\t\r\n]")
_COMMA, _POINT = (re.compile(rf"[-+]?\d*{mark}\d+(?:[eE][-+]?\d+)?") for mark in (",", r"\."))
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+")
_NO_NUMBER = re.compile(r"[<>~\u2264\u2265\u2248]|[\d.,]+ *[-\u2013\u2026] *\d")
"""How a cell begins that is a bound or a range."""
_ONE_NUMBER = ("; of a bound or a range give one number, the best estimate (how far widths of a survey may be off is "
               "width_error_mm)")


def as_words(table):
    """A DataFrame whose words no spreadsheet takes for a formula; numbers stay, as text, too."""
    return _in_words(table, lambda word: f"'{word}" if _FORMULA.match(word) and not _is_number(word) else word)


def from_words(table):
    """The DataFrame that `as_words` was given."""
    return _in_words(table, lambda word: word[1:] if word[:1] == "'" and _FORMULA.match(word[1:]) else word)


def _in_words(table, change):
    words = [name for name in table if not pd.api.types.is_numeric_dtype(table[name])]
    return table.assign(**{name: table[name].map(lambda cell: change(cell) if isinstance(cell, str) else cell)
                           for name in words})


def _is_number(word):
    try:
        float(word)
    except ValueError:
        return False
    return True


class CsvTable:
    """A CSV file as read: columns of text, to be taken out by `numbers` and `words`.

    path: of the file; required, optional: names of columns; any other column is refused; most_rows: of it.
    Raises InputError when the file is missing or empty, or its header or rows do not fit.
    """

    def __init__(self, path, required, optional=(), most_rows=MOST_ROWS):
        self.path = Path(path)
        lines = _lines(self.path)
        kept = [k for k, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")]
        if len(kept) > most_rows + 1:
            raise InputError(f"{path} has {len(kept) - 1} rows: expected up to {most_rows}; take fewer points")
        if not kept:
            raise InputError(f"{path} is empty: expected a header with the columns {', '.join(required)}")
        try:
            header = lines[kept[0]]
            mark = max(",;\t", key=header.count)
            self._read(csv.reader((lines[k] for k in kept), delimiter=mark), np.array(kept) + 1, required, optional)
        except csv.Error as error:
            raise InputError(f"{path} cannot be read as CSV ({error}); expected commas between short cells") from error
        if len(self.text) == 0:
            raise InputError(f"{path} has a header and no row: expected at least one; add some")
        self._take_decimal_commas(mark)

    def _read(self, reader, numbers, required, optional):
        """Take the header and the rows; numbers: of the lines that the csv.reader is given."""
        names = _filled([cell.strip() for cell in next(reader)], 0)
        self._check_header(names, numbers[0], required, optional)
        rows, ends = [], []
        for row in reader:
            ends.append(numbers[reader.line_num - 1])  # a cell in quotes may reach over several
            rows.append(_filled([cell.strip() for cell in row], len(names)))
            if (n := len(rows[-1])) != len(names):
                more = "; decimal commas need semicolons between cells" if n > len(names) else ""
                raise InputError(f"{self.path} line {ends[-1]}: {n} cells, the header has {len(names)}: expected as "
                                 f"many{more}")
        self.text = pd.DataFrame(rows, columns=names, dtype=object)
        self.line = np.array(ends, int)

    def _check_header(self, names, line, required, optional):
        missing = [name for name in required if name not in names]
        unknown = [name for name in names if name not in (*required, *optional)]
        if missing or unknown or len(set(names)) < len(names):
            wrong = (f"no column {', '.join(missing)}" if missing else
                     f"unknown column {', '.join(map(repr, unknown))}" if unknown else "a column twice")
            raise InputError(f"{self.path} line {line}: {wrong}; expected {', '.join(required)}"
                             + (f" and any of {', '.join(optional)}" if optional else ""))

    def _take_decimal_commas(self, mark):
        """Write numbers with a decimal point; mark: between the cells.  Refuses what may be a comma of thousands."""
        with_commas = [name for name in self.text if any(map(_COMMA.fullmatch, self.text[name]))]
        if not with_commas:
            return
        points = [[bool(_POINT.fullmatch(cell)) for cell in self.text[name]] for name in self.text]
        self.refuse(np.any(points, axis=0), "a number with a decimal point in a file with decimal commas; expected one "
                                            "of them, and nothing between thousands")
        for name in with_commas:
            thousands = [mark == "," and bool(_THOUSANDS.fullmatch(cell)) for cell in self.text[name]]
            self.refuse(thousands, f"{name} has a number in quotes whose comma may be of decimals or of thousands; "
                        "expected a decimal point")
            self.text[name] = [cell.replace(",", ".") if _COMMA.fullmatch(cell) else cell for cell in self.text[name]]

    def __len__(self):
        return len(self.text)

    def words(self, name, default=""):
        """A column as text, (n_rows,) object array; `default` where there is no such column."""
        return self.text[name].to_numpy() if name in self.text else np.full(len(self), default, object)

    def numbers(self, name):
        """A column as floats, (n_rows,), NaN where it is empty or missing."""
        words = pd.Series(self.words(name))
        valid = np.isfinite(pd.to_numeric(words, errors="coerce").to_numpy(float))
        # to_numeric decides what is a number; its values are off by the last bit.
        values = np.array([float(word) if is_number else np.nan for word, is_number in zip(words, valid)])
        bad = (words != "").to_numpy() & ~np.isfinite(values)
        if bad.any():
            row = int(np.argmax(bad))
            one = _ONE_NUMBER if _NO_NUMBER.match(words[row]) else ""
            raise self.error(row, f"{name} = {words[row]!r}: expected a finite number, or nothing where it is unknown"
                                  f"{one}")
        return values

    def refuse_beyond(self, **bounds):
        """Raise `error` of the first row with a number larger, but for its sign, than the bound of its column."""
        for name, bound in bounds.items():
            beyond = np.abs(np.nan_to_num(self.numbers(name))) > bound
            self.refuse(beyond, f"{name} is beyond {bound:g}; expected less, look at the unit")

    def levels(self, level):
        """The distinct load levels of a column (n_rows,), in the order of the file."""
        found = list(dict.fromkeys(level))
        if len(found) > MOST_LEVELS:
            raise InputError(f"{self.path} has {len(found)} load levels: expected up to {MOST_LEVELS}; take some out")
        return found

    def error(self, row, problem):
        """InputError about a row (index)."""
        return InputError(f"{self.path} line {self.line[row]}: {problem}")

    def refuse(self, wrong, problem):
        """Raise `error` of the first row where `wrong`, (n_rows,) bool, if there is one."""
        if np.any(wrong):
            raise self.error(int(np.argmax(wrong)), problem)


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
        raise InputError(f"{path} cannot be read as text ({error}); expected CSV in UTF-8") from error
    if any("\0" in line for line in lines):
        raise InputError(f"{path} holds a zero byte; expected text, CSV in UTF-8; write the file again")
    return lines
