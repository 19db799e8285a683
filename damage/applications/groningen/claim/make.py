"""Make a claim's sheet: checks, draws until the intervals are narrow enough, numbers, sheet."""

from pathlib import Path
from typing import NamedTuple

from damage.applications.cracks.survey import on_joints, read_survey
from damage.applications.groningen.claim.numbers import MOST_DRAWS, enough, numbers_of
from damage.applications.groningen.claim.sheet import (
    NUMBERS,
    SHEET,
    outside_at_rest,
    sheet,
    whether_more_draws_help,
)
from damage.applications.groningen.claim.terminal import describe, no_answer_foreseen, state_runs
from damage.applications.groningen.claim.twins import (
    BOTH,
    DRAWN,
    NAME,
    SHAKEN,
    causes_of,
    twins_of,
    twins_study,
)
from damage.applications.groningen.exposure.lives import draws_of
from damage.applications.studies.folder import while_locked
from damage.arguments import fraction
from damage.errors import InputError, some_of, warn
from damage.files import json_text, write_text
from damage.history.reader import read_history
from damage.house.coarser import coarser
from damage.house.drawn import drawn, ranges
from damage.run.options import settings_of
from damage.wall.as_built import warn_of_courses
from damage.wall.file import load_wall, wall_path
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions

STEPS = 10, 96, 192, 400, MOST_DRAWS
"""Numbers of draws after which there is a sheet: the first ones show what it will be of; 96 is what
an interval of ±10 of 100 takes."""


class Claim(NamedTuple):
    """What a claim is about: wall: its file, or the name of one that ships; address: {key of
    `damage.applications.groningen.exposure.lives.KEYS`: value}; survey: the file of cracks;
    options: of each run; settlement: options of a settlement of known shape and size, {} for none
    that is known; draws: their number, None for as many as the intervals or an answer need;
    language: of the sheet; units: bricks and courses of a unit (`damage.house.coarser`)."""

    wall: str
    address: dict
    survey: Path
    options: dict
    settlement: dict
    draws: int | None
    language: str
    units: tuple[int, int]


def make_claim(claim, out, jobs, remake):
    """Make the sheet of a Claim in a folder with so many processes; returns the exit status.
    Raises InputError.

    remake: draws of another version, which are refused otherwise.
    """
    out = Path(out).absolute()
    steps = steps_to(claim.draws)
    units = {"units": list(claim.units)} if claim.units != (1, 1) else {}
    causes = causes_of(claim.address, claim.options | units, claim.settlement)
    draws_by = {cause: draws_of(address) for cause, (address, _) in causes.items()}
    exposure = draws_by[SHAKEN].exposure
    draws_by[SHAKEN].life(1)  # says what is wrong before anything is written
    layout = layout_of(claim.wall, claim.units)
    settled = settings_of(claim.settlement, "", "reference").settlement
    if settled is not None:
        settled.check_length(layout.wall.length)
    survey = read_survey(claim.survey, layout)
    warn(
        *warn_of_courses(layout.plan),
        *exposure.warnings,
        *survey.notes,
        *no_answer_foreseen(survey, steps[-1]),
    )
    print(on_joints(survey.as_dict()), outside_at_rest(layout, claim.language), sep="\n")
    with while_locked(out, Path(NAME).stem) as lock:
        state_runs(twins_study(out, claim.wall, causes, steps[0]), steps)
        for draws in steps:
            study = twins_study(out, claim.wall, causes, draws)
            if status := _draw(study, out, jobs, remake, lock):
                return status
            begun = next(run for run in study.runs if run.entry == BOTH)
            first = read_history(out / "runs" / f"{begun.name(1)}.h5")
            model = first.model
            if first.masonry_wall != drawn(layout.wall, ranges(model.inputs), model.strength_seed):
                raise InputError(
                    f"{claim.wall} changed since this claim began: expected the wall that its"
                    " cracks were put on; give the same command again"
                )
            twins = twins_of(study, draws_by, out, layout)
            given = claim.address | claim.options | {"units": claim.units}
            numbers = numbers_of(
                twins,
                survey,
                layout,
                exposure,
                choices=given,
                settlement=_ground(claim),
                first=first,
            )
            done = draws == steps[-1] or (not claim.draws and enough(numbers, steps[-1]))
            numbers["draws_to_come"] = None if done else steps[-1]
            numbers["more_draws"] = whether_more_draws_help(numbers, claim.language)
            write_text(out / NUMBERS, json_text(numbers, indent=1) + "\n")
            text = sheet(numbers, layout, survey, twins, language=claim.language, json_name=NUMBERS)
            place = write_text(out / SHEET, text)
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
    from damage.applications.studies.batch import run
    from damage.applications.studies.outdated import Results

    others = Results(out).judge(study.runs).models
    if others and not remake:
        raise InputError(
            f"{out}: another version of the model ({', '.join(sorted(set(others.values())))}) made"
            f" {len(others)} runs: {some_of(list(others))}; expected one version on a sheet; give"
            " --remake to make these again, or another --out"
        )
    return run(study, out, jobs, "patterns", remake=remake, lock=lock)


def layout_of(wall, units=(1, 1)):
    """Layout of a claim's wall: its file, or the name of one that ships; in units of so many bricks
    and courses."""
    return lay_out(coarser(load_wall(wall_path(wall)), *units), ModelOptions(supports="bricks"))


def _ground(claim):
    """The settlement that was taken, fit for JSON."""
    if not claim.settlement:
        return {"drawn": list(DRAWN[0]), "distortion": list(DRAWN[1])}
    distortion = claim.settlement.get("distortion")
    return {
        "profile": Path(str(claim.settlement["settle"])).name,
        "distortion": None if distortion is None else fraction(str(distortion)),
    }
