"""Files that are cut off, garbled, huge, oddly named, or may not be read: one line each, whatever
stands in them."""

import os
import shutil
import sys
from functools import partial

import pytest
from conftest import REPOSITORY, one_line_error, run_command, written
from small_history import small_layout

from damage.applications.cracks import crack_mapping
from damage.applications.cracks.crack_file import read_cracks
from damage.applications.cracks.dic import read_field
from damage.applications.studies.definition import load_study
from damage.csv_table import read_csv
from damage.fields import Column
from damage.files import LONGEST_LINE
from damage.motion import columns as record_columns
from damage.motion import formats
from damage.motion.formats import read_record, shipped_record_path

HUGE = 10**12  # bytes of a file that has none: a hole


def huge(path):
    with path.open("w") as file:
        file.truncate(HUGE)
    return path


# --- wall files -----------------------------------------------------------------------------------

WALLS = {
    "x = 1\ndef wall(:\n": "wall.py line 2: failed with SyntaxError: invalid syntax",
    "if 1:\n\tx = 1\n        y = 2\n": "wall.py line 3: failed with TabError",
    "x = 1\0\n": "null bytes",
    "import no_such_library\n": "line 1: failed with ModuleNotFoundError",
    "def wall():\n    x = 1\n    raise KeyError('a\\x1b[31mb\\nc')\n": (
        "line 3: failed with KeyError"
    ),
    "def wall():\n    return wall()\n": "line 2: failed with RecursionError",
    "import sys\nsys.exit('bye')\n": "line 2: failed with SystemExit: bye",
    **dict.fromkeys(("x = 1\n", "wall = 3\n", "def wall():\n    pass\n"), "no function wall()"),
    "from damage import Wall\ndef wall():\n    return Wall('w', 2.0, -1.0)\n": (
        "line 3: Wall.height = -1.0: expected"
    ),
    "from damage import Wall\ndef wall():\n    return Wall('w/\\n', 2.0, 1.0)\n": (
        "line 3: Wall.name = "
    ),
    f"from damage import Wall\ndef wall():\n    return Wall('{'w' * 200}', 2.0, 1.0)\n": (
        "expected up to 100 letters"
    ),
    "from damage import Wall\ndef wall():\n    return Wall('w', 1e9, 1e9)\n": (
        "Wall.length = 1000000000.0"
    ),
    "from damage import Wall\ndef wall():\n    return Wall('w', 2.0, 1.0, openings=3)\n": (
        "line 3: Wall.openings has 3"
    ),
    "from damage import Wall\ndef wall():\n    return Wall('w', 2.0, 1.0, brick=3)\n": (
        "line 3: failed with Attribute"
    ),
}


@pytest.mark.parametrize("text", WALLS)
def test_a_wall_file_that_fails_is_reported_with_its_line(text, tmp_path, error_of):
    path = written(tmp_path / "wall.py", text)
    for words in (("modes", path), ("reference", path, "--out", tmp_path / "out.h5")):
        assert WALLS[text] in error_of(*words)
    assert not (tmp_path / "out.h5").exists()


# --- names ----------------------------------------------------------------------------------------

NAMES = {
    "x" * 300: "a name of 300 bytes",
    "é" * 200: "a name of 400 bytes",
    "x/" * 4000: "File name too long",
    "a\x1b[31m": "a\\x1b[31m",
    "a\nb": "a\\nb",
    "a\udcff": "a\\udcff",
}


@pytest.mark.parametrize("name", NAMES, ids=ascii)
@pytest.mark.parametrize(
    "words",
    [
        ["index", "?"],
        ["record", "?"],
        ["modes", "?"],
        ["plot", "H", "--out", "?"],
        ["tables", "summary", "H", "--out", "?"],
        ["study-tables", "?", "x"],
        ["reference", "?"],
        ["reference", "W", "--record", "?"],
        ["reference", "W", "--out", "?"],
        ["cracks", "--dic", "?", "--wall", "W"],
    ],
)
def test_names_that_no_file_can_have_or_that_would_garble_a_terminal(
    name, words, still_history, error_of
):
    known = {"?": name, "H": still_history.path, "W": REPOSITORY / "walls" / "solid.py"}
    assert NAMES[name] in error_of(*(known.get(word, word) for word in words))


