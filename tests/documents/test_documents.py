"""What documents name is there: links, files, commands."""

import re
from fnmatch import fnmatch
from functools import cached_property
from importlib import import_module
from inspect import isclass, isfunction
from pathlib import Path
from types import FunctionType

from conftest import REPOSITORY, run_command

from damage.__main__ import main
from paper.__main__ import COMMANDS, PROGRAMS
from scripts import seeded_faults

ROOT_DOCUMENTS = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")
DOCUMENTS = [
    *(REPOSITORY / name for name in ROOT_DOCUMENTS),
    *sorted((REPOSITORY / "docs").rglob("*.md")),
]

LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```|^ {4}\S.*?$|`[^`]+`", re.DOTALL | re.MULTILINE)
COMMAND = re.compile(r"python3 -m damage (\w[\w-]*)")
# What a reader is to have, or a run leaves: no part of the repository.
NOT_OURS = (
    "records/*",
    "walls/NAME.py",
    "walls/{wall}.py",
    "walls/mine.py",
    "benchmarks/NAME.csv",
    *(
        name
        for guide in (REPOSITORY / "docs" / "guides").glob("*.md")
        for name in re.findall(r"^```(?:python|toml)\n# (\S+)$", guide.read_text(), re.MULTILINE)
    ),
)


def listed_files():
    done = run_command("git", "ls-files", "-co", "--exclude-standard", check=True)
    return [path for path in done.stdout.splitlines() if (REPOSITORY / path).exists()]


FILES = listed_files()
FOLDERS = {path.rpartition("/")[0] for path in FILES}
TOPS = {path.partition("/")[0] for path in FILES if "/" in path}


def named_files(text):
    """Words in code that begin with a folder of the repository, or end in .md: a list of str."""
    words = [
        word.strip("`,;:()'\"").removesuffix("/")
        for code in CODE.findall(text)
        for word in code.split()
    ]
    return [
        word.partition("#")[0].partition("::")[0]
        for word in words
        if (word.partition("/")[0] in TOPS and "/" in word) or re.fullmatch(r"[\w./-]+\.md", word)
    ]


def is_there(name, document):
    """Whether a name, with * for anything, is a file or folder seen from the document or from the
    repository."""
    beside = (document.parent / name).exists()
    return beside or name in FOLDERS or any(fnmatch(path, name) for path in FILES)


def is_command(name):
    """Whether `python3 -m damage NAME --help` gives its help; `study` would turn this process into
    its program."""
    if name == "study":
        return True
    try:
        return main([name, "--help"]) == 0
    except SystemExit as end:
        return end.code == 0


def test_links_lead_somewhere():
    missing = [
        f"{document.name}: {link}"
        for document in DOCUMENTS
        for link in LINK.findall(document.read_text())
        if "://" not in link and not (document.parent / link.partition("#")[0]).exists()
    ]
    assert missing == []


def test_no_line_of_a_paragraph_begins_as_something_else():
    """The site leaves out lines that begin with a percent sign, and makes lists of a plus sign."""
    lost = [
        f"{document.name}: {line}"
        for document in DOCUMENTS
        for line in re.findall(r"^ *[%+] .*$", document.read_text(), re.MULTILINE)
    ]
    assert lost == []


def test_named_files_are_there():
    missing = [
        f"{document.name}: {name}"
        for document in DOCUMENTS
        for name in named_files(document.read_text())
        if not any(fnmatch(name, pattern) for pattern in NOT_OURS) and not is_there(name, document)
    ]
    assert missing == []


def test_commands_are_those_of_the_program():
    """The log of changes names old ones, too."""
    named = {
        name
        for document in DOCUMENTS
        if document.name != "CHANGELOG.md"
        for name in COMMAND.findall(document.read_text())
    } - {"COMMAND"}
    assert [name for name in sorted(named) if not is_command(name)] == []


def test_programs_of_documents_are_there():
    """Every module of paper/ with a `main` can be asked for by name, and those that documents ask
    for are there."""
    programs = {
        path.stem
        for path in (REPOSITORY / "paper").glob("[a-z]*.py")
        if re.search(r"^def main\(", path.read_text(), re.MULTILINE)
    }
    assert programs == set(PROGRAMS)
    named = {
        name
        for path in DOCUMENTS
        for name in re.findall(r"python3\s+-m\s+paper\s+(\w+)", path.read_text())
    }
    assert named <= {*PROGRAMS, *COMMANDS, "studies", "NAME", "COMMAND"}


PAGES = {
    path.relative_to(REPOSITORY / "docs").as_posix()
    for path in (REPOSITORY / "docs").rglob("*.md")
    # these, and the front page of the site
    if "tables" not in path.parts
} - {"README.md", "index.md"}


def test_every_document_is_in_the_index():
    index = (REPOSITORY / "docs" / "README.md").read_text()
    linked = {
        link for link in LINK.findall(index) if link.endswith(".md") and not link.startswith("..")
    }
    assert linked == {page for page in PAGES if not page.startswith("api/")}


def reference():
    """(module, name, methods in parentheses or "") of all that the reference shows."""
    pages = sorted((REPOSITORY / "docs" / "api").glob("*.md"))
    blocks = re.findall(
        r"^```{modules}\n(.*?)\n```",
        "\n".join(map(Path.read_text, pages)),
        re.MULTILINE | re.DOTALL,
    )
    for line in (line for block in blocks for line in re.split(r"\n(?! )", block)):
        module, _, names = line.partition(":")
        yield from ((module, *shown) for shown in re.findall(r"(\w+)(\([^)]*\))?", names))


def without_example(module, name, methods):
    """The name of a function, or those of a class's methods, that no example calls: methods are
    called in their own docstring or in that of their class."""
    shown = getattr(import_module(module), name)
    if isfunction(shown):
        return [] if ">>>" in shown.__doc__ else [name]
    if not isclass(shown):
        return []
    kinds = FunctionType, property, cached_property
    documented = [
        name
        for name, value in vars(shown).items()
        if isinstance(value, kinds) and value.__doc__ and not name.startswith("_")
    ]
    calls = " ".join(re.findall(r"(?:>>>|\.\.\.)(.*)", shown.__doc__))
    return [
        method
        for method in (methods.strip("()").split() if methods else documented)
        if f".{method}" not in calls and ">>>" not in getattr(shown, method).__doc__
    ]


def test_all_that_the_reference_shows_has_an_example():
    assert [missing for shown in reference() for missing in without_example(*shown)] == []


def one_file(name):
    """The only file of the tests of this name."""
    (path,) = (REPOSITORY / "tests").rglob(name)
    return path


def test_seeded_faults_change_lines_that_are_there_and_name_tests_that_are():
    for fault in seeded_faults.FAULTS:
        assert fault.right in (REPOSITORY / fault.path).read_text(encoding="utf-8"), fault.what
        assert all(one_file(f"{name}.py") for name in fault.tests.split()), fault.what
