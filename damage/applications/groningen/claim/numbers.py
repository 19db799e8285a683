"""Every number of the sheet, as one table that JSON holds."""

from datetime import UTC, datetime
from math import isnan
from typing import NamedTuple

import numpy as np

from damage.applications.cracks.survey import Seen, distances, seen_of, surveyed
from damage.applications.groningen.claim.answer import (
    BUT_FOR,
    LEAST_DRAWS,
    PRIORS,
    effective,
    of_cracks,
    reasons,
    table,
    verdict,
    widths,
    worlds_of,
)
from damage.applications.groningen.claim.likeness import (
    FARTHEST,
    KERNEL,
    STATES,
    kernel,
    pairwise,
    strange_share,
)
from damage.applications.groningen.claim.twins import SHAKEN
from damage.applications.groningen.exposure.exposure import strongest
from damage.measure.evidence import evidence_for, names_outside
from damage.measure.summary import summarise
from damage.provenance import commit
from damage.version import VERSION

SHOWN_EVENTS = 5
SHOWN_NEAREST = 3
ENOUGH = 0.1
"""Half-width of the widest interval of the first table up to which no more draws are asked for
[-]."""
MOST_DRAWS = 800
"""Draws of a claim at most, where no number is asked for."""
HOPE = 2.0
"""`draws_needed`, an estimate to within about half, is out of reach above HOPE times the most
draws."""


class Likeness(NamedTuple):
    """Likeness of a survey and twins: away: distances (2, n) of STATES, infinite of what is in no
    claim; weight: (2, n); strange: share of visible patterns that are less strange than the survey
    [-]."""

    away: np.ndarray
    weight: np.ndarray
    strange: float


def likeness_of(twins, survey, wall):
    """The Likeness of a damage.applications.cracks.survey.Survey on the Layout wall."""
    mine, known = surveyed(survey, wall)
    seen = [seen_of(survey, twins.opening_m[name], twins.offset_m[name], wall) for name in STATES]
    away = np.array([distances(mine, life, survey.width_error_m, known) for life in seen])
    shown = claimed(twins, seen)
    pairs = pairwise(
        Seen(*map(np.concatenate, zip(*seen))).patterns(shown.ravel()), survey.width_error_m, known
    )
    strange = strange_share(away[shown], pairs)
    return Likeness(np.where(shown, away, np.inf), kernel(away, shown), strange)


def claimed(twins, seen):
    """Whether walls stand with visible cracks (2, n), of Seen of STATES: others are in no claim."""
    cracked = np.array([life.length.sum(axis=1) > 0 for life in seen])
    return cracked & ~np.array([twins.fell[name] for name in STATES])


