"""Commands about studies: run them, what they write, fragility."""

from damage.commands.table import command, out, program, save, tables
from damage.errors import InputError, warn
from damage.files import json_text
from damage.measure.columns import made_by_words
from damage.measure.tables import write_table
from damage.provenance import shown_path
from damage.run.options import arg, file_arg, flag, group, number_from

WRITERS = []
"""Functions of the options of `fragility`, the runs, their fits and the intensity, which write the
curves in other formats and print where; applications add theirs."""


@program("run a study: simulations, tables and pictures (see study --help)")
def _study(words, quiet):
    from damage.applications.studies.command import run_study

    return run_study(words)


@command(
    "the tables of a study, from the runs that exist so far",
    file_arg("study", "STUDY.toml"),
    file_arg("folder", "DIR", "the study's folder; tables go to DIR/tables"),
    arg(
        "--solver",
        choices=("yade", "reference", "both"),
        default="both",
        help="whose runs the study names (default both)",
    ),
    file_arg("--root", "DIR", "where walls and records lie (default: the working folder)"),
    arg(
        "-j",
        dest="jobs",
        type=number_from(1, 1000, int),
        default=1,
        metavar="N",
        help="processes (default 1)",
    ),
    examples=(
        "studies/quick.toml results/quick",
        "my_study.toml results/my_study --solver reference -j 4",
    ),
)
def _study_tables(asked):
    from damage.applications.studies.definition import load_study
    from damage.applications.studies.plan import unfinished
    from damage.applications.studies.tables import write_study_tables

    print(
        *write_study_tables(
            load_study(asked.study, asked.solver, asked.root), asked.folder, asked.jobs
        ),
        sep="\n",
    )
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
            metavar="COLUMN",
            help=(
                "column of summary.csv with a number above zero in "
                "every run (default: that of the study file, else sa_eigen_period_g; PGA is "
                "record_pga_g, one value for all walls)"
            ),
        ),
        arg(
            "--state",
            action="append",
            dest="states",
            metavar="STATE",
            help=(
                'damage state, a column of summary.csv and the level that it exceeds, as "moderate:'
                ' max_psi > 2"; may be repeated (default: those of the study file, else levels of'
                " DI, crack width and Psi)"
            ),
        ),
        arg(
            "--at",
            type=number_from(1e-12, 1e12),
            nargs="+",
            metavar="X",
            help="also print the probability at these intensities, with its intervals",
        ),
        arg(
            "--replicates",
            type=number_from(0, 100_000, int),
            default=500,
            metavar="N",
            help="bootstrap samples (default 500)",
        ),
    ),
    group(
        "comparison",
        flag("--leave-one-out", "compare each record with the curves of all others"),
        file_arg("--unseen", "STUDY_DIR", "compare the runs of this other study with the curves"),
        flag("--after-damage", "of a study of sequences: by Psi before each shock"),
    ),
    out("folder for tables and pictures"),
    examples=(
        "results/fragility --out curves",
        'results/fragility --intensity record_pga_g --state "moderate: max_psi > 2" --out curves',
    ),
)
def _fragility(asked):
    from damage.applications.studies.fragility import STATES, load_runs
    from damage.applications.studies.plan import unfinished
    from damage.applications.studies.states import leading, parse_state, study_choices

    clash = [
        name for name in ("export", "at", "leave_one_out", "unseen") if getattr(asked, name, None)
    ]
    if asked.after_damage and clash:
        raise InputError(
            f"--{clash[0].replace('_', '-')} with --after-damage: expected one of them; leave"
            " one out"
        )
    chosen = study_choices(asked.study)
    states = tuple(map(parse_state, asked.states or chosen["states"])) or STATES
    runs = load_runs(asked.study)
    warn(*filter(None, [unfinished(asked.study)]))
    intensity = asked.intensity or chosen["intensity"] or leading(runs)
    draw = _fragility_after_damage if asked.after_damage else _fragility_curves
    figures = draw(asked, runs, intensity, states)
    save(figures, asked.out, f"study {shown_path(asked.study)}; {made_by_words(runs)}")


def _fragility_after_damage(asked, runs, intensity, states):
    """Tables of `--after-damage`; returns its figures."""
    from damage.applications.studies.after_damage import load_shocks, table_after_damage
    from damage.applications.studies.fragility_picture import picture_after_damage

    shocks = load_shocks(runs, asked.study, states)
    table = table_after_damage(shocks, intensity, asked.replicates, states)
    print(table.to_string(index=False, float_format="%.3f", na_rep="-"))
    print(write_table(table, asked.out / f"fragility_after_damage_{intensity}.csv"))
    drawn = {} if asked.states is None else {"states": states}
    return [
        (
            f"fragility_after_damage_{wall}_{intensity}",
            picture_after_damage(wall, of_wall, table[table["wall"] == wall], intensity, **drawn),
        )
        for wall, of_wall in shocks.groupby("wall")
    ]


def _fragility_curves(asked, runs, intensity, states):
    """Tables and exports of fragility curves; returns their figures."""
    from damage.applications.studies.fragility import (
        at_intensities,
        efficiency_table,
        fit_all,
        fragility_table,
        in_words,
        load_runs,
    )
    from damage.applications.studies.fragility_picture import fragility_pictures
    from damage.applications.studies.left_out import beside_unseen, leave_one_out, scores

    fits = fit_all(runs, intensity, asked.replicates, states)
    for write in WRITERS:
        write(asked, runs, fits, intensity)
    print(in_words(fits))
    print(
        write_table(
            fragility_table(fits, intensity).assign(slip="displacement"),
            asked.out / f"fragility_{intensity}.csv",
        )
    )
    tables = {"efficiency": efficiency_table(runs, states, intensity)}
    if asked.at:
        tables[f"fragility_{intensity}_at"] = at_intensities(fits, asked.at)
    compared = {"left_out": lambda: leave_one_out(runs, states)} if asked.leave_one_out else {}
    if asked.unseen:
        compared["unseen"] = lambda: beside_unseen(runs, load_runs(asked.unseen), states)
    for name, compare in compared.items():
        table = compare()
        print(write_table(table, asked.out / f"{name}.csv"))
        tables[f"{name}_scores"] = scores(table)
    for name, table in tables.items():
        print(table.to_string(index=False, float_format="%.3f", na_rep="-"))
        print(write_table(table, asked.out / f"{name}.csv"))
    return fragility_pictures(runs, fits, intensity)


@tables
def _tables():
    from damage.applications.studies.columns import TABLES

    return TABLES
