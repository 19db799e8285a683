"""`python3 -m damage study STUDY`: a study from its file to tables and pictures; `run_all.sh`
starts this, too."""

import os
import re
from argparse import ArgumentTypeError
from pathlib import Path

from damage.applications.studies.batch import run
from damage.applications.studies.definition import load_study
from damage.applications.studies.folder import RESULTS, ROOT
from damage.applications.studies.plan import print_plan
from damage.applications.studies.tasks import KEEP
from damage.arguments import OneLineParser, file_path, number_from
from damage.errors import InputError, did_you_mean
from damage.files import is_there, shipped_files


def run_study(arguments):
    """Run the study that words of a command line ask for; returns the exit status: 0
    all done, 1 a run failed or was not made, 2 bad input, 130 interrupted.
    Raises InputError."""
    words = arguments or ["--help"]
    if words[0].startswith("-") and words[0] not in ("-h", "--help"):
        raise InputError(
            f"{words[0]} comes where a study should; give python3 -m damage study STUDY [OPTIONS]"
        )
    asked = parse(words)
    if asked.solver != "reference" and not (ROOT / "yade_scripts").is_dir():
        raise InputError(
            f"--solver {asked.solver}: YADE's programs are in a clone of the repository only,"
            " beside YADE; leave --solver out, or give ./run_all.sh in a clone"
        )
    return run_one(asked, study_path(asked.study))


def parse(words):
    """The parsed words of a command line."""
    parser = OneLineParser(
        prog="python3 -m damage study",
        allow_abbrev=False,
        examples=(
            "python3 -m damage study quick",
            "python3 -m damage study my_study.toml -j 4 --keep summary --out mine",
        ),
        description="Run a study: simulations, tables, pictures.  What is done is not done again.",
    )
    parser.add_argument(
        "study", metavar="STUDY", help="a study file (.toml), or the name of one that ships"
    )
    parser.add_argument(
        "-j",
        dest="jobs",
        type=number_from(1, 9999, int),
        default=os.cpu_count(),
        metavar="N",
        help="simulations at a time (default: one for each core)",
    )
    parser.add_argument(
        "--out", type=file_path, metavar="DIR", help="where everything goes (default results/NAME)"
    )
    parser.add_argument(
        "--solver",
        default="reference",
        choices=("yade", "reference", "both"),
        help="what simulates (default reference)",
    )
    parser.add_argument(
        "--keep",
        default="all",
        choices=KEEP,
        help=(
            "histories: all (default); summary: those of each point's first run, and what failed;"
            " patterns: these, and of every run openings, offsets and displacements at rest, some"
            " kB each"
        ),
    )
    parser.add_argument(
        "--dry-run",
        action="store_true",
        help="make nothing: list the runs that are there and those to make",
    )
    parser.add_argument(
        "--remake", action="store_true", help="make runs again that another version made"
    )
    parser.add_argument(
        "--slice",
        type=_slice,
        metavar="K/N",
        help="the K-th of N parts alone, without tables of the whole study: a job of a cluster",
    )
    return parser.parse_args(words)


def _slice(word):
    match = re.fullmatch(r"([1-9]\d{0,4})/([1-9]\d{0,4})", word)
    if not match or int(match[1]) > int(match[2]):
        raise ArgumentTypeError(f"{word}: expected K/N with K from 1 to N, as 2/8; correct it")
    return int(match[1]), int(match[2])


def study_path(word):
    """Path of a study file given by path or by the name of a shipped study; a file has precedence.
    Raises InputError where there is neither."""
    named = shipped_files("studies", ".toml")
    if is_there(word):
        return Path(word)
    if str(word) in named:
        return named[str(word)]
    raise InputError(
        f"{word}: no such study file; expected the path of one (.toml), or the name of a study that"
        " ships:"
        f" {', '.join(named)}{did_you_mean(word, named) or did_you_mean(Path(word).stem, named)}"
    )


def run_one(asked, path):
    """Run the study at a path as parsed words ask for; returns the exit status."""
    study = load_study(path.absolute(), asked.solver, ROOT)
    folder = (asked.out or RESULTS / study.name).absolute()
    if asked.dry_run:
        print_plan(study, folder, asked.remake)
        return 0
    return run(study, folder, asked.jobs, asked.keep, remake=asked.remake, part=asked.slice)
