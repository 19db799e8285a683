"""Statements of the paper and the criteria of its claims (claims.csv, statements.csv): `paper.verdict` judges.

Paper: V. Sarhosis, D. Dais, E. Smyrou, I. E. Bal, A. Drougkas (2021), Engineering Structures 243, 112529,
doi:10.1016/j.engstruct.2021.112529.  Its statements P1 to P17 are split into claims that one number each can
decide.  The criteria were written before the studies were run, and are not changed after: a claim that differs
stays so, and its evidence goes to docs/paper/open-points.md.  Known when they were written: single runs of the
three walls, and the figures of an earlier exploration with another solver.  No threshold was fitted to those:
each follows from the paper's words, the digits that it prints, or the scatter between two correct solvers
(docs/validation/two-solvers.md).

Rules for all claims:
- A wall that fell differs from the paper's, which stood; its index up to the fall proves nothing.
- A claim about several motions differs as soon as one of them contradicts it.  It holds when none does and the
  motions that try it hardest (`needs`) are there; otherwise it cannot be judged.
- Of a point that was run several times, with strengths that scatter or bricks offset by 1e-9 m, the median counts.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

AMPLITUDES_G = (0.01, 0.025, 0.05, 0.075, 0.1)
"""Amplitudes of the harmonic motions [g] (section 4)."""
PERIODS_S = (0.06, 0.2, 0.33, 1.0)
"""Periods of the harmonic motions [s] (section 4)."""
SCALES = (0.5, 0.75, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0)
"""Scale factors of the incremental dynamic analysis (section 5)."""

# --- words into numbers ---------------------------------------------------------------------------

NEGLIGIBLE_DI = 0.02
"""Damage is negligible up to this DI: 2 % of the joints, or a fiftieth of the near-collapse drift; in the
paper's figures, whose axes reach 0.15 and more, it can hardly be distinguished from zero."""
SLIGHT_DI = 0.05
"""Damage is slight up to this DI: below half of the smallest DI (0.10) that the paper calls limited only."""
INSIGNIFICANT_DI_DRIFT = 0.01
"""Residual drift is insignificant up to this DI_drift, half of what is negligible: a drift ratio of 0.02 %, half
a millimetre at the top of the wall."""
MOSTLY_CRACKS = 0.25
"""Residual damage is mostly cracks while DI_drift is at most this share of DI."""
LINEAR_R2 = 0.95
"""Linear: a straight line by least squares explains at least this share of the variance."""
PRINTED_TOLERANCE = 0.10
"""Numbers that the paper prints with one or two digits (periods, PGA, cycle lengths) are met within this share:
half a unit of the last digit is 8 % of 0.06 s and 6 % of 0.08 g."""
ABOUT_TOLERANCE = 0.20
"""Numbers that the paper calls "close to" are met within this share."""
DI_TOLERANCE = 0.03
"""Values of DI are met within this distance: so much may two correct solvers differ
(docs/validation/two-solvers.md)."""
SAME_VALUES = 0.30
"""Values are the same when their range is at most this share of their mean: by so much DI_open scatters
between runs that differ by rounding only."""
NOT_EXCEEDED = 1.05
"""The first cycle's maximum is not exceeded while no later cycle's is above this multiple of it."""
GROWS = 1.01
"""A quantity grows when each value is at least this multiple of the one before: above rounding, below any step
that a figure shows."""
NOT_FALLING = 0.99
"""Cycle lengths do not fall while each is at least this multiple of the one before (a cycle's length scatters
by 1.2 % between runs that differ by rounding only)."""
ELONGATION = 1.2
"""Cycles lengthen with amplitude when the last is at least this multiple of the first (the paper's is 1.95)."""
SUBSTANTIALLY_HIGHER = 1.5
"""Damage is substantially higher from this multiple of the next highest on: half as much again."""
SIMILAR = 2.0
"""Two walls respond similarly when their DI differ by at most this factor, or both are slight: the paper shows no
figures of the asymmetric wall, so that "similar" is read as the same grade of damage."""
PLATEAU = 0.5
"""A second-order trend approaches a plateau when its slope at the largest drift is at most this share of that at
the smallest."""
FEWEST_POINTS = 8
"""Fewest runs for a second-order trend: one record at all scale factors."""
NO_DAMPING = 1e-6
"""No damping: it takes at most this share of the input, which is rounding."""
ENERGY_ERROR = 0.02
"""The balance closes within this share of the input, so that no hidden dissipation is left."""

# --- numbers of the paper and of the test that it validates against --------------------------------

SOLID_PERIOD_S, PERFORATED_PERIOD_S = 0.06, 0.2
CYCLE_LENGTHS_S = (0.20, 0.20, 0.24, 0.32, 0.39)
"""Figure 9, in the order of AMPLITUDES_G."""
LARGEST_DI = {0.33: 0.13, 1.0: 0.10}
"""Section 4: maximum DI of the symmetric wall at 0.1 g, by period [s]."""
PGA_G = {"huizinge": 0.08, "zeerijp": 0.11}
SA_G = 0.15
"""Spectral acceleration of both records at 0.2 s [g] (section 5)."""
LARGEST_RESIDUAL_DI = 0.11
"""Figure 11: Huizinge at twice its strength."""
SQUAT_STIFFNESS_N_PER_M = (131e6, 163e6)
"""Test COMP1_3 (Graziotti et al. 2016), both directions: bilinear force over its elastic drift times 2.75 m.  The
elastic branch of a bilinear idealisation goes through 0.7 of the peak, so ours is the secant to there."""
SQUAT_PEAK_N = (76.7e3, 77.96e3)
"""Test COMP1_3, both directions."""

CONVERGED_SPEED_M_S = 0.002
"""Fastest pushed top whose secant stiffness counts: at 1 and 2 mm/s it is within 3 % of its middle whatever the
damping, at 5 mm/s 3 % less, for waves of the first breaks come while the force still grows
(docs/validation/laboratory.md)."""
BUILT_TO_MEET = ("P1", "P2a", "P13a", "P13b", "P13c", "P13d", "P13e", "P16")
"""Claims that the model was built to meet, which are counted apart from what it predicts: the precompression is a mass
for the sake of the periods, the records and their factors are input, and damping was left out."""


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
        return self.id not in BUILT_TO_MEET


def _table(name):
    """Rows of a table beside this module, dictionaries; {NAME} in a criterion is a value of this module."""
    with open(Path(__file__).with_name(name), newline="", encoding="utf-8") as file:
        values = globals() | {"speed_mm_s": 1e3 * CONVERGED_SPEED_M_S}
        return [{key: text.format(**values) for key, text in row.items()} for row in csv.DictReader(file)]


def page(name, **parts):
    """A page of docs/paper, by its template in paper/pages; parts: lists of lines, or values."""
    text = (Path(__file__).parent / "pages" / name).read_text(encoding="utf-8")
    return text.format(**{key: "\n".join(part) if isinstance(part, list) else part for key, part in parts.items()})


CLAIMS = tuple(Claim(**row) for row in _table("claims.csv"))
STATEMENTS = {row["statement"]: row["text"] for row in _table("statements.csv")}
