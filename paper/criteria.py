"""Statements of the paper, its claims and their criteria, each with its reason: statements.csv,
claims.csv and criteria.csv, which this module reads and by which `paper.verdict` judges.

Paper: V. Sarhosis, D. Dais, E. Smyrou, I. E. Bal, A. Drougkas (2021), Engineering Structures 243,
112529, doi:10.1016/j.engstruct.2021.112529.  Its statements P1 to P17 are split into claims that
one number each can decide.  The criteria were written before the studies were run, and are not
changed after: a claim that differs stays so, and its evidence goes to docs/paper/open-points.md.
Known when they were written: single runs of the three walls, and the figures of an earlier
exploration with another solver.  No threshold was fitted to those: each follows from the paper's
words, the digits that it prints, or the scatter between two correct solvers
(docs/validation/two-solvers.md).

Rules for all claims:
- A wall that fell differs from the paper's, which stood; its index up to the fall proves nothing.
- A claim about several motions differs as soon as one of them contradicts it.  It holds when none
  does and the motions that try it hardest (`needs`) are there; otherwise it cannot be judged.
- Of a point that was run several times, with strengths that scatter or bricks offset by 1e-9 m, the
median counts.
"""

import ast
import csv
from dataclasses import dataclass
from pathlib import Path


def _rows(name):
    """Rows of a table beside this module, dictionaries."""
    with open(Path(__file__).with_name(name), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


LIMITS = {row["name"]: ast.literal_eval(row["value"]) for row in _rows("criteria.csv")}
"""{name: value} of the amplitudes, words into numbers, and numbers of the paper and of the test
that it validates against; each is also a name of this module."""
globals().update(LIMITS)


@dataclass(frozen=True)
class Claim:
    """One claim of a statement: what the paper says, its value, and when ours agrees."""

    id: str
    text: str
    figure: str
    paper: str
    criterion: str

    @property
    def statement(self):
        """P9 of P9a."""
        return self.id.rstrip("abcdefghij")

    @property
    def predicted(self):
        """Whether it is not among those that the model was built to meet."""
        return self.id not in LIMITS["BUILT_TO_MEET"]


def page(name, **parts):
    """A page of docs/paper, by its template in paper/pages; parts: lists of lines, or values."""
    text = (Path(__file__).parent / "pages" / name).read_text(encoding="utf-8")
    return text.format(
        **{key: "\n".join(part) if isinstance(part, list) else part for key, part in parts.items()}
    )


_VALUES = LIMITS | {"speed_mm_s": 1e3 * LIMITS["CONVERGED_SPEED_M_S"]}
CLAIMS = tuple(
    Claim(**{key: text.format(**_VALUES) for key, text in row.items()})
    for row in _rows("claims.csv")
)
"""In claims.csv {NAME} is one of LIMITS."""
STATEMENTS = {row["statement"]: row["text"] for row in _rows("statements.csv")}
