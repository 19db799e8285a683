"""Files of every kind that were damaged at random: each is read or refused in one line, in time and in little memory.

`python3 -m tests.fuzz --seconds 1200` tries far more; every fault that it found is held here.
"""

import random
from functools import partial

import pytest
from conftest import REPOSITORY, one_line_error, written

from damage.csv_table import CsvTable
from damage.files import DATA, LONGEST_LINE
from damage.laboratory import dic
from damage.measure import columns
from damage.motion import columns as record_columns
from damage.motion import formats
from damage.motion.formats import read_record, shipped_record_path
from damage.studies import definition
from damage.studies.definition import load_study
from tests.fuzz import harness
from tests.fuzz.harness import Worker
from tests.fuzz.readers import READERS

FILES = 45
STATION = DATA / "zeerijp_20180108" / "NL.BGAR.xml"
TRACE = shipped_record_path("NL.BGAR..HGE")


# --- many files -----------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def worker():
    with Worker(seed=14) as one:
        yield one


@pytest.mark.parametrize("name", READERS)
def test_damaged_files_are_read_or_refused_in_one_line(name, worker):
    if READERS[name].lacking:
        pytest.skip(f"{READERS[name].lacking} is an optional extra")
    outcomes = [worker(name, number) for number in range(FILES)]
    assert [one for one in outcomes if not one.good] == []
    assert {one.word for one in outcomes} == {"read", "refused"}


# --- the watch ------------------------------------------------------------------------------------

FAILING = {  # what a reader does, what is to be found of it
    "time.sleep(60)": ("hang", "no end in 6 s"), "os.kill(os.getpid(), 11)": ("crash", "status -11"),
    "1 / 0": ("exception", "ZeroDivisionError in <string>:1"), "print('words')": ("printed", "words"),
    "len(b'x' * 1_100_000_000)": ("memory", ""), "bytearray(10**12)": ("exception", "MemoryError"),
    "raise InputError('words')": ("refused", "words"), "raise InputError": ("unfit words", ""), "pass": ("read", ""),
}


def test_a_reader_that_fails_is_found_and_the_next_file_is_read(tmp_path, monkeypatch):
    """The worker itself, with readers that do nothing else."""
    written(tmp_path / "failing.py", "import os, sys, time\nfrom damage.errors import InputError\n"
            "from tests.fuzz import worker\nfrom tests.fuzz.readers import READERS, Reader\n"
            f"for code in {list(FAILING)}:\n"
            "    made = Reader(lambda folder, random: (b'', 'nothing'), lambda path, code=code: exec(code), '.csv')\n"
            "    READERS[code] = made\n"
            "worker.main(sys.argv[1])\n")
    monkeypatch.setattr(harness, "PROGRAM", (str(tmp_path / "failing.py"),))
    monkeypatch.setattr(harness, "SECONDS", 6)
    with Worker(seed=1, keep=tmp_path / "kept") as one:
        for code, (word, message) in FAILING.items():
            came = one(code, 0)
            assert came.word == word and message in came.message, came
    assert len(list((tmp_path / "kept").iterdir())) == len(FAILING) - 2


def test_one_number_is_one_file(tmp_path):
    made = [READERS["cracks"].damage(tmp_path, random.Random("cracks 14 3")) for _ in range(2)]
    assert made[0] == made[1]


# --- what was found -------------------------------------------------------------------------------

@pytest.mark.parametrize("text", ["\n" * 5 + "0,1\n" * 40, "0,1\n" * 40])
def test_a_record_of_too_many_lines_is_refused_before_they_are_parsed(text, tmp_path, monkeypatch):
    """28 MB of lines took more than ten seconds."""
    monkeypatch.setattr(formats, "MOST_LINES", 30)
    assert "more than 30 lines" in one_line_error(read_record, written(tmp_path / "a.csv", text))
    monkeypatch.setattr(formats, "MOST_LINES", 100)
    monkeypatch.setattr(record_columns, "MOST_SAMPLES", 30)
    assert "40 samples; expected up to 30" in one_line_error(read_record, written(tmp_path / "a.csv", text))


@pytest.mark.parametrize(("read_it", "name", "text", "said"), [
    # Refused by its count, before the words are met.
    (read_record, "a.at2", "PEER\na\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 1000001, DT= .005 SEC\n.1 words\n",
     "1000001 samples; expected up to"),
    # The first columns were taken for an index; what follows names mixed types is warned of no more.
    (columns.read_table, "t.csv", "point,wall\na,b,c\n", "more cells than the header"),
    # A cell over two lines does not shift the line that is reported.
    (dic.read_field, "f.csv", 'x_m,z_m,ux_m,uz_m\n"0\n",0,0,0\n1,1,1,1\n1,1,1,up\n', "line 5: uz_m = 'up'"),
    (partial(CsvTable, required=["record"]), "e.csv", "record;scale\nBGAR_HGE;1,5\n", "unknown column 'scale'"),
    (partial(CsvTable, required=("a", "b")), "t.csv", 'a,b\n"0\n",1\n1,2,3\n', "line 4: 3 cells, the header has 2"),
    # pandas takes such a cell for a number, Python does not.
    (dic.read_field, "f.csv", "x_m,z_m,ux_m,uz_m\n0.\0,0,0,0\n", "holds a zero byte")])
def test_what_was_misread_or_reported_wrongly_is_refused(read_it, name, text, said, tmp_path):
    assert said in one_line_error(read_it, written(tmp_path / name, text))


