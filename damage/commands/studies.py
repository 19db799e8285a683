"""Commands about studies and what they write."""

from damage.commands.table import arg, command, file_arg, out
from damage.files import json_text
from damage.run.options import number_from


@command("the tables of a study, from the runs that exist so far", file_arg("study", "STUDY.toml"),
         file_arg("folder", "DIR", "the study's folder; tables go to DIR/tables"),
         arg("--solver", choices=("yade", "reference", "both"), default="both",
          help="whose runs the study names (default both)"),
         file_arg("--root", "DIR", "where walls and records lie (default: the working folder)"),
         arg("-j", dest="jobs", type=number_from(1, 1000, int), default=1, metavar="N", help="processes (default 1)"))
def _study_tables(asked):
    from damage.studies.definition import load_study
    from damage.studies.tables import write_study_tables

    print(*write_study_tables(load_study(asked.study, asked.solver, asked.root), asked.folder, asked.jobs), sep="\n")


@command("the JSON Schema of study files, by which editors complete and check them: put it beside yours, and "
         "'#:schema ./study.schema.json' on its first line")
def _study_schema(asked):
    from damage.studies.schema import study_schema

    print(json_text(study_schema(), indent=1))


@command("the data dictionary: every column of every table, as dictionary.csv and dictionary.md",
         out("folder for both"))
def _dictionary(asked):
    from damage.export.dictionary import write_dictionary

    print(*write_dictionary(asked.out), sep="\n")
