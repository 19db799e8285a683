"""The members of an ensemble one after another, in one process: imports and compiled code are loaded once.

    ensemble.py POINT --runs runs --tables tables --members N --varied='--scatter 0.001 --seed' [--adaptive]
        --inputs DIGEST --name POINT_NAME -- walls/NAME.py [OPTIONS]

Member k is the reference solver's run with the words of --varied and k behind its options, in runs/POINT_sk.h5; it
grows in runs/POINT_sk.part.h5 and gets its name when it is whole.  A member that is there is not done again, unless
runs/.inputs/POINT tells of other inputs than DIGEST.  With --adaptive the first is the only one where it breaks no
joint: the wall was linear, and strengths change nothing; and there are as many again where the first N spread widely
(`damage.studies.members`).  Last comes runs/POINT.members, their names;
before it their rows for the summary, the first one's tables and the others' cycles and shocks.

Exit status: 0 all members whole, 130 interrupted, otherwise that of the last member that failed.
"""

import argparse
import os
import sys
from pathlib import Path

from shared import tell

from damage.errors import InputError
from damage.files import write_text
from damage.history.reader import read_history
from damage.measure.tables import RUN_TABLES, write_run_tables
from damage.reference.session import run_reference
from damage.run.session import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK
from damage.studies.members import tails_are_heavy
from damage.studies.tables import write_row


def main():
    """Run one ensemble; returns the exit status."""
    asked = _arguments()
    try:
        return run_members(asked)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_FAILED


def run_members(asked):
    """Bring all members and their tables up to date; returns the exit status."""
    keep_what_fits(asked.runs, asked.point, asked.inputs)
    status, names, rows, number, last = EXIT_OK, [], [], 0, asked.members
    while number < last:
        number += 1
        name = f"{asked.point}_s{number}"
        ended, history = member(asked, name, number)
        if ended == EXIT_INTERRUPTED:
            return ended
        if history is None:
            status = ended
            continue
        write_run_tables(history, asked.tables / name, RUN_TABLES if number == 1 else ("cycles", "shocks"))
        rows.append(write_row(history, asked.tables / "rows" / f"{name}.json", asked.name))
        names.append(name)
        if asked.adaptive and number == 1 and not (history.broken.any() or history.at_limit.any()):
            break
        if asked.adaptive and number == asked.members and tails_are_heavy(rows):
            last = 2 * asked.members
    if status == EXIT_OK:
        write_text(asked.runs / f"{asked.point}.members", "\n".join(names) + "\n")
    return status


def _arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("point")
    for option in ("--runs", "--tables"):
        parser.add_argument(option, type=Path, required=True)
    parser.add_argument("--members", type=int, required=True)
    for option in ("--varied", "--inputs", "--name"):
        parser.add_argument(option, required=True)
    parser.add_argument("--adaptive", action="store_true")
    parser.add_argument("words", nargs="+")
    return parser.parse_args()


def keep_what_fits(runs, point, inputs):
    """Remove the members that were made from other inputs, and note of which the next ones are."""
    note = runs / ".inputs" / point
    if not note.is_file() or note.read_text(encoding="utf-8") != inputs:
        for path in runs.glob(f"{point}_s*.h5"):
            if path.name.removeprefix(f"{point}_s").split(".")[0].isdigit():
                path.unlink()
        write_text(note, inputs)


def member(asked, name, number):
    """Simulate one member unless it is there; returns (exit status, its History or None)."""
    out, part = asked.runs / f"{name}.h5", asked.runs / f"{name}.part.h5"
    if not out.is_file():
        words = [*asked.words, *asked.varied.split(), str(number)]
        print(f"--- {name}", flush=True)
        status = run_reference([*words, "--out", str(part), "--overwrite", "--no-pictures"])
        if status != EXIT_OK:
            tell(f"{name}: {'interrupted' if status == EXIT_INTERRUPTED else 'FAILED'}")
            return status, None
        os.replace(part, out)
        tell(f"{name}: done")
    try:
        history = read_history(out)
    except InputError as error:
        print(f"error: {error}; delete it", file=sys.stderr)
        return EXIT_FAILED, None
    return EXIT_OK, history


if __name__ == "__main__":
    sys.exit(main())