def answers(twins, likeness, survey):
    """What twins say by the Likeness of a Survey: tables, widths, verdict, cracks, and reasons for
    no answer, where everything is open.  Of those that resemble it counts what lies where it
    looked."""
    away, like, strange = likeness
    known = survey.as_dict()
    seen_m = twins.widest_of(survey.looked_at)
    first = {}
    second = {}
    wide = {}
    number = {}
    for prior in map(str, PRIORS):
        every = worlds_of(twins.width_m, float(prior))
        worlds = worlds_of(seen_m, float(prior), like)
        first[prior] = table(every)
        second[prior] = table(worlds)
        number[prior] = effective(worlds.weight)
        wide[prior] = {
            "all_draws": widths(every),
            "like_survey": widths(worlds, known["max_width_mm"], known["width_error_mm"]),
        }
    nearest = np.argsort(away.ravel(), kind="stable")[:SHOWN_NEAREST]
    why = reasons(known, min(number.values()), strange)
    return {
        "draws": len(twins),
        "kernel": KERNEL,
        "farthest": FARTHEST,
        "all_draws": first,
        "like_survey": second,
        "effective_draws": number,
        "crack_width_mm": wide,
        "stranger_than": strange,
        "verdict": dict.fromkeys(BUT_FOR, "open") if why else verdict(second),
        "cracks": of_cracks(twins, like, survey, answered=not why),
        "no_answer": [{"why": code, "value": value} for code, value in why],
        "nearest": [
            {
                "life": int(twins.numbers[place % len(twins)]),
                "state": STATES[place // len(twins)],
                "distance": away.ravel()[place],
            }
            for place in nearest
            if np.isfinite(away.ravel()[place])
        ],
    }


def enough(numbers, most):
    """Whether to stop; most: draws that are made at most.  The intervals of the first table are
    narrow, and an answer does not lack draws alone, or those that it lacks are out of reach."""
    rows = [row for draws in numbers["all_draws"].values() for row in draws.values()]
    narrow = all(row["share"] is None or (row["high"] - row["low"]) / 2 <= ENOUGH for row in rows)
    return narrow and not (lacks_draws(numbers) and draws_needed(numbers) <= HOPE * most)


def lacks_draws(numbers):
    """Whether the number of draws is all that forbids an answer."""
    return [entry["why"] for entry in numbers["no_answer"]] == ["draws"]


def draws_needed(numbers):
    """Draws by which LEAST_DRAWS would resemble the survey, in proportion to those that do now."""
    like = min(numbers["effective_draws"].values())
    return LEAST_DRAWS * numbers["draws"] / like if like > 0 else np.inf


def largest_share(draws):
    """Upper 95 % bound of the share of draws that resemble a survey where none of so many does [-].

    >>> round(largest_share(10), 2), round(largest_share(96), 2)
    (0.26, 0.03)
    """
    return 1 - 0.05 ** (1 / draws)


def shaking(exposure, twins):
    """`Exposure.as_dict` with the SHOWN_EVENTS events of the largest median PGV alone, what each
    adds to Psi on ground at rest, a mean over the draws, and the number of all events."""
    numbers = exposure.as_dict()
    shaken = twins.events[SHAKEN]
    gain = shaken["psi"] - shaken.groupby("life")["psi"].shift(fill_value=0.0)
    gains = gain.groupby(shaken["id"]).sum() / shaken["life"].nunique()
    events = [
        event | {"mean_psi_added": gains.get(event["id"], 0.0)}
        for event in strongest(numbers, SHOWN_EVENTS)
    ]
    return numbers | {"n_events": len(numbers["events"]), "events": events}


def evidence_of(history, outside):
    """Judgement of the range of validity on a history, with the share of all runs that are outside;
    outside: of Twins."""
    evidence = evidence_for(history.masonry_wall, history.parameters, summarise(history))
    runs = list(map(names_outside, outside))
    for name, quantity in evidence.items():
        quantity["outside_share"] = float(np.mean([name in names for names in runs]))
        if quantity["outside_share"]:
            quantity["inside"] = False
    return evidence


def numbers_of(twins, survey, wall, exposure, choices, settlement, first):
    """Every number of the sheet, fit for JSON.

    wall: Layout; exposure: damage.applications.groningen.exposure.exposure.Exposure; choices: of
    `damage.applications.groningen.exposure.lives.Choices`, how motions are chosen; settlement:
    {"profile", "distortion"} that was given, {"drawn": profiles, "distortion": bounds} otherwise;
    first: History of the first draw by both causes.
    """
    events = twins.events[SHAKEN]
    offsets = survey.table["offset"].notna().any() if len(survey.table) else False
    known = {
        "offsets_known": bool(offsets),
        "detection_limit_known": not isnan(survey.pattern.detection_limit_m),
        "share_looked_at": survey.looked_at.mean(),
    }
    return {
        "house": wall.wall.name,
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "made_by": {"software": VERSION, "commit": commit(), "draws": twins.made_by},
        "shaking": shaking(exposure, twins),
        "settlement": settlement,
        "choices": choices,
        "survey": survey.as_dict() | known,
        "priors": list(PRIORS),
        **answers(twins, likeness_of(twins, survey, wall), survey),
        "fell": {name: int(walls.sum()) for name, walls in twins.fell.items()},
        "events_per_draw": len(events) / events["life"].nunique(),
        "evidence": evidence_of(first, twins.outside),
    }
