"""Synthetic claims of known truth: coverage of the sheet's intervals, answers, and errors.

    python3 -m paper claim_coverage CLAIM... [--asked-of CLAIM] [--offsets] [--surveyors N]
        [--rows ROWS.csv]

CLAIM: folder of `python3 -m damage claim`.  Each of its draws makes up to three claims: a wall by
both causes (B), by the earthquakes alone (E), and by the settlement alone (S), where the
earthquakes of the address did not occur.  A surveyor sees cracks from 0.1 mm on, each width within
0.05 mm, half of it by rounding to 0.05 mm, and misses one, a narrow one rather; --offsets: notes
whether the faces are offset by 0.1 mm.  A wall without a surveyed crack makes no claim.  The sheet
answers from all other draws: the claim's own draw is left out.  --asked-of: from the draws of
another wall, whose joints the cracks are laid on; --surveyors: each claim so often, with other
errors of its survey.

Prints four tables. Claims, why there is no answer, and answers that are wrong; on stderr the share
of wrong ones with its upper bound (95 %, exact binomial, as if claims were independent). Cracks of
the claims, and the answers on each, of which the truth is its paired run without that cause. For
each prior of settlement the share of claims, weighted by that prior, whose true widths lie in the
90 % intervals. What the sheet states as "not without the earthquakes" beside what was so, by a
prior of 0.5, and the share of draws that resemble a survey, from which follows how many are needed.
"""

import sys
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from damage.applications.cracks.crack_file import pattern_of
from damage.applications.cracks.survey import Seen, distances, seen_of, survey_of, surveyed
from damage.applications.groningen.claim.answer import (
    BUT_FOR,
    LEAST_DRAWS,
    PRIORS,
    WITHOUT,
)
from damage.applications.groningen.claim.likeness import STATES, kernel, pairwise, strange_share
from damage.applications.groningen.claim.make import layout_of
from damage.applications.groningen.claim.numbers import Likeness, answers, claimed
from damage.applications.groningen.claim.twins import NAME, read_twins
from damage.applications.studies.definition import load_study
from damage.errors import InputError
from damage.index import THRESHOLD
from damage.measure.cracks import close_pairs, crack_numbers, crack_table, cracked
from damage.units import MILLIMETRE
from paper.bench import arguments, option, print_row, print_table

LIMIT = 0.1 * MILLIMETRE
ERROR = 0.05 * MILLIMETRE
STEP = 0.05 * MILLIMETRE
BINS = 0, 0.25, 0.5, 0.75, 0.9, 1
CLAIMS = {"B": "both", "E": "earthquakes", "S": "settlement"}
"""{kind of claim: state of the twins that is surveyed}."""
TWIN = {
    "without_earthquakes": {"B": "settlement", "E": "none", "S": "settlement"},
    "without_settlement": {"B": "earthquakes", "E": "earthquakes", "S": "none"},
}
"""{cause that is left out: {kind of claim: state of the twins that remains}}."""


