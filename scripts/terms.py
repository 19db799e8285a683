"""The gate of terms: no replaced term that has no other meaning, and a glossary that lists all of
them.

    python3 scripts/terms.py [--renew] [ROOT]  # ROOT: by default the repository; --renew: write the
                                               # glossary's table

Prints a line for each place, and for a glossary that is not current; the exit status is 1 if there
is one.
"""

import os
import re
import sys
from pathlib import Path
from typing import NamedTuple


class Term(NamedTuple):
    """A replaced term: as the glossary shows it, the terms that replace it, and where it is
    rejected.

    pattern: a regular expression, None where the word has another meaning, too; it is searched in
    lower case, and matches whole words, between underscores as well.
    """

    old: str
    new: str
    pattern: str | None = None


REPLACED = (
    Term("told, joints_told, Told", "active contacts; sparse contact data; samples", r"told"),
    Term("whole, broken pair", "intact, failed interface", r"(whole|broken) pairs?"),
    Term("goes, is gone, spent", "fails, debonded", r"bonds? (is|are|was|were|has) (gone|spent)"),
    Term("lane", "SIMD lane (defined once), then batch member"),
    Term("fibres", "parallel (overlay) elements"),
    Term("closure", "plastic closure (crushing displacement)"),
    Term("cap", "rigid top mass"),
    Term("doubts", "warnings", r"doubts?"),
    Term("energy error", "energy balance error"),
    Term("turn, spin", "rotation, angular velocity"),
    Term("shock", "event"),
    Term(
        "verbs (of a solver)", "interface", r"(solver's verbs?|verbs? of (a|the|every|each) solver)"
    ),
    Term("on the edge", "borderline", r"on the edge"),
    Term("held against", "validation, comparison", r"(held|hold|holds|holding) against"),
    Term("mend", "correct, fix", r"mend(s|ed|ing)?"),
    Term("in lockstep", "together", r"in lockstep"),
    Term("goes on from here", "continues from here", r"go(es)? on from here"),
)
"""All replaced terms, in the order of the glossary."""

GLOSSARY = "docs/reference/glossary.md"
_TABLE = re.compile(r"^\| replaced \| by \|\n(\|.*(\n|\Z))+", re.MULTILINE)

EXEMPT = (
    "CHANGELOG.md",
    "scripts/terms.py",
    GLOSSARY,  # these name the replaced terms
)
"""Files and folders that are not searched."""

_ENDINGS = (".py", ".md", ".sh", ".toml", ".js", ".html", ".css", ".smk", ".yml", ".yaml")
_NAMES = ("Snakefile", "run_all.sh", "yade")
_PASSED_OVER = {"node_modules", "__pycache__", "build", "dist", "site", "shared", "results"}
_WORDS = re.compile(
    "|".join(
        rf"(?P<t{number}>(?<![a-z])(?:{term.pattern})(?![a-z]))"
        for number, term in enumerate(REPLACED)
        if term.pattern
    )
)


def glossary_table():
    """The glossary's table of replaced terms, Markdown."""
    return "| replaced | by |\n| --- | --- |\n" + "".join(
        f"| {term.old} | {term.new} |\n" for term in REPLACED
    )


def files_below(root):
    """Paths of the code and the handwritten documents below a folder, relative to it, in order."""
    for folder, below, names in os.walk(root):
        place = Path(folder).relative_to(root)
        below[:] = sorted(
            name
            for name in below
            if not name.startswith(".")
            and name not in _PASSED_OVER
            and (place / name).as_posix() not in EXEMPT
        )
        for name in sorted(names):
            path = place / name
            if path.as_posix() not in EXEMPT and (path.suffix in _ENDINGS or name in _NAMES):
                yield path


def terms_in(line):
    """(word, Term) of every replaced term in a line.

    >>> [(word, term.new) for word, term in terms_in("n_told = 3  # mend it; amended, untold")]
    [('told', 'active contacts; sparse contact data; samples'), ('mend', 'correct, fix')]
    """
    return [
        (found[0], REPLACED[int(found.lastgroup[1:])]) for found in _WORDS.finditer(line.lower())
    ]


def places(root):
    """A line for each replaced term in the files below a folder."""
    for path in files_below(root):
        for number, line in enumerate(
            (root / path).read_text(encoding="utf-8").splitlines(), start=1
        ):
            yield from (
                f"{path}:{number}: {word!r}: expected {term.new}" for word, term in terms_in(line)
            )


def glossary_faults(root, renew):
    """A line where the glossary's table is not that of REPLACED; renew: write it."""
    text = (root / GLOSSARY).read_text(encoding="utf-8")
    made = _TABLE.sub(lambda _: glossary_table(), text)
    if _TABLE.search(text) is None:
        yield (
            f"{GLOSSARY}: no table that begins with '| replaced | by |'; expected the replaced"
            " terms"
        )
    elif made != text and renew:
        (root / GLOSSARY).write_text(made, encoding="utf-8")
    elif made != text:
        yield (
            f"{GLOSSARY}: its replaced terms are not those of scripts/terms.py; python3"
            " scripts/terms.py --renew"
        )


def main(arguments):
    """Search ROOT; returns 1 if a replaced term is found or the glossary is not current."""
    renew = arguments[:1] == ["--renew"]
    root = Path(*arguments[renew:][:1] or [Path(__file__).resolve().parents[1]])
    faults = [*places(root), *glossary_faults(root, renew)]
    print(*faults, sep="\n", end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
