"""Damage files of every kind at random, read them, and tell what came: a table, and status 1 where a reader failed.

    python3 -m tests.fuzz --seconds 1200                  # twenty minutes a reader
    python3 -m tests.fuzz csv at2 --seconds 60 --seed 7   # a minute each of two of them, other files
    python3 -m tests.fuzz csv --seed 7 --only 123         # one of these files again; --keep DIR leaves it there
"""

import argparse
import itertools
import sys
import time

from tests.fuzz.harness import SECONDS, Tally, Worker
from tests.fuzz.readers import READERS


def main():
    """Status 0 where each file was read or refused in one line, in time, in little memory, and nothing was printed."""
    parser = argparse.ArgumentParser(prog="python3 -m tests.fuzz", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("readers", nargs="*", metavar="READER", help=f"of {', '.join(READERS)}; all without")
    parser.add_argument("--seconds", type=float, default=60, help="for each reader")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, metavar="NUMBER", help="this one file")
    parser.add_argument("--keep", metavar="DIR", help="for files of which something else came")
    asked = parser.parse_args()
    if unknown := set(asked.readers) - set(READERS):
        parser.error(f"{min(unknown)} is no reader; expected some of {', '.join(READERS)}")
    tallies = {}
    for reader in asked.readers or READERS:
        if READERS[reader].lacking:
            print(f"{reader}: left out, {READERS[reader].lacking} is missing", flush=True)
            continue
        with Worker(asked.seed, asked.keep) as worker:
            tallies[reader] = attack(worker, reader, asked)
    print(f"\n| reader | files | read | refused | else | slowest, s (limit {SECONDS}) | most memory, MB |\n"
          "| --- | --- | --- | --- | --- | --- | --- |")
    for reader, tally in tallies.items():
        print(tally.row(reader))
    return 1 if any(tally.bad for tally in tallies.values()) else 0


def attack(worker, reader, asked):
    """The Tally of one reader; what is not as it should be is reported at once."""
    tally, end = Tally(), None
    for number in itertools.count() if asked.only is None else [asked.only]:
        outcome = worker(reader, number)
        tally.add(outcome)
        if asked.only is not None or not outcome.good:
            print(f"{reader} {number} ({outcome.done}): {outcome.word}, {outcome.seconds:.1f} s, "
                  f"{outcome.bytes / 1e6:.0f} MB: {outcome.message}", flush=True)
        end = end or time.monotonic() + asked.seconds  # the first one waits for the undamaged files to be made
        if time.monotonic() > end:
            break
    return tally


if __name__ == "__main__":
    sys.exit(main())