class Library:
    """The draws of a claim's folder, seen as a surveyor sees them, and their distances from one
    another."""

    def __init__(self, folder, offsets):
        study = load_study(Path(folder) / NAME, "reference")
        units = dict(study.runs[0].options).get("units", (1, 1))
        self.wall = layout_of(study.runs[0].wall, units)
        self.twins = read_twins(folder, self.wall)
        self.name = Path(study.runs[0].wall).stem
        if self.twins.ground_is_known:
            profile, distortion = self.twins.settlement[["profile", "distortion"]].iloc[0]
            # a profile from a file has no distortion
            self.name += f", {profile}" + (f" 1/{1 / distortion:.0f}" if distortion else "")
        undamaged = crack_table(
            self.twins.ends, self.twins.opening_m["none"][0], self.twins.offset_m["none"][0], LIMIT
        )
        blank = survey_of(pattern_of(undamaged, 1, 0.0), self.wall)
        self.blank = replace(blank, detection_limit_m=LIMIT, width_error_m=ERROR)
        self.seen = [
            seen_of(self.blank, self.twins.opening_m[name], self.twins.offset_m[name], self.wall)
            for name in STATES
        ]
        self.shown = claimed(self.twins, self.seen)
        self.known = np.full(self.seen[0].area.shape[1], float(offsets))
        self.pairs = pairwise(
            Seen(*map(np.concatenate, zip(*self.seen))).patterns(self.shown.ravel()),
            ERROR,
            self.known,
        )

    def answer(self, survey, left_out=None):
        """What all draws but one (index) say of a Survey on this wall."""
        mine, known = surveyed(survey, self.wall)
        away = np.array([distances(mine, one, ERROR, known) for one in self.seen])
        others = np.arange(len(self.twins)) != left_out
        kept = (self.shown & others).ravel()[self.shown.ravel()]
        strange = strange_share(away[:, others][self.shown[:, others]], self.pairs[kept][:, kept])
        weight = kernel(away, self.shown)[:, others]
        twins = some_of(self.twins, others)
        return answers(twins, Likeness(away[:, others], weight, strange), survey)


def some_of(twins, which):
    """The Twins at flags."""
    parts = {
        name: {state: values[which] for state, values in getattr(twins, name).items()}
        for name in ("opening_m", "offset_m", "fell")
    }
    return replace(twins, numbers=twins.numbers[which], **parts)


def surveyed_wall(library, state, k, rng, offsets):
    """(Survey of a draw in a state as a surveyor draws it, its CrackPattern); None where nothing is
    seen."""
    twins = library.twins
    opening = twins.opening_m[state][k].astype(float)
    offset = twins.offset_m[state][k].astype(float)
    width = np.hypot(opening, offset)
    crack = crack_numbers(cracked(width, LIMIT / 2), close_pairs(twins.ends))
    read = ERROR - STEP / 2  # the rest of the error is of rounding
    error = rng.uniform(-read, read, crack.max(initial=0) + 1)
    shown = np.where(crack > 0, np.round(np.maximum(width + error[crack], 0.0) / STEP) * STEP, 0.0)
    shown = np.where(cracked(shown, LIMIT), shown, 0.0)
    numbers = np.unique(crack[shown > 0])
    if len(numbers) > 1:
        narrow = 1 / np.array([shown[crack == one].max() for one in numbers])
        shown[crack == rng.choice(numbers, p=narrow / narrow.sum())] = 0.0
    if not shown.any():
        return None
    cracks = crack_table(twins.ends, shown, 0 * shown, LIMIT).sort_values("joint")
    pattern = pattern_of(cracks, 1, 0.0)
    joint = cracks["joint"].to_numpy()
    seen_offset = (
        cracked(np.abs(offset[joint]), LIMIT).astype(float)
        if offsets
        else np.full(len(joint), np.nan)
    )
    table = pd.DataFrame(
        {
            "joint": joint,
            "crack": cracks["crack"].to_numpy(),
            "length_m": library.wall.contacts.length[joint],
            "width_m": shown[joint],
            "offset": seen_offset,
        }
    )
    return replace(library.blank, pattern=pattern, table=table), pattern


def truth(twins, kind, k):
    """({of BUT_FOR: whether it is so}, {before, added, left: widest crack [mm]}) of a claim of a
    draw."""
    width = {name: values[k] / MILLIMETRE for name, values in twins.width_m.items()}
    now = width[CLAIMS[kind]]
    without_e, without_s = (width[TWIN[case][kind]] for case in WITHOUT)
    hidden_e, hidden_s = (
        not cracked(one * MILLIMETRE, THRESHOLD) for one in (without_e, without_s)
    )
    return dict(zip(BUT_FOR, (hidden_e, hidden_s, hidden_e and hidden_s))), {
        "before": without_e,
        "added": now - without_e,
        "left": now,
    }


