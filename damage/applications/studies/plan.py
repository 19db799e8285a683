"""Dry run of a study: runs that are there and runs to make; nothing is written in the study's
folder."""

import shlex
from dataclasses import replace

from damage.applications.studies.definition import load_study
from damage.applications.studies.folder import KEPT, ROOT, command_of, way_on
from damage.applications.studies.outdated import Results
from damage.errors import InputError, warn


def print_plan(study, folder, remake=False):
    """Print the runs of a Study: what its folder has of each, and how many there are to make.

    Parameters
    ----------
    study : Study
    folder : Path
        Where its runs are kept; it need not exist.
    remake : bool
        Whether runs that another version made are made again.
    """
    results = Results(folder)
    verdict = results.judge(study.runs)
    lost = {*verdict.models, *verdict.measures} if remake else set()
    present = {}
    for run in study.runs:
        names = results.records.names_of(run)
        present[run] = [] if run in verdict.changed or lost.intersection(names) else names
    left = [run for run in study.runs if not present[run]]
    fewest = sum(run.members for run in left)
    most = sum(run.most_members for run in left)
    print(f"study {study.name}{': ' if study.title else ''}{study.title}")
    print(*solver_lines(study, folder), sep="\n")
    warn(*verdict.lintels)
    for run in study.runs:
        print(f"  {run.id:60s}  {_state(run, present[run])}")
    print(
        f"points: {len(study.runs)}, {len(study.runs) - len(left)} there; "
        f"runs to make: {'up to ' if most != fewest else ''}{most}, into {folder}",
        flush=True,
    )


def solver_lines(study, folder):
    """Lines on the solvers of a Study: which runs it, and the command that runs it in the other."""
    chosen = {run.solver for run in study.runs}
    lines = [f"solver: {' and '.join(sorted(chosen))}"]
    for other in sorted({run.solver for run in study.of_both} - chosen):
        cost = "a fiftieth of" if other == "reference" else "50 times"
        command = command_of(study.path, folder, ["--solver", other])
        lines.append(f"in {other}, a run in about {cost} the time: {command}")
    return lines if (ROOT / "yade_scripts").is_dir() else lines[:1]


def unfinished(folder):
    """A line on the study of a folder, how many of its points are there and how to go on; None
    where all are, or where no file of it can be read."""
    way = way_on(folder)
    file, options = way or (folder / KEPT, ["--solver", "both"])
    try:
        study = load_study(file, options[options.index("--solver") + 1], ROOT)
    except (InputError, OSError):
        return None
    results = Results(folder)
    present = [run for run in study.runs if results.records.names_of(run)]
    if way is None:  # which solver was meant
        solvers = {run.solver for run in present}
        study = replace(study, runs=tuple(run for run in study.runs if run.solver in solvers))
    if len(present) == len(study.runs):
        return None
    before = ""
    if present and not (folder / "tables" / "summary.csv").is_file():
        tables = shlex.join(["python3", "-m", "damage", "study-tables", str(file), str(folder)])
        before = f"; tables of those: {tables}"
    return (
        f"study {study.name}: {len(present)} of {len(study.runs)} points are done{before};"
        f" the others: {command_of(file, folder, options)}"
    )


def _state(run, names):
    """What is there of a run or an ensemble, or how many runs it takes, in words."""
    if names:
        return f"there, {len(names)} runs" if run.varied else "there"
    if run.most_members == 1:
        return "to make"
    most = f" to {run.most_members}" if run.most_members != run.members else ""
    return f"{run.members}{most} runs to make"
