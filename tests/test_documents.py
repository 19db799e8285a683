"""What documents name is there: links, files, commands."""

import re
from fnmatch import fnmatch

import pandas as pd
import pytest
from conftest import REPOSITORY, run_command

from damage.__main__ import main
from paper.__main__ import COMMANDS, PROGRAMS
from paper.document_figures import FIGURES, after_the_peak, places_of, settled_walls, thirty_years, two_courses

ROOT_DOCUMENTS = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")
DOCUMENTS = [*(REPOSITORY / name for name in ROOT_DOCUMENTS), *sorted((REPOSITORY / "docs").rglob("*.md"))]
of_every_document = pytest.mark.parametrize(
    "document", DOCUMENTS, ids=lambda path: path.relative_to(REPOSITORY).as_posix())

LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```|^ {4}\S.*?$|`[^`]+`", re.DOTALL | re.MULTILINE)
COMMAND = re.compile(r"python3 -m damage (\w[\w-]*)")
# What a reader is to have, or a run leaves: no part of the repository.
NOT_OURS = ("records/*", "walls/NAME.py", "walls/{wall}.py", "walls/mine.py", "benchmarks/NAME.csv", *(
    name for guide in (REPOSITORY / "docs" / "guides").glob("*.md")
    for name in re.findall(r"^```(?:python|toml)\n# (\S+)$", guide.read_text(), re.MULTILINE)))


def listed_files():
    done = run_command("git", "ls-files", "-co", "--exclude-standard", check=True)
    return [path for path in done.stdout.splitlines() if (REPOSITORY / path).exists()]


FILES = listed_files()
FOLDERS = {path.rpartition("/")[0] for path in FILES}
TOPS = {path.partition("/")[0] for path in FILES if "/" in path}


def named_files(text):
    """Words in code that begin with a folder of the repository, or end in .md: a list of str."""
    words = [word.strip("`,;:()'\"").removesuffix("/") for code in CODE.findall(text) for word in code.split()]
    return [word.partition("#")[0].partition("::")[0] for word in words
            if (word.partition("/")[0] in TOPS and "/" in word) or re.fullmatch(r"[\w./-]+\.md", word)]


def is_there(name, document):
    """Whether a name, with * for anything, is a file or folder seen from the document or from the repository."""
    beside = (document.parent / name).exists()
    return beside or name in FOLDERS or any(fnmatch(path, name) for path in FILES)


def is_command(name):
    """Whether `python3 -m damage NAME --help` gives its help; `study` would turn this process into its program."""
    if name == "study":
        return True
    try:
        return main([name, "--help"]) == 0
    except SystemExit as end:
        return end.code == 0


@of_every_document
def test_links_lead_somewhere(document):
    links = [link.partition("#")[0] for link in LINK.findall(document.read_text()) if "://" not in link]
    assert [link for link in links if link and not (document.parent / link).exists()] == []


@of_every_document
def test_named_files_are_there(document):
    names = [name for name in named_files(document.read_text())
             if not any(fnmatch(name, pattern) for pattern in NOT_OURS)]
    assert [name for name in names if not is_there(name, document)] == []


@of_every_document
def test_commands_are_those_of_the_program(document):
    if document.name != "CHANGELOG.md":  # it names old ones, too
        named = set(COMMAND.findall(document.read_text())) - {"COMMAND"}
        assert [name for name in named if not is_command(name)] == []


def test_programs_of_documents_are_there():
    """Every module of paper/ with a `main` can be asked for by name, and those that documents ask for are there."""
    programs = {path.stem for path in (REPOSITORY / "paper").glob("[a-z]*.py")
                if re.search(r"^def main\(", path.read_text(), re.MULTILINE)}
    assert programs == set(PROGRAMS)
    named = {name for path in DOCUMENTS for name in re.findall(r"python3\s+-m\s+paper\s+(\w+)", path.read_text())}
    assert not [path for path in DOCUMENTS if path.name != "CHANGELOG.md" and re.search(r"python3\s+paper/\w+\.py",
                                                                                        path.read_text())]
    assert named <= {*PROGRAMS, *COMMANDS, "studies", "NAME", "COMMAND"}


PAGES = {path.relative_to(REPOSITORY / "docs").as_posix() for path in (REPOSITORY / "docs").rglob("*.md")
         if "tables" not in path.parts} - {"README.md", "index.md"}  # these, and the front page of the site


def test_every_document_is_in_the_index():
    index = (REPOSITORY / "docs" / "README.md").read_text()
    linked = {link for link in LINK.findall(index) if link.endswith(".md") and not link.startswith("..")}
    assert linked == {page for page in PAGES if not page.startswith("api/")}


def test_what_is_not_there_is_found():
    document = REPOSITORY / "docs" / "README.md"
    assert named_files("`damage/nowhere.py`, `walls/*.py`, `x/y`, `nothing.md`") == [
        "damage/nowhere.py", "walls/*.py", "nothing.md"]
    assert not is_there("damage/nowhere.py", document) and not is_there("nothing.md", document)
    assert is_there("walls/*.py", document) and is_there("guides/planning.md", document)
    assert LINK.findall("[a](b.md) and ![c](d/e.png)") == ["b.md", "d/e.png"]
    assert COMMAND.findall("`python3 -m damage nonsense FILE`") == ["nonsense"]
    assert is_command("index") and is_command("reference") and not is_command("nonsense")


def test_tests_that_documents_name_are_there():
    """Each `tests/FILE.py::NAME` or `tests/FILE.py::CLASS::NAME`."""
    named = {test for document in DOCUMENTS for test in re.findall(r"`(tests/\w+\.py::[\w:]+)`", document.read_text())}
    missing = []
    for test in sorted(named):
        path, *names = test.split("::")
        source = (REPOSITORY / path).read_text()
        missing += [test for name in names if not re.search(rf"^ *(def|class) {name}\b", source, re.MULTILINE)]
    assert missing == []


def test_the_pictures_of_the_gallery_are_small():
    from scripts.gallery import GALLERY

    for name in GALLERY:
        assert (REPOSITORY / "docs" / "pictures" / "gallery" / f"{name}.png").stat().st_size < 80_000


class TestPicturesOfTables:
    def test_they_are_there_and_small(self):
        sizes = [(REPOSITORY / "docs" / "pictures" / f"{draw.__name__}.png").stat().st_size for draw in FIGURES]
        assert max(sizes) < 150_000

    def test_lives_are_those_of_the_page(self):
        page = (REPOSITORY / "docs" / "paper" / "thirty-years.md").read_text()
        drawn = [line.get_xdata() for line in thirty_years().axes[0].get_lines() if line.get_marker() in "os"]
        rows = re.findall(r"^\| \w+, \w+ \| (at rest|settled) \|.*?\|.*?\| (\d+) \(", page, re.MULTILINE)
        assert len(rows) == 10
        for values, ground in zip(drawn, ("at rest", "settled"), strict=True):
            assert list(values[:5]) == [float(share) for of, share in rows if of == ground]

    def test_every_settled_wall_is_drawn_and_shares_are_those_of_the_table(self):
        left, right = settled_walls().axes
        assert sum(len(line.get_xdata()) for line in left.get_lines() if line.get_marker() in "Do^s") == 1000
        shares = [line.get_ydata()[0] for line in right.get_lines() if line.get_linewidth() > 2]
        table = pd.read_csv(REPOSITORY / "docs" / "tables" / "benchmarks" / "settled_start.csv")
        assert [round(share) for share in shares] == [0, 0, *table["P(Ψ ≥ 1) [%]"]]

    def test_every_prediction_is_drawn_over_its_test(self):
        page = (REPOSITORY / "docs" / "validation" / "after-the-peak.md").read_text().partition("## Why")[0]
        rows = re.findall(r"^\| \w+ \| (?:seed \d|cycles|prediction) \| ([\d.]+) \| ([\d.]+) \|", page, re.MULTILINE)
        for ax in after_the_peak().axes:
            drawn = [value for line in ax.get_lines() if line.get_marker() in "os>" for value in line.get_xdata()]
            assert len(drawn) == len(rows) == 30
            if "peak" in ax.get_title("left"):
                assert sorted(drawn) == pytest.approx(sorted(float(ours) / float(test) for ours, test in rows))

    def test_opening_and_shear_lead_from_one_place_of_a_contact_point_to_the_other(self):
        layout, bricks, point = two_courses()
        _, ends, shear, opening = places_of(layout, {name: bricks[name] for name in "ab"}, point)
        assert ends["a"] + shear + opening == pytest.approx(ends["b"], abs=1e-12)
        assert shear @ opening == pytest.approx(0.0, abs=1e-15) and shear[0] > 0.01 and opening[1] > 0.01
