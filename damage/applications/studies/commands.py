"""Commands about studies: run them, what they write, fragility."""

import os
import re
from argparse import ArgumentTypeError

from damage.applications.studies.read import made_by_words
from damage.arguments import arg, file_arg, flag, group, number_from
from damage.commands.table import STYLE, command, out, output, save, tables
from damage.errors import warn
from damage.files import json_text
from damage.measure.tables import write_table
from damage.provenance import shown_path


def _slice(word):
    match = re.fullmatch(r"([1-9]\d{0,4})/([1-9]\d{0,4})", word)
    if not match or int(match[1]) > int(match[2]):
        raise ArgumentTypeError(f"{word}: expected K/N with K from 1 to N, as 2/8; correct it")
    return int(match[1]), int(match[2])


def _solver(help_, default):
    return arg("--solver", help_, choices=("yade", "reference", "both"), default=default)


STUDY_OPTIONS = (
    arg(
        "-j",
        "simulations at a time (default: one for each core)",
        "N",
        number_from(1, 9999, int),
        dest="jobs",
        default=os.cpu_count(),
    ),
    file_arg("--out", "DIR", "where everything goes (default results/NAME)"),
    _solver("what simulates (default reference)", "reference"),
    arg(
        "--keep",
        "histories: all (default); summary: those of each point's first run, and what failed;"
        " patterns: these, and of every run openings, offsets and displacements at rest, some kB"
        " each",
        choices=("all", "summary", "patterns"),
        default="all",
    ),
    flag("--dry-run", "make nothing: list the runs that are there and those to make"),
    flag("--remake", "make runs again that another version made"),
    arg(
        "--slice",
        "the K-th of N parts alone, without tables of the whole study: a job of a cluster",
        "K/N",
        _slice,
    ),
)
"""Options of every command that runs studies."""


@command(
    "run a study: simulations, tables, pictures; what is done is not done again",
    arg("study", "a study file (.toml), or the name of one that ships", "STUDY"),
    *STUDY_OPTIONS,
    examples=("quick", "my_study.toml -j 4 --keep summary --out mine"),
)
def _study(asked):
    from damage.applications.studies.command import run_one, study_path

    return run_one(asked, study_path(asked.study))


@command(
    "the tables of a study, from the runs that exist so far",
    file_arg("study", "STUDY.toml"),
    file_arg("folder", "DIR", "the study's folder; tables go to DIR/tables"),
    _solver("whose runs the study names (default both)", "both"),
    file_arg("--root", "DIR", "where walls and records lie (default: the working folder)"),
    examples=(
        "studies/quick.toml results/quick",
        "my_study.toml results/my_study --solver reference",
    ),
)
def _study_tables(asked):
    from damage.applications.studies.definition import load_study
    from damage.applications.studies.plan import unfinished
    from damage.applications.studies.tables import write_study_tables

    study = load_study(asked.study, asked.solver, asked.root)
    print(*write_study_tables(study, asked.folder), sep="\n")
    warn(*filter(None, [unfinished(asked.folder)]))


@command(
    "the JSON Schema of study files, by which editors complete and check them: put it beside yours,"
    " and '#:schema ./study.schema.json' on its first line",
    examples=("> study.schema.json", "| less"),
)
def _study_schema(asked):
    from damage.applications.studies.schema import study_schema

    print(json_text(study_schema(), indent=1))


@command(
    "probabilities of exceeding levels of damage, from a study with scattered strengths",
    file_arg("study", "STUDY_DIR", "folder of a study, as results/fragility"),
    group(
        "intensity and damage",
        arg(
            "--intensity",
            "column of summary.csv with a number above zero in "
            "every run (default: that of the study file, else sa_eigen_period_g; PGA is "
            "record_pga_g, one value for all walls)",
            "COLUMN",
        ),
        arg(
            "--state",
            'damage state, a column of summary.csv and the level that it exceeds, as "moderate:'
            ' max_psi > 2"; may be repeated (default: those of the study file, else levels of'
            " DI, crack width and Psi)",
            "STATE",
            action="append",
            dest="states",
        ),
        arg(
            "--at",
            "also print the probability at these intensities, with its intervals",
            "X",
            number_from(1e-12, 1e12),
            nargs="+",
        ),
        arg(
            "--replicates",
            "bootstrap samples (default 500)",
            "N",
            number_from(0, 100_000, int),
            default=500,
        ),
    ),
    out("folder for tables and pictures"),
    STYLE,
    output(
        file_arg(
            "--export",
            "DIR",
            "folder for the curves in other tools' formats: NRML (OpenQuake), a CSV of "
            "coefficients with units",
        )
    ),
    examples=(
        "results/fragility --out curves",
        'results/fragility --intensity record_pga_g --state "moderate: max_psi > 2" --out curves',
    ),
)
def _fragility(asked):
    from damage.applications.studies.curves import write_curves
    from damage.applications.studies.fragility import (
        at_intensities,
        choices_of,
        fit_all,
        fragility_table,
        in_words,
        mixed,
    )
    from damage.applications.studies.fragility_picture import fragility_pictures
    from damage.applications.studies.plan import unfinished

    runs, intensity, states = choices_of(asked.study, asked.intensity, asked.states)
    warn(*filter(None, [unfinished(asked.study)]), *mixed(runs))
    fits = fit_all(runs, intensity, asked.replicates, states)
    for line in write_curves(runs, fits, asked.export) if asked.export else ():
        print(line)
    print(in_words(fits))
    table = fragility_table(fits).assign(slip="displacement")
    print(write_table(table, asked.out / f"fragility_{intensity}.csv"))
    if asked.at:
        table = at_intensities(fits, asked.at)
        print(table.to_string(index=False, float_format="%.3f", na_rep="-"))
        print(
            "new_record_low, _median, _high: of a new record's own probability; new_record: its"
            " mean, which may lie outside, where few records do most of the damage"
        )
        print(write_table(table, asked.out / f"fragility_{intensity}_at.csv"))
    save(
        fragility_pictures(runs, fits),
        asked.out,
        f"study {shown_path(asked.study)}; {made_by_words(runs)}",
    )


@tables
def _tables():
    from damage.applications.studies.columns import TABLES

    return TABLES
