"""Make a claim's sheet: checks, draws until the intervals are narrow enough, numbers, sheet."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from damage.applications.cracks.survey import on_joints, read_survey
from damage.applications.groningen.claim.answer import LEAST_DRAWS, WITHOUT, reasons
from damage.applications.groningen.claim.numbers import MOST_DRAWS, enough, numbers_of
from damage.applications.groningen.claim.sheet import (
    NUMBERS,
    SHEET,
    in_words,
    outside_at_rest,
    sheet,
    whether_more_draws_help,
)
from damage.applications.groningen.claim.twins import (
    BOTH,
    DRAWN,
    NAME,
    SHAKEN,
    read_twins,
    write_twins,
)
from damage.applications.groningen.exposure.lives import draws_of, read_address
from damage.applications.report.words import words
from damage.applications.studies.cost import size_of as size_of_run
from damage.applications.studies.definition import load_study
from damage.applications.studies.folder import ROOT, held
from damage.arguments import fraction
from damage.errors import InputError, some_of, warn
from damage.files import json_text, write_text
from damage.history.reader import read_history
from damage.house.coarser import coarser
from damage.house.drawn import drawn, ranges
from damage.measure.evidence import evidence_for, names_outside
from damage.measure.summary import summarise
from damage.run.options import settings_of
from damage.wall.as_built import warn_of_courses
from damage.wall.file import load_wall, wall_path
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions

STEPS = 10, 96, 192, 400, MOST_DRAWS
"""Numbers of draws after which there is a sheet: the first ones show what it will be of; 96 is what
an interval of ±10 of 100 takes."""

USUAL = {"within_km": 3.5, "strong": (0.05, 0.15), "above_mm_s": 8.0}
"""Keys of a claim's address where nothing is given."""
USUAL_OPTIONS = {"rest": 0.2, "strength-cov": 0.3, "inputs": "typical"}
"""Options of a claim's runs where nothing is given."""


@dataclass(frozen=True)
class Claim:
    """What a claim is about: wall: its file, or the name of one that ships; address: {key of
    `damage.applications.groningen.exposure.lives.KEYS`: value}; survey: the file
    of cracks; options: of each run; settlement: options of a settlement of known shape and size, {}
    for none that is known; draws: their number, None for as many as the intervals or an answer
    need; language: of the sheet; units: bricks and courses of a unit (`damage.house.coarser`)."""

    wall: str
    address: dict
    survey: Path
    options: dict = field(default_factory=dict)
    settlement: dict = field(default_factory=dict)
    draws: int | None = None
    language: str = "en"
    units: tuple[int, int] = (1, 1)


def make_claim(claim, out, jobs, remake=False):
    """Make the sheet of a Claim in a folder with so many processes; returns the exit status.
    Raises InputError.

    remake: draws of another version, which are refused otherwise.
    """
    out = Path(out).absolute()
    steps = steps_to(claim.draws)
    drawn_from = draws_of(claim.address)
    drawn_from.life(1)  # says what is wrong before anything is written
    layout = layout_of(claim.wall, claim.units)
    settled = settings_of(claim.settlement, "", "reference").settlement
    if settled is not None:
        settled.check_length(layout.wall.length)
    survey = read_survey(claim.survey, layout)
    warn(
        *warn_of_courses(layout.plan),
        *drawn_from.exposure.warnings,
        *survey.notes,
        *_no_answer_foreseen(survey, steps[-1]),
    )
    print(on_joints(survey.as_dict()), outside_at_rest(layout, claim.language), sep="\n")
    with held(out, Path(NAME).stem) as lock:
        begun = _study(claim, out, steps[0])
        _state_runs(begun, steps)
        for draws in steps:
            study = _study(claim, out, draws)
            if status := _draw(study, out, jobs, remake, lock):
                return status
            first = _first(out, study)
            model = first.model
            if first.masonry_wall != drawn(layout.wall, ranges(model.inputs), model.strength_seed):
                raise InputError(
                    f"{claim.wall} changed since this claim began: expected the wall that its"
                    " cracks were put on; give the same command again"
                )
            twins = read_twins(out, layout)
            given = claim.address | claim.options | {"units": claim.units}
            exposure = read_address(out / f"{SHAKEN}.address.toml").exposure  # that the runs have
            numbers = numbers_of(
                twins,
                survey,
                layout,
                exposure,
                given,
                _ground(claim),
                _evidence(first, twins.outside),
            )
            done = draws == steps[-1] or (not claim.draws and enough(numbers, steps[-1]))
            numbers["draws_to_come"] = None if done else steps[-1]
            numbers["more_draws"] = whether_more_draws_help(numbers, claim.language)
            write_text(out / NUMBERS, json_text(numbers, indent=1) + "\n")
            place = write_text(
                out / SHEET, sheet(numbers, layout, survey, twins, claim.language, NUMBERS)
            )
            if done:
                break
            notes = [f"{draws} draws, not yet the answer: {place}", numbers["more_draws"]]
            print(*filter(None, notes), sep="\n", flush=True)
    print(describe(numbers, claim.language), place, sep="\n")
    return 0


