"""The gate of terms: no replaced term that has no other meaning.

    python3 scripts/terms.py [ROOT]  # ROOT: by default the repository

Prints a line for each place; the exit status is 1 if there is one.
"""

import os
import re
import sys
from pathlib import Path
from typing import NamedTuple


class Term(NamedTuple):
    """A replaced term, the terms that replace it, and where it is rejected.

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
"""All replaced terms."""

EXEMPT = "CHANGELOG.md", "scripts/terms.py"  # which name the replaced terms
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


def main(arguments):
    """Search ROOT; returns 1 if a replaced term is found."""
    root = Path(*arguments[:1] or [Path(__file__).resolve().parents[1]])
    faults = [*places(root)]
    print(*faults, sep="\n", end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