def rows_of(library, of, offsets, seed):
    """A row a claim of the draws of one Library, answered from the draws of another, or from its
    own others; seed: of the survey's errors."""
    rows = []
    for k in range(len(library.twins)):
        for kind, state in CLAIMS.items():
            if library.twins.fell[state][k]:
                continue
            rng = np.random.default_rng([seed, int(library.twins.numbers[k]), ord(kind)])
            drawn = surveyed_wall(library, state, k, rng, offsets)
            if drawn is None:
                continue
            row = {
                "wall": library.name,
                "asked_of": of.name,
                "life": int(library.twins.numbers[k]),
                "kind": kind,
            }
            try:
                survey = (
                    drawn[0]
                    if of is library
                    else replace(
                        survey_of(drawn[1], of.wall), detection_limit_m=LIMIT, width_error_m=ERROR
                    )
                )
            except InputError:
                rows.append(row | {"reasons": "refused"})
                continue
            found = of.answer(survey, k if of is library else None)
            cracks = judged_cracks(found, library.twins, drawn[0].table, kind, k)
            rows.append(row | judged(found, *truth(library.twins, kind, k)) | cracks)
    return pd.DataFrame(rows)


def judged_cracks(found, twins, table, kind, k):
    """Numbers of cracks of a claim, and by each cause left out how many have an answer, and a wrong
    one; table: of the Survey on its own wall."""
    counts = {"cracks": table["crack"].nunique()}
    for case in WITHOUT:
        said = {
            one["crack"]: one[case]["said"]
            for one in found["cracks"]
            if one[case]["said"] != "open"
        }
        wrong = 0
        for label, joints in table.groupby("crack")["joint"]:
            width_m = twins.widest_of(joints.to_numpy())[TWIN[case][kind]][k]
            of = said.get(str(label))
            wrong += of is not None and (of == "yes") != bool(cracked(width_m, THRESHOLD))
        counts |= {f"said_{case}": len(said), f"wrong_{case}": wrong}
    return counts


def judged(found, but_for, width):
    """A claim's row: reasons for no answer, verdicts and whether they are wrong, widths in their
    intervals."""
    row = {
        "reasons": " ".join(one["why"] for one in found["no_answer"]),
        "strange": found["stranger_than"],
        "draws": min(found["effective_draws"].values()),
    }
    for name in BUT_FOR:
        said = found["verdict"][name]
        row |= {
            name: but_for[name],
            f"said_{name}": said,
            f"wrong_{name}": said != "open" and (said == "yes") != but_for[name],
        }
    for prior in map(str, PRIORS):
        row[f"p_{prior}"] = found["like_survey"][prior]["not_without_earthquakes"]["share"]
        for what, true in width.items():
            for table in ("like_survey", "all_draws"):
                three = found["crack_width_mm"][prior][table][what]
                row[f"{table}_{what}_{prior}"] = (
                    three and three[0] - 1e-9 <= true <= three[2] + 1e-9
                )
    return row


def coverage(rows, column):
    """Shares of claims by prior, those of B with the prior's probability, E with the rest:
    words."""
    shares = []
    for prior in PRIORS:
        of = {
            kind: rows.loc[rows["kind"] == kind, f"{column}_{prior}"].dropna().astype(float)
            for kind in "BE"
        }
        shares.append(
            f"{prior * of['B'].mean() + (1 - prior) * of['E'].mean():.2f}"
            if all(map(len, of.values()))
            else "-"
        )
    return ", ".join(shares)


def print_calibration(one, rows):
    """Rows of what the sheet states beside what was so, of claims of B and E, and a row on the
    number of draws."""
    mine = rows[rows["kind"].isin(["B", "E"])]
    said = mine["p_0.5"].astype(float)
    so = mine["not_without_earthquakes"].astype(float)
    for low, high in zip(BINS, BINS[1:]):
        inside = (said > low - (low == 0)) & (said <= high)
        if inside.any():
            print_row(
                one.name,
                f"{100 * low:g} to {100 * high:g}",
                int(inside.sum()),
                round(100 * said[inside].mean()),
                round(100 * so[inside].mean()),
            )
    resemble = (rows["draws"] / len(one.twins)).astype(float)
    print(
        f"{one.name}: {100 * resemble.median():.0f} % of the draws resemble a survey (median; 5 %"
        f" of claims: below {100 * resemble.quantile(0.05):.0f} %); of claims without {LEAST_DRAWS}"
        f" of 400 draws {100 * (400 * resemble < LEAST_DRAWS).mean():.0f} %",
        file=sys.stderr,
    )