@pytest.mark.parametrize(("name", "read_it"), [
    ("a.csv", read_record), ("a.at2", read_record), ("f.csv", dic.read_field), ("t.csv", columns.read_table)])
def test_a_line_of_millions_of_cells_is_refused(name, read_it, tmp_path):
    """A table whose row had 20 MB took a minute and 3.5 GB, a header of 20 MB no end."""
    for before in ("", "time_s,acc_m_s2\n"):
        path = written(tmp_path / name, before + "1," * LONGEST_LINE)
        assert "100000" in one_line_error(read_it, path)


def test_a_table_of_short_rows_that_would_fill_up_to_too_many_cells_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(columns, "MOST_CELLS", 1000)
    path = written(tmp_path / "t.csv", ",".join(f"c{k}" for k in range(100)) + "\n" + "1\n" * 8)
    assert columns.read_table(path).shape == (8, 100)
    written(path, path.read_text() + "1\n" * 2)
    assert "over 1000 cells" in one_line_error(columns.read_table, path)


def test_paths_in_a_study_longer_than_any_file_has(tmp_path):
    path = tmp_path / "s.toml"
    for record in ("x" * 300, "x/" * 3000):
        written(path, f'name = "s"\n[[runs]]\nwall = "walls/solid.py"\n'
                f'options = {{ record = ["{record}", "{record}.csv"] }}\n')
        assert "none of the files" in one_line_error(load_study, path, "reference", REPOSITORY)
    written(path, f'name = "s"\n[[runs]]\nwall = "{"x/" * 3000}"\n')
    assert "no file" in one_line_error(load_study, path, "reference", REPOSITORY)


@pytest.mark.parametrize("text", ["[[grid]]\nvary = {}\n", "name = {}\n", "[[runs]]\noptions = {}\n"])
def test_a_study_whose_tables_are_too_deep_in_each_other(text, tmp_path):
    """Python's own recursion ended it while it was reported."""
    for opening, closing in ("[]", ("{a=", "}")):
        path = written(tmp_path / "s.toml", text.format(opening * 200 + "1" + closing * 200))
        assert "more than 20 deep" in one_line_error(load_study, path, "reference", REPOSITORY)


def test_a_key_of_very_many_parts_is_refused_before_it_is_read(tmp_path):
    """tomllib takes the square of their number: 20 000 of them took four seconds, in a file of 60 kB."""
    for text in ("{}a = 1\n", "name = {{ {}a = 1 }}\n", "[{}a]\n"):
        for key in ("a.", "a . ", '"=" .', "'\"'.", '"\\"#".'):
            path = written(tmp_path / "s.toml", text.format(key * 20))
            said = one_line_error(load_study, path, "reference", REPOSITORY)
            assert f"{path} is no TOML in UTF-8 (a key of more than 20 parts)" in said
    numbers = ", ".join(f"{k / 1000:g}" for k in range(1, 201))  # of which each has a dot
    written(path, f'name = "s"\n[[grid]]\nwall = "walls/solid.py"\nvary = {{ a = [{numbers}] }}\n'
            'options = { harmonic = [0.2, "{a}"] }\n')
    assert len(load_study(path, "reference", REPOSITORY).runs) == 200


def test_runs_that_are_there_twice_are_found_before_any_record_is_read(tmp_path, monkeypatch):
    """60 kB of them took seventeen seconds."""
    monkeypatch.setattr(definition, "_try_options", None)
    path = written(tmp_path / "s.toml", 'name = "s"\n' + '[[runs]]\nwall = "walls/solid.py"\n' * 2)
    assert "runs 1 and 2 are both" in one_line_error(load_study, path, "reference", REPOSITORY)


class TestObspy:
    @pytest.fixture(autouse=True)
    def obspy(self):
        pytest.importorskip("obspy", reason="obspy is an optional extra")

    @pytest.mark.parametrize("place", [slice(20, 22), slice(52, None, 512)], ids=["year 0", "samples are letters"])
    def test_zeros_in_a_head(self, place, tmp_path):
        """Of the first record's start; of the encoding in blockette 1000 of all."""
        data = bytearray(TRACE.read_bytes())
        data[place] = bytes(len(data[place]))
        one_line_error(read_record, written(tmp_path / "a.mseed", bytes(data)), STATION)

    def test_parts_are_counted_before_they_are_joined(self, tmp_path, monkeypatch):
        """12 MB of one record again and again took 17 s."""
        monkeypatch.setattr(formats, "MOST_PARTS", 10)
        path = written(tmp_path / "a.mseed", TRACE.read_bytes()[:512] * 20)
        assert "20 parts with gaps or overlaps" in one_line_error(read_record, path, STATION)

    @pytest.mark.parametrize("coding", ["utf-8", "utf-16"])
    def test_no_entity_of_a_station_file_is_expanded(self, coding, tmp_path):
        """Neither another file nor entities of entities: a document type is refused whatever it says."""
        value = "<Value>213867.4766</Value>"
        secret = written(tmp_path / "secret", "213867.4766")
        text = STATION.read_text()
        assert value in text
        body = text.partition("?>")[2]
        for entity in (f'SYSTEM "{secret.as_uri()}"', '"213867.4766"'):
            damaged = (f"<?xml version='1.0' encoding='{coding}'?><!DOCTYPE x [<!ENTITY v {entity}>]>"
                       + body.replace(value, "<Value>&v;</Value>"))
            path = written(tmp_path / "a.xml", damaged.encode(coding))
            assert "document type" in one_line_error(read_record, TRACE, path)
