"""Commands about the source paper: figures, verdict, modelling choices."""

from pathlib import Path

from damage.commands.table import JSON, command, file_arg, out, output
from damage.errors import InputError
from damage.files import json_text, write_text


@command("figures 6 to 12 of the source paper and crack maps from the results of studies",
         file_arg("results", "RESULTS_DIR", "folder that holds the studies' folders, each with tables/points.csv"),
         out("folder for the figures"),
         file_arg("--records", "DIR", "folder of records that do not ship (default records)", default=Path("records")))
def _figures(asked):
    from damage.studies.figures import make_figures
    from damage.studies.results import load_results

    made = 0
    for name, outcome in make_figures(load_results(asked.results, asked.records), asked.out):
        if isinstance(outcome, str):
            print(f"not made: {name}: {outcome}")
            continue
        made += 1
        print(*outcome, sep="\n", flush=True)
    if made == 0:
        raise InputError(f"{asked.results} allows no figure; expected results of the studies harmonic or ida")


@command("judge the paper's statements by the tables of studies",
         file_arg("results", "RESULTS_DIR", "folder with studies below it"), JSON,
         output(file_arg("--markdown", "FILE", "write the document, too"),
                file_arg("--readme", "README.md", "renew the results between its markers, too")))
def _paper(asked):
    from damage.paper.report import as_json, as_markdown, describe, update_readme
    from damage.paper.verdict import judge

    findings = judge(asked.results)
    if asked.markdown:
        write_text(asked.markdown, as_markdown(findings))
    if asked.readme:
        update_readme(findings, asked.readme)
    print(json_text(as_json(findings), indent=2) if asked.json else describe(findings))


@command("which modelling choices move the paper's claims, by the tables of the study readings",
         file_arg("results", "RESULTS_DIR", "folder with the study below it"),
         output(file_arg("--markdown", "FILE", "write the document, too")))
def _readings(asked):
    from damage.paper.readings import as_markdown, conclusions, judge_readings, table

    found = judge_readings(asked.results)
    if asked.markdown:
        write_text(asked.markdown, as_markdown(found))
    print("\n".join([*table(found), "", *conclusions(found)]))


@command("combined modelling choices by the paper's claims that they meet, by the tables of the study combinations",
         file_arg("results", "RESULTS", "folder with the study below it"),
         output(file_arg("--markdown", "FILE", "write the document, too")))
def _combinations(asked):
    from damage.paper.combinations import (
        as_markdown,
        conclusions,
        judge_combinations,
        table_of_best,
        table_of_effects,
    )

    found = judge_combinations(asked.results)
    if asked.markdown:
        write_text(asked.markdown, as_markdown(found))
    print("\n".join([*conclusions(found), "", *table_of_best(found), "", *table_of_effects(found)]))
