"""Tables in documents show the CSV files in docs/tables that the comments before them name."""

import shutil

import pytest
from conftest import REPOSITORY, refused_with

from damage.errors import InputError
from scripts.document_tables import main, with_tables
from scripts.documents import tables_of_code, tables_show_the_files, with_tables_of_code

PAGE = "docs/validation/laboratory.md"
ROW = "| COMP1_3 | rule, tested c and φ | {} |"


@pytest.fixture
def copy(tmp_path):
    """A folder with the repository's documents."""
    shutil.copytree(REPOSITORY / "docs", tmp_path / "docs", ignore=shutil.ignore_patterns("*.png"))
    shutil.copy(REPOSITORY / "README.md", tmp_path)
    return tmp_path


def test_a_changed_number_is_found(copy):
    assert list(tables_show_the_files(copy)) == []
    text = (copy / PAGE).read_text()
    (copy / PAGE).write_text(text.replace(ROW.format("84.8"), ROW.format("74.8")))
    found = "\n".join(tables_show_the_files(copy))
    assert f"{PAGE}: it says '{ROW.format('74.8')}" in found
    assert f"{PAGE}: docs/tables say '{ROW.format('84.8')}" in found
    assert with_tables((copy / PAGE).read_text(), copy / "docs/tables") == text


def test_a_changed_table_of_the_code_is_found(copy):
    page, row = "docs/reference/measures.md", "| `peak_base_shear_n` | N |"
    text = (copy / page).read_text()
    (copy / page).write_text(text.replace(row, "| `peak_base_shear_n` | kN |"))
    assert f"{page}: docs/tables say '{row}" in "\n".join(tables_show_the_files(copy))
    assert with_tables_of_code((copy / page).read_text()) == text


def test_every_table_of_the_code_is_in_a_document():
    pages = "\n".join(path.read_text() for path in (REPOSITORY / "docs").rglob("*.md"))
    assert [name for name in tables_of_code() if f"<!-- table of {name} -->" not in pages] == []


def test_a_table_that_the_code_does_not_have_is_one_line():
    with pytest.raises(InputError, match="a table of 'nothing': expected one of summary.csv: parameters, "):
        with_tables_of_code("<!-- table of nothing -->\n<!-- end of table -->")


def test_columns_rows_formats_and_equal_headings(tmp_path):
    (tmp_path / "a.csv").write_text("name,x,y\na,0.12345,1\nb,,2\nc,3,4\n")
    text = "<!-- table a.csv: name | x{:.2f} as value | y as value\nwhere name = a | b -->\nold\n<!-- end of table -->"
    made = with_tables(text, tmp_path).splitlines()
    assert made[3:7] == ["| name | value | value |", "| --- | --- | --- |", "| a | 0.12 | 1 |", "| b |  | 2 |"]


@pytest.mark.parametrize(("block", "words"), [
    ("<!-- table a.csv: z -->\n<!-- end of table -->", "has no column 'z': expected one of name"),
    ("<!-- table b.csv -->\n<!-- end of table -->", "expected a table that a document shows")])
def test_what_is_not_there_is_one_line(tmp_path, block, words):
    (tmp_path / "a.csv").write_text("name\na\n")
    refused_with(words, with_tables, block, tmp_path)


def test_an_input_without_a_table_is_refused(monkeypatch, error_of):
    monkeypatch.setattr("sys.stdin.read", lambda: "words", raising=False)
    assert error_of("benchmarks/none.csv", of=main) == "error: 0 tables in the input; expected table 1 among them\n"