def print_cracks(rows, title):
    """Rows of the table of cracks, by kind of claim."""
    for kind, mine in rows.groupby("kind"):
        names = ["cracks", *(f"{what}_{case}" for case in WITHOUT for what in ("said", "wrong"))]
        print_row(title, kind, *(int(mine[name].sum()) for name in names))


def print_rows(rows, title):
    """Rows of the table of one set of claims, by kind."""
    said = wrong = 0
    for kind in CLAIMS:
        mine = rows[rows["kind"] == kind]
        if not len(mine):
            continue
        counts = [
            int(mine["reasons"].str.contains(why).sum())
            for why in ("refused", "draws", "strange", "small")
        ]
        answered = mine[mine["reasons"] == ""]
        names = [name for name in BUT_FOR if f"said_{name}" in answered]
        counts += [
            sum(int((answered[f"said_{name}"] != "open").sum()) for name in names),
            sum(int(answered[f"wrong_{name}"].astype(bool).sum()) for name in names),
        ]
        print_row(title, kind, len(mine), int((mine["reasons"] != "").sum()), *counts)
        said = said + counts[-2]
        wrong = wrong + counts[-1]
    if said:
        bound = binomtest(wrong, said, alternative="less").proportion_ci(0.95).high
        print(
            f"{title}: {wrong} of {said} answers wrong, at most {100 * bound:.1f} %",
            file=sys.stderr,
        )


def _named(one, other, asked_of=""):
    """The name of a Library with the number of draws that it is asked of, of another's if given."""
    return f"{one.name}{asked_of} ({len((other or one).twins)} draws)"


def main():
    asked = arguments(
        __doc__,
        option("claims", nargs="+", type=Path),
        option("--asked-of", type=Path),
        option("--offsets", action="store_true"),
        option("--surveyors", type=int, default=1),
        option("--rows", type=Path),
    )
    libraries = [Library(folder, asked.offsets) for folder in asked.claims]
    other = asked.asked_of and Library(asked.asked_of, asked.offsets)
    seeds = range(1, asked.surveyors + 1)
    tables = [
        pd.concat([rows_of(one, other or one, asked.offsets, seed) for seed in seeds])
        for one in libraries
    ]
    if asked.rows:
        pd.concat(tables).to_csv(asked.rows, index=False)
    print_table(
        "wall",
        "claim",
        "claims",
        "no answer",
        "refused",
        f"below {LEAST_DRAWS} draws",
        "strange",
        "small",
        "answers",
        "wrong",
    )
    for one, rows in zip(libraries, tables):
        print_rows(rows, _named(one, other, f" asked of {other.name}" if other else ""))
    print()
    answers = (
        f"{what} {case.replace('_', ' ')}" for case in WITHOUT for what in ("answers", "wrong")
    )
    print_table("wall", "claim", "cracks", *answers)
    for one, rows in zip(libraries, tables):
        if "cracks" in rows:
            print_cracks(rows.dropna(subset="cracks"), _named(one, other))
    print()
    columns = list(product(("before", "added", "left"), ("like_survey", "all_draws")))
    print_table("wall", *(f"{what}: {table.replace('_', ' ')}" for what, table in columns))
    for one, rows in zip(libraries, tables):
        if "draws" in rows:
            print_row(
                _named(one, other),
                *(coverage(rows, f"{table}_{what}") for what, table in columns),
            )
    print()
    print_table("wall", "stated of 100", "claims", "mean stated", "true of 100")
    for one, rows in zip(libraries, tables):
        if "draws" in rows:
            print_calibration(other or one, rows)
