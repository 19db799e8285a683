"""`python3 -m damage study STUDY`: a batch of runs by the programs of `workflow`, which need Snakemake."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

from damage.errors import InputError, did_you_mean
from damage.files import is_there, shipped, shipped_files

HELP = "-h", "--help"


def run_study(arguments, quiet=False):
    """Replace this process with the batch of a study; returns only on errors.

    arguments: the study (a file, or the name of one that ships), then options of the batch; the solver is the reference
    solver unless they name another; quiet: print warnings and errors only.  Raises InputError, and ImportError where
    Snakemake is missing.
    """
    study, *options = arguments or HELP[1:]
    if study not in HELP:
        if study.startswith("-"):
            raise InputError(f"{study} comes where a study should; give python3 -m damage study STUDY [OPTIONS]")
        options = [str(study_path(study).absolute()), "--solver", "reference", *options]
    else:
        options = [study]
    if "yade" in options or "both" in options or {"--solver=yade", "--solver=both"} & set(options):
        _check_yade()
    program = shipped("workflow") / "batch.py"
    if not is_there(program):
        raise InputError(f"{program}: no such file; expected it in a clone or an installed package; install it anew")
    if study not in HELP and not find_spec("snakemake"):
        raise ModuleNotFoundError("No module named 'snakemake'", name="snakemake")
    # Runs side by side are what uses the processors; threads of linear algebra would only wait for them.
    environment = {"OPENBLAS_NUM_THREADS": "1", **os.environ, "PYTHONPATH": _python_path()}
    sys.stdout.flush()
    if quiet:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.execve(sys.executable, [sys.executable, str(program), *options], environment)


def study_path(word):
    """Path of a study file given by path or by the name of a shipped study; a file has precedence.  Raises InputError
    where there is neither."""
    named = shipped_files("studies", ".toml")
    if is_there(word):
        return Path(word)
    if word in named:
        return named[word]
    raise InputError(f"{word}: no such study file; expected the path of one (.toml), or the name of a study that "
                     f"ships: {', '.join(named)}{did_you_mean(word, named) or did_you_mean(Path(word).stem, named)}")


def _check_yade():
    if not (shipped("workflow").parent / "yade_scripts").is_dir():
        raise InputError("--solver yade: its programs are in a clone of the repository only, beside YADE; expected "
                         "--solver reference, or ./run_all.sh in a clone")


def _python_path():
    """PYTHONPATH for the programs: this package, then the user's."""
    package = str(Path(__file__).resolve().parents[2])
    given = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return os.pathsep.join(dict.fromkeys([package, *(os.path.abspath(folder) for folder in given if folder)]))
