"""Commands about the source paper, from a clone: python3 -m paper COMMAND.  Figures, verdict,
modelling choices; and the programs that make tables of documents, by the names of their modules."""

from damage.start import EXIT_INPUT, EXIT_INTERRUPTED, begin, leave, reported

if __name__ == "__main__":
    begin()  # before what takes its time to import

import sys
from functools import partial
from importlib import import_module
from pathlib import Path

from damage.__main__ import add_commands
from damage.applications.studies.commands import STUDY_OPTIONS
from damage.arguments import OneLineParser, file_arg
from damage.commands.table import JSON, command, out, output
from damage.errors import InputError, did_you_mean
from damage.files import json_text, shipped_files, write_text

PROGRAMS = (
    "after_peak",
    "claim_coverage",
    "coverage",
    "dic_field",
    "dilatancy",
    "document_figures",
    "houses",
    "laboratory",
    "repeated_loading",
    "results_figures",
    "softening",
    "shear_walls",
    "thirty_years",
)
"""Modules that make tables and figures of documents: python3 -m paper NAME, with their own
arguments."""
COMMANDS = {}
command = partial(command, table=COMMANDS)


def main(arguments=None):
    """Run one command; returns the exit status as `python3 -m damage` does."""
    return reported(lambda: _run(sys.argv[1:] if arguments is None else list(arguments)))


def _run(arguments):
    if arguments and arguments[0] in PROGRAMS:
        sys.argv = [f"python3 -m paper {arguments[0]}", *arguments[1:]]
        return import_module(f"paper.{arguments[0]}").main() or 0
    known = [*COMMANDS, *PROGRAMS]
    if arguments and not arguments[0].startswith("-") and arguments[0] not in known:
        raise InputError(
            f"no command {arguments[0]!r}: expected one of {', '.join(known)} (the commit of a"
            " program that was removed is in docs/tables/benchmarks/README.md)"
            f"{did_you_mean(arguments[0], known)}"
        )
    parser = OneLineParser(
        prog="python3 -m paper",
        allow_abbrev=False,
        description=__doc__,
        epilog=f"Programs: {', '.join(PROGRAMS)}.",
    )
    add_commands(
        parser.add_subparsers(required=True, metavar="COMMAND", parser_class=OneLineParser),
        COMMANDS,
    )
    asked = parser.parse_args(arguments)
    return asked.command(asked) or 0


@command(
    "every study that ships, with options of `python3 -m damage study`, then figures and verdict",
    *STUDY_OPTIONS,
)
def _studies(asked):
    """Run every study that ships, then figures and verdict; returns the worst exit status."""
    from damage.applications.studies.command import RESULTS

    if asked.slice:
        raise InputError("--slice is of one study; name it")
    out = asked.out or RESULTS
    status = _run_all(asked, out)
    if asked.dry_run or status in (EXIT_INPUT, EXIT_INTERRUPTED):
        return status
    records = Path(__file__).parents[1] / "records"
    print("figures and verdict", flush=True)
    return max(
        status,
        main(["figures", str(out), "--out", str(out / "figures"), "--records", str(records)]),
        main(
            [
                "verdict",
                str(out),
                "--markdown",
                str(out / "tables" / "verdict.md"),
                "--csv",
                str(out / "tables" / "verdict.csv"),
            ]
        ),
    )


def _run_all(asked, out):
    """Run every study that ships and has a run for the solver, one after the other; returns the
    worst exit status."""
    from damage.applications.studies.command import ROOT, load_study, run_one

    ended = {}
    for name, path in shipped_files("studies", ".toml").items():
        try:
            load_study(path, asked.solver, ROOT)
        except InputError as error:
            print(f"passed over: {error}", flush=True)
            continue
        asked.out = out / name
        try:
            ended[name] = run_one(asked, path)
        except InputError as error:
            print(f"error: {error}", file=sys.stderr)
            ended[name] = EXIT_INPUT
        if ended[name] == EXIT_INTERRUPTED:
            return EXIT_INTERRUPTED
    if not ended:
        raise InputError(
            f"--solver {asked.solver}: no study has a run for this solver; choose another"
        )
    for name, status in ended.items():
        if status != 0:
            print(
                f"study {name}: FAILED, status {status}; see the logs in {out / name / 'logs'}",
                file=sys.stderr,
            )
    return max(ended.values())


@command(
    "figures 6 to 12 of the source paper and crack maps from the results of studies",
    file_arg(
        "results",
        "RESULTS_DIR",
        "folder that holds the studies' folders, each with tables/points.csv",
    ),
    out("folder for the figures"),
    file_arg(
        "--records",
        "DIR",
        "folder of records that do not ship (default records)",
        default=Path("records"),
    ),
)
def _figures(asked):
    from paper.figures import make_figures
    from paper.results import load_results

    made = 0
    for name, outcome in make_figures(load_results(asked.results, asked.records), asked.out):
        if isinstance(outcome, str):
            print(f"not made: {name}: {outcome}")
            continue
        made += 1
        print(*outcome, sep="\n", flush=True)
    if made == 0:
        raise InputError(
            f"{asked.results} allows no figure; expected results of the studies harmonic or ida"
        )


@command(
    "judge the paper's statements by the tables of studies",
    file_arg("results", "RESULTS_DIR", "folder with studies below it"),
    JSON,
    output(
        file_arg("--markdown", "FILE", "write the document, too"),
        file_arg("--csv", "FILE", "write the outcome of every claim, too"),
    ),
)
def _verdict(asked):
    from paper.report import as_json, as_markdown, claims_table, describe
    from paper.verdict import judge

    findings = judge(asked.results)
    if asked.markdown:
        write_text(asked.markdown, as_markdown(findings))
    if asked.csv:
        write_text(asked.csv, claims_table(findings).to_csv(index=False))
    print(json_text(as_json(findings), indent=2) if asked.json else describe(findings))


@command(
    "which modelling choices move the paper's claims, by the tables of the study readings",
    file_arg("results", "RESULTS_DIR", "folder with the study below it"),
)
def _readings(asked):
    from paper.readings import conclusions, judge_readings, table

    found = judge_readings(asked.results)
    print("\n".join([*table(found), "", *conclusions(found)]))


@command(
    "combined modelling choices by the paper's claims that they meet, by the tables of the study"
    " combinations",
    file_arg("results", "RESULTS", "folder with the study below it"),
)
def _combinations(asked):
    from paper import combinations

    found = combinations.judge_combinations(asked.results)
    print(
        "\n".join(
            [
                *combinations.conclusions(found),
                "",
                *combinations.table_of_best(found),
                "",
                *combinations.table_of_effects(found),
            ]
        )
    )


if __name__ == "__main__":
    leave(main())
