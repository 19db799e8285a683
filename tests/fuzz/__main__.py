"""Damage files of every kind at random, read them, and tell what came: a table, and status 1 where a reader failed.

    python3 -m tests.fuzz --seconds 1200                  # twenty minutes a reader
    python3 -m tests.fuzz csv at2 --seconds 60 --seed 7   # a minute each of two of them, other files
    python3 -m tests.fuzz csv --seed 7 --only 123         # one of these files again; --keep DIR leaves it there
"""

import argparse
import itertools
import sys
import time
from collections import Counter

from tests.fuzz.harness import GOOD, SECONDS, Worker
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
    rows, all_good = [], True
    for reader in asked.readers or READERS:
        if READERS[reader].lacking:
            print(f"{reader}: left out, {READERS[reader].lacking} is missing", flush=True)
            continue
        with Worker(asked.seed, asked.keep) as worker:
            words, slowest_s, most_bytes = attack(worker, reader, asked)
        rest = ", ".join(f"{number} {word}" for word, number in sorted(words.items()) if word not in GOOD)
        rows.append(f"| {reader} | {words.total()} | {words['read']} | {words['refused']} | {rest or 'none'} | "
                    f"{slowest_s:.1f} | {most_bytes / 1e6:.0f} |")
        all_good = all_good and not rest
    print(f"\n| reader | files | read | refused | else | slowest, s (limit {SECONDS}) | most memory, MB |\n"
          "| --- | --- | --- | --- | --- | --- | --- |", *rows, sep="\n")
    return 0 if all_good else 1


def attack(worker, reader, asked):
    """What came of a reader's files: words counted, the slowest [s], the largest memory [bytes]; what is not as it
    should be is reported at once."""
    words, slowest_s, most_bytes, end = Counter(), 0.0, 0, None
    for number in itertools.count() if asked.only is None else [asked.only]:
        outcome = worker(reader, number)
        words[outcome.word] += 1
        slowest_s, most_bytes = max(slowest_s, outcome.seconds), max(most_bytes, outcome.bytes)
        if asked.only is not None or not outcome.good:
            print(f"{reader} {number} ({outcome.done}): {outcome.word}, {outcome.seconds:.1f} s, "
                  f"{outcome.bytes / 1e6:.0f} MB: {outcome.message}", flush=True)
        end = end or time.monotonic() + asked.seconds  # the first one waits for the undamaged files to be made
        if time.monotonic() > end:
            break
    return words, slowest_s, most_bytes


if __name__ == "__main__":
    sys.exit(main())
