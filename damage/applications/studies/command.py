"""`python3 -m damage study STUDY`: a study from its file to tables and pictures; `run_all.sh`
starts this, too."""

from pathlib import Path

from damage.applications.studies.batch import run
from damage.applications.studies.definition import load_study
from damage.applications.studies.folder import RESULTS, ROOT
from damage.applications.studies.plan import print_plan
from damage.errors import InputError, did_you_mean
from damage.files import is_there, shipped_files


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
    """Run the study at a path as the options of `damage.applications.studies.commands` ask for;
    returns the exit status: 0 all done, 1 a run failed or was not made, 130 interrupted.  Raises
    InputError."""
    if asked.solver != "reference" and not (ROOT / "yade_scripts").is_dir():
        raise InputError(
            f"--solver {asked.solver}: YADE's programs are in a clone of the repository only,"
            " beside YADE; leave --solver out, or give ./run_all.sh in a clone"
        )
    study = load_study(path.absolute(), asked.solver, ROOT)
    folder = (asked.out or RESULTS / study.name).absolute()
    if asked.dry_run:
        print_plan(study, folder, asked.remake)
        return 0
    return run(study, folder, asked.jobs, asked.keep, remake=asked.remake, part=asked.slice)