def steps_to(draws):
    """Numbers of draws after which there is a sheet: STEPS; where a number of draws is asked for,
    those of STEPS up to half of it, then that number."""
    return (*(step for step in STEPS if step <= draws / 2), draws) if draws else STEPS


def _draw(study, out, jobs, remake, lock):
    """Make the draws of a claim's study; returns the exit status.  Raises InputError where there
    are some of another model that are not to be made again."""
    from damage.applications.studies.command import run_study
    from damage.applications.studies.outdated import Results

    others = Results(out).judge(study.runs).models
    if others and not remake:
        raise InputError(
            f"{out}: another version of the model ({', '.join(sorted(set(others.values())))}) made"
            f" {len(others)} runs: {some_of(list(others))}; expected one version on a sheet; give"
            " --remake to make these again, or another --out"
        )
    return run_study(
        [
            str(study.path),
            "--out",
            str(out),
            "--keep",
            "patterns",
            "-j",
            str(jobs),
            *(["--remake"] if remake else []),
        ],
        lock,
    )


def layout_of(wall, units=(1, 1)):
    """Layout of a claim's wall: its file, or the name of one that ships; in units of so many bricks
    and courses."""
    return lay_out(coarser(load_wall(wall_path(wall)), *units), ModelOptions(supports="bricks"))


def _no_answer_foreseen(survey, most):
    """Sentences on what forbids an answer whatever the runs give; most: draws that are asked
    for."""
    words = {
        "draws": (
            f"--draws {most}: the sheet will have no answer, for which {LEAST_DRAWS} draws have to"
            f" resemble the survey; leave --draws out for up to {STEPS[-1]}"
        ),
        "off_joints": (
            "the sheet will have no answer: more than a fifth of the drawn length lies on no joint"
        ),
        "small": "the sheet will have no answer: no surveyed crack is wide enough to be visible",
    }
    return [words[why] for why, _ in reasons(survey.as_dict(), most, 0.0)]


def _state_runs(study, steps):
    """Print the size of the first draws, and of the most that may follow, before anything
    starts."""
    size = "expected: {contact_points} contact points x {steps:.2g} steps".format(**size_of(study))
    print(
        *(
            f"{size} x {draws} draws"
            for draws in dict.fromkeys((steps[min(1, len(steps) - 1)], steps[-1]))
        ),
        f"An answer needs {LEAST_DRAWS} draws that resemble the survey.  The same command continues"
        " after an interruption.",
        sep="\n",
        flush=True,
    )


def size_of(study):
    """{"contact_points" of the wall, "steps" of a draw by both of its runs} of a claim's study."""
    points, steps, _ = zip(*(size_of_run(run) for run in study.runs if run.offset == 0))
    return {"contact_points": points[0], "steps": sum(steps)}


def _study(claim, out, draws):
    """The Study of so many draws, whose file is written into a folder."""
    options = claim.options | ({"units": list(claim.units)} if claim.units != (1, 1) else {})
    path = write_twins(out, claim.wall, claim.address, options, claim.settlement, draws)
    return load_study(path, "reference", ROOT)


def _ground(claim):
    """The settlement that was taken, fit for JSON."""
    if not claim.settlement:
        return {"drawn": list(DRAWN[0]), "distortion": list(DRAWN[1])}
    distortion = claim.settlement.get("distortion")
    return {
        "profile": Path(str(claim.settlement["settle"])).name,
        "distortion": None if distortion is None else fraction(str(distortion)),
    }


def _first(out, study):
    """History of the first draw by both causes."""
    first = next(run for run in study.runs if run.point.startswith(BOTH))
    return read_history(out / "runs" / f"{first.name(1)}.h5")


def _evidence(history, outside):
    """Judgement of the range of validity on a history, with the share of all runs that are outside;
    outside: of Twins."""
    evidence = evidence_for(history.masonry_wall, history.parameters, summarise(history))
    runs = list(map(names_outside, outside))
    for name, quantity in evidence.items():
        quantity["outside_share"] = float(np.mean([name in of for of in runs]))
        if quantity["outside_share"]:
            quantity["inside"] = False
    return evidence


def _crack_in_words(crack):
    """A line on a crack of `damage.applications.groningen.claim.answer.of_cracks`."""
    cases = (
        f"{case.replace('_', ' ')}: {words('en', 'there_' + crack[case]['said'])}"
        for case in WITHOUT
    )
    return f"crack {crack['crack']} ({crack['width_mm']:.2g} mm) would be there " + ", ".join(cases)


def describe(numbers, language="en"):
    """The answer in a few lines of text, its sentences in a language."""
    lines = [
        f"{numbers['draws']} draws, effective number by priors of settlement "
        + ", ".join(f"{prior}: {value:.0f}" for prior, value in numbers["effective_draws"].items())
    ]
    sentences = in_words(numbers, language)
    lines += [f"no answer: {reason}" for reason in sentences["why"]] or [
        *sentences["answer"],
        *map(_crack_in_words, numbers["cracks"]),
    ]
    lines += [f"would help: {sentence}" for sentence in sentences["helps"]]
    return "\n".join(filter(None, [*lines, numbers["more_draws"]]))