def test_words_that_are_no_options_are_shown_harmlessly(error_of):
    for words in (["reference", "-\x1b[31m"], ["no\x1bsuch"], ["index", "x.h5", "--a\x9b2J"]):
        error_of(*words)


def test_a_long_name_of_a_run_is_cut(tmp_path, monkeypatch):
    """Its record's name, factors and model make a default name of over 255 bytes: two runs of one
    start differ."""
    from damage.run.options import parse_run
    from damage.run.paths import free_name

    factors = ["1" + k * ",0.125" for k in (80, 81)]
    names = [
        free_name(
            small_layout().wall,
            parse_run(["--sequence", words, "--rest", "0"], "test", "reference"),
            "reference",
            tmp_path,
        ).name
        for words in factors
    ]
    assert len(set(names)) == 2 and all(len(os.fsencode(name)) < 220 for name in names)


# --- records --------------------------------------------------------------------------------------

AT2 = "PEER\na station\nACCELERATION TIME SERIES IN UNITS OF G\n"
TEXTS = {
    "cut.at2": (AT2 + "NPTS= 400, DT= .005 SEC\n.1 .2\n", "2 values"),
    "counted.at2": (AT2 + "NPTS= " + "9" * 5000 + ", DT= .005 SEC\n.1 .2\n", "NPTS"),
    "step.at2": (AT2 + "NPTS= 2, DT= 1e-300 SEC\n.1 .2\n", "time step"),
    "coloured.at2": (AT2 + "NPTS= 2, DT= .005 SEC\n.1 \x1b[31mred\n", "\\x1b"),
    "unit.at2": (AT2 + "NPTS= 2, DT= .005 SEC\n.1 1e308\n", "inf"),
    "binary.csv": ("\0\1\2\x1b" * 100, "expected"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_records_that_are_cut_off_or_garbled(name, tmp_path):
    text, expected = TEXTS[name]
    assert expected in one_line_error(read_record, written(tmp_path / name, text))


def test_a_record_of_many_samples_or_bytes(tmp_path):
    assert "1e+06 MB" in one_line_error(read_record, huge(tmp_path / "huge.csv"))
    many = written(
        tmp_path / "many.at2",
        f"{AT2}NPTS= 1000002, DT= .005 SEC\n" + ("0 " * 50 + "\n") * 20000 + "0 0\n",
    )
    assert "1000002 samples; expected up to 1000000" in one_line_error(read_record, many)


class TestMiniSeed:
    SHIPPED = shipped_record_path("NL.BGAR..HGE")
    XML = SHIPPED.parent / "NL.BGAR.xml"

    @pytest.fixture(autouse=True)
    def obspy(self):
        pytest.importorskip("obspy", reason="obspy is an optional extra")

    def test_cut_off(self, tmp_path, capfd):
        data = self.SHIPPED.read_bytes()
        for length in (1, 48, 100, 511, 513, 600, 4097, len(data) - 1):
            one_line_error(read_record, written(tmp_path / "cut.mseed", data[:length]), self.XML)
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize("text", ["", "<", "<?xml version='1.0'?>", "half", "nan", "1e400"])
    def test_station_xml(self, text, tmp_path, capfd):
        whole = self.XML.read_text()
        text = {
            "half": whole[: len(whole) // 2],
            "nan": whole.replace("213867.4766", "nan"),
            "1e400": whole.replace("213867.4766", "1e400"),
        }.get(text, text)
        one_line_error(read_record, self.SHIPPED, written(tmp_path / "odd.xml", text))
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize("coding", ["utf-8", "utf-16"])
    def test_no_entity_of_a_station_file_is_expanded(self, coding, tmp_path):
        """Neither another file nor entities of entities: a document type is refused whatever it
        says."""
        value = "<Value>213867.4766</Value>"
        secret = written(tmp_path / "secret", "213867.4766")
        text = self.XML.read_text()
        assert value in text
        body = text.partition("?>")[2]
        for entity in (f'SYSTEM "{secret.as_uri()}"', '"213867.4766"'):
            damaged = (
                f"<?xml version='1.0' encoding='{coding}'?><!DOCTYPE x [<!ENTITY v {entity}>]>"
                + body.replace(value, "<Value>&v;</Value>")
            )
            path = written(tmp_path / "a.xml", damaged.encode(coding))
            assert "document type" in one_line_error(read_record, self.SHIPPED, path)


# --- what was once misread, or took too long ------------------------------------------------------


@pytest.mark.parametrize("text", ["\n" * 5 + "0,1\n" * 40, "0,1\n" * 40])
def test_a_record_of_too_many_lines_is_refused_before_they_are_parsed(text, tmp_path, monkeypatch):
    """28 MB of lines took more than ten seconds."""
    monkeypatch.setattr(formats, "MOST_LINES", 30)
    assert "more than 30 lines" in one_line_error(read_record, written(tmp_path / "a.csv", text))
    monkeypatch.setattr(formats, "MOST_LINES", 100)
    monkeypatch.setattr(record_columns, "MOST_SAMPLES", 30)
    assert "40 samples; expected up to 30" in one_line_error(
        read_record, written(tmp_path / "a.csv", text)
    )


@pytest.mark.parametrize(
    ("read_it", "name", "text", "said"),
    [
        # Refused by its count, before the words are met.
        (
            read_record,
            "a.at2",
            (
                "PEER\na\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 1000001, DT= .005 SEC\n.1"
                " words\n"
            ),
            "1000001 samples; expected up to",
        ),
        (
            partial(read_csv, columns={"record": Column("", "")}),
            "e.csv",
            "record;scale\nBGAR_HGE;1,5\n",
            "unknown column 'scale'; expected any of record",
        ),
        (read_csv, "t.csv", 'a,b\n"0\n",1\n1,2,3\n', "line 4: 3 cells; expected 2"),
        # pandas takes such a cell for a number, Python does not.
        (read_field, "f.csv", "x_m,z_m,ux_m,uz_m\n0.\0,0,0,0\n", "holds a zero byte"),
    ],
)
def test_what_was_misread_or_reported_wrongly_is_refused(read_it, name, text, said, tmp_path):
    assert said in one_line_error(read_it, written(tmp_path / name, text))


@pytest.mark.parametrize(
    ("name", "read_it"), [("a.csv", read_record), ("a.at2", read_record), ("f.csv", read_field)]
)
def test_a_line_of_millions_of_cells_is_refused(name, read_it, tmp_path):
    """A table whose row had 20 MB took a minute and 3.5 GB, a header of 20 MB no end."""
    for before in ("", "time_s,acc_m_s2\n"):
        path = written(tmp_path / name, before + "1," * LONGEST_LINE)
        assert "100000" in one_line_error(read_it, path)


def test_paths_in_a_study_longer_than_any_file_has(tmp_path):
    path = tmp_path / "s.toml"
    for record in ("x" * 300, "x/" * 3000):
        written(
            path,
            'name = "s"\n[[runs]]\nwall = "walls/solid.py"\n'
            f'options = {{ record = ["{record}", "{record}.csv"] }}\n',
        )
        said = one_line_error(load_study, path, "reference", REPOSITORY)
        assert "expected up to 255" in said or "no file" in said
    written(path, f'name = "s"\n[[runs]]\nwall = "{"x/" * 3000}"\n')
    assert "no file" in one_line_error(load_study, path, "reference", REPOSITORY)


@pytest.mark.parametrize(
    "text", ["[[grid]]\nvary = {}\n", "name = {}\n", "[[runs]]\noptions = {}\n"]
)
def test_a_study_whose_tables_are_too_deep_in_each_other(text, tmp_path):
    """Python's own recursion ended it while it was reported."""
    for opening, closing in ("[]", ("{a=", "}")):
        path = written(tmp_path / "s.toml", text.format(opening * 200 + "1" + closing * 200))
        assert "more than 20 deep" in one_line_error(load_study, path, "reference", REPOSITORY)


# --- crack files, fields, studies -----------------------------------------------------------------

HEAD = "crack,point,x_m,z_m,width_mm\n"
CRACKS = {
    HEAD + "a,1,0,0,1\na,2,20000,20000,1\n": "line 3: x_m = 20000: expected -1000 to 1000",
    HEAD + "a,1,0,0,1e300\na,2,1,0,1\n": "line 2: width_mm = 1e300: expected 0 to 10000",
    HEAD
    + "".join(f"a{k},1,0,{k},1\na{k},2,900,{k},1\n" for k in range(20)): "cracks of 18000 m in all",
    HEAD + "a,1,0,0,1\na,2,0.": "line 3: 3 cells",
    HEAD + "\x1b[31m,2,0,0,1\n": "crack \\x1b[31m",
    "crack,point,x_m,z_m,width_mm,load_level\n"
    + "".join(f"a,1,0,0,1,{k}\na,2,1,0,1,{k}\n" for k in range(1001)): "1001 load levels",
    HEAD + "a,1,0,0,1\n" * 20_000 + "a,2,1,1,1\n": "20001 rows",
}


@pytest.mark.parametrize("text", CRACKS, ids=lambda text: CRACKS[text])
def test_cracks_beyond_any_wall(text, tmp_path):
    assert CRACKS[text] in one_line_error(read_cracks, written(tmp_path / "cracks.csv", text))


def test_a_long_crack_is_mapped_as_one_piece_would_be(tmp_path, monkeypatch):
    """Across the whole wall and far beyond it, in parts of 0.1 m and at once."""
    (tmp_path / "long.csv").write_text(
        HEAD + "a,1,-2.05,-1,1\na,2,3.1,1.52,1\nb,1,-0.5,0.0751,1\nb,2,1.4,0.0751,1\n"
    )
    (pattern,) = read_cracks(tmp_path / "long.csv")
    in_parts = crack_mapping.map_cracks(pattern, small_layout())
    monkeypatch.setattr(crack_mapping, "_TOGETHER", 10**9)
    at_once = crack_mapping.map_cracks(pattern, small_layout())
    assert in_parts.table.equals(at_once.table) and len(in_parts.table) > 5
    assert in_parts.unmapped_m == at_once.unmapped_m > 1


RUN = '[[runs]]\nwall = "walls/solid.py"\n'
GRID = (
    'name = "g"\n[[grid]]\nwall = "walls/solid.py"\noptions = {{ harmonic = ["{{a}}", "{{b}}"]'
    " }}\nvary = {{ {} }}\n"
)
STUDIES = {
    GRID.format(
        "a = { from = 1, to = 1000000000 }, b = [0.1]"
    ): "stands for 100001 runs; expected up to 100000",
    GRID.format(
        "a = { from = 1, to = 1000 }, b = { from = 1, to = 1000 }"
    ): "stands for 1000000 runs",
    f'name = "g"\n{RUN}members = 1000000000\n': (
        "members = 1000000000: expected a whole number, 1 to 10000"
    ),
    f'name = "g"\n{RUN}samples = 0\noptions = {{ strength-cov = 0.3 }}\n': (
        "samples = 0: expected a whole number, 1 to"
    ),
    f'name = "g"\n{RUN}id = "{"x" * 300}"\n': "at most 120 letters",
    f'name = "g"\n{RUN}id = "a\\u001b"\n': "a\\x1b",
    'name = "g"\n[[runs]]\nwall = "a\\u001b[31m"\n': "a name without control characters",
    f'name = "g"\n[[runs]]\nwall = "{"x" * 300}"\n': "a name of 300 bytes",
    "a = " + "[" * 5000: "no TOML",
}


@pytest.mark.parametrize("text", STUDIES, ids=lambda text: STUDIES[text])
def test_studies_of_more_than_can_be(text, tmp_path):
    path = written(tmp_path / "study.toml", text)
    assert STUDIES[text] in one_line_error(load_study, path, "reference", REPOSITORY)


def test_a_byte_order_mark_is_no_part_of_a_study_and_another_encoding_is_refused(tmp_path):
    path, text = tmp_path / "study.toml", f'name = "marked"\n{RUN}'
    path.write_text("\ufeff" + text, encoding="utf-8")
    assert load_study(path, "reference", REPOSITORY).name == "marked"
    path.write_text(text, encoding="utf-16")
    assert "no TOML in UTF-8" in one_line_error(load_study, path, "reference", REPOSITORY)
    assert "1e+06 MB" in one_line_error(load_study, huge(path), "reference", REPOSITORY)


# --- what may not be read, and what is missing ----------------------------------------------------


def run_as_somebody(words, **environment):
    """`python3 -m damage` as a user who is not root."""
    become = []
    if os.geteuid() == 0:
        if shutil.which("setpriv") is None:
            pytest.skip("root may read everything, and no setpriv is here")
        become = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
    return run_command(
        *become,
        sys.executable,
        "-m",
        "damage",
        *words,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY), **environment},
        cwd="/",
    )


def test_folders_that_may_not_be_read(tmp_path):
    closed = tmp_path / "closed"
    (closed / "in").mkdir(parents=True)
    for folder in (tmp_path, *tmp_path.parents[:2]):
        folder.chmod(folder.stat().st_mode | 0o055)  # the folders of pytest, on the way there
    closed.chmod(0o000)
    try:
        done = run_as_somebody(["study-tables", closed / "in/x.toml", closed / "in/x"])
    finally:
        closed.chmod(0o700)
    if "Permission denied" in done.stderr and str(REPOSITORY) in done.stderr:
        pytest.skip("the repository itself may not be read by others")
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith("error: ") and len(done.stderr.splitlines()) == 1, done.stderr


def stand_in(folder, library, text):
    """A folder to put on PYTHONPATH in which a library is what `text` does."""
    (folder / f"{library}.py").write_text(text)
    return os.pathsep.join([str(folder), str(REPOSITORY)])


def damage(folder, path, *words):
    return run_command(
        sys.executable, "-m", "damage", *words, cwd=folder, env={**os.environ, "PYTHONPATH": path}
    )


@pytest.mark.parametrize(
    "library, words",
    [
        ("numpy", ["index", "x.h5"]),
        ("numba", ["reference", "w.py"]),
        ("matplotlib", ["plot", "H", "--out", "o"]),
        ("jinja2", ["report", "H"]),
    ],
)
def test_a_missing_library_is_named(library, words, still_history, tmp_path):
    path = stand_in(tmp_path, library, f"raise ModuleNotFoundError('none here', name={library!r})")
    done = damage(tmp_path, path, *(still_history.path if word == "H" else word for word in words))
    assert done.returncode == 3 and len(done.stderr.splitlines()) == 1, done.stderr
    assert (
        f"cannot import {library}: expected Debian's package python3-{library}, or pip install"
        in done.stderr
    )


@pytest.mark.parametrize(
    "library, words",
    [
        ("numpy", ["index", "x.h5"]),
        ("numba", ["reference", "w.py"]),
    ],
)
def test_an_interrupt_while_a_library_is_imported_is_quiet(library, words, still_history, tmp_path):
    path = stand_in(
        tmp_path,
        library,
        "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\nprint('went on')\n",
    )
    done = damage(tmp_path, path, *(still_history.path if word == "H" else word for word in words))
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


def test_a_picture_where_the_home_folder_takes_no_cache_is_drawn_without_a_word_of_matplotlib(
    tmp_path,
):
    (tmp_path / "file").touch()
    odd = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"), str(tmp_path / "file"))
    done = run_command(
        sys.executable,
        "-m",
        "damage",
        "draw",
        REPOSITORY / "walls/variants/small.py",
        "--out",
        "o.png",
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY), **odd},
    )
    assert done.returncode == 0 and (tmp_path / "o.png").is_file()
    assert "atplotlib" not in done.stderr, done.stderr


def test_compiled_code_finds_a_place_where_none_can_be_written(tmp_path):
    """The folder beside the sources, the home folder's and numba's own are files."""
    package, file = tmp_path / "damage", tmp_path / "file"
    shutil.copytree(
        REPOSITORY / "damage", package, ignore=shutil.ignore_patterns("__pycache__", "data")
    )
    for path in (file, package / "mechanics" / "__pycache__"):
        path.touch()
    code = (
        "import numba, os, damage.mechanics.step as k; print(k.__file__, numba.config.CACHE_DIR,"
        " os.path.isdir(numba.config.CACHE_DIR))"
    )
    odd = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR"), str(file))
    done = run_command(
        sys.executable,
        "-c",
        code,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), **odd},
    )
    assert done.returncode == 0, done.stderr
    source, folder, there = done.stdout.split()
    assert source.startswith(str(tmp_path)) and there == "True"
    assert len(done.stderr.splitlines()) == 1 and "warning: no folder can be written" in done.stderr
    assert not os.path.exists(folder)
