"""Tables in documents, made of the CSV files in docs/tables.

A table in a Markdown file is a block between two comments; the first one says what it shows:

    <!-- table FILE.csv: COLUMN | COLUMN as HEADING | COLUMN{:.3f}
         where COLUMN = VALUE | VALUE; COLUMN = VALUE -->
    <!-- end of table -->

FILE is below docs/tables.  Without columns all are shown, without `where` all rows.  A format after
a column's name applies to numbers; empty cells stay empty.  The comment may have several lines.

    python3 scripts/document_tables.py NAME.csv [NUMBER] < OUTPUT  # keeps a table that a benchmark
                                                                   # printed

writes the first, or another, Markdown table of the standard input to docs/tables/NAME.csv.  An
empty cell of its first column repeats the cell above; a heading that comes again gets the one
before it in brackets, an empty one is "case". docs/tables/benchmarks/README.md lists the commands.
"""

import re
import sys
from pathlib import Path

import pandas as pd

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

from damage.errors import InputError
from damage.files import write_text

_WORDS = r"((?:(?!-->).)+?)"
BLOCK = re.compile(
    rf"(<!-- table (\S+\.csv)(?:: {_WORDS})?(?:\swhere\s{_WORDS})? -->\n)(.*?)(<!-- end of table"
    r" -->)",
    re.DOTALL,
)
_COLUMN = re.compile(r"^(.+?)(\{:[^}]*\})?(?: as (.+))?$")
_ROW = re.compile(r"^\|(.*)\|$")


def with_tables(text, folder):
    """A document's text with its tables made of the CSV files in a folder."""

    def made(block):
        columns, where = (" ".join((words or "").split()) for words in (block[3], block[4]))
        return f"{block[1]}\n{_table(folder / block[2], columns, where)}\n\n{block[6]}"

    return BLOCK.sub(made, text)


def _table(path, columns, where):
    try:
        rows = pd.read_csv(path, dtype=str, keep_default_na=False)
    except OSError as error:
        raise InputError(
            f"{path}: {error.strerror}; expected a table that a document shows"
        ) from error
    for condition in where.split("; ") if where else ():
        name, _, values = condition.partition(" = ")
        rows = rows[_column(rows, name, path).isin(values.split(" | "))]
    shown = (
        [_COLUMN.match(column).groups() for column in columns.split(" | ")]
        if columns
        else [(name, None, None) for name in rows]
    )
    cells = [
        [_formatted(cell, form) for cell in _column(rows, name, path)] for name, form, _ in shown
    ]
    return as_markdown([heading or name for name, _, heading in shown], zip(*cells, strict=True))


def _column(rows, name, path):
    if name not in rows:
        raise InputError(f"{path} has no column {name!r}: expected one of {', '.join(rows)}")
    return rows[name]


def _formatted(cell, form):
    return form.format(float(cell)) if form and cell else cell


def as_markdown(heads, rows):
    """
    >>> print(as_markdown(["a", "b"], [["1", "2"]]))
    | a | b |
    | --- | --- |
    | 1 | 2 |
    """
    return "\n".join(
        "| " + " | ".join(cells) + " |" for cells in (heads, ["---"] * len(heads), *rows)
    )


def tables_in(text):
    r"""The Markdown tables in a text, each a list of rows, the heads first.

    >>> tables_in("words\n| a | b |\n| --- | --- |\n| 1 | 2 |\n| | 3 |\n| 4 | |")
    [[['a', 'b'], ['1', '2'], ['1', '3'], ['4', '']]]
    """
    tables = []
    previous = False
    for line in text.splitlines():
        match = _ROW.match(line.strip())
        if match:
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", match[1])]
            if not previous:
                tables.append([])
            elif not cells[0] and len(tables[-1]) > 1:
                cells[0] = tables[-1][-1][0]
            if not all(re.fullmatch(r":?-+:?", cell) for cell in cells):
                tables[-1].append(cells)
        previous = bool(match)
    return tables


def unique(heads, column):
    """
    >>> [unique(["", "peak", "test", "mode", "test"], column) for column in range(5)]
    ['case', 'peak', 'test', 'mode', 'test (mode)']
    """
    head = heads[column] or "case"
    return f"{head} ({heads[column - 1]})" if head in heads[:column] else head


def main(arguments):
    """Keep a table of the standard input; returns 2 where there is none."""
    name, number = (*arguments, "1")[:2]
    tables = tables_in(sys.stdin.read())
    if not 1 <= int(number) <= len(tables):
        print(
            f"error: {len(tables)} tables in the input; expected table {number} among them",
            file=sys.stderr,
        )
        return 2
    heads, *rows = tables[int(number) - 1]
    heads = [unique(heads, column) for column in range(len(heads))]
    path = REPOSITORY / "docs" / "tables" / name
    path.parent.mkdir(exist_ok=True)
    print(write_text(path, pd.DataFrame(rows, columns=heads).to_csv(index=False)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
