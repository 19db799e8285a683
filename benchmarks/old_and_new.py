"""Old time over new time of the reference solver's steps, in one run against another checkout.

    python3 benchmarks/old_and_new.py OLD           # OLD: the folder of a checkout, this one is the new
    python3 benchmarks/old_and_new.py OLD --rounds 9

Both step the symmetric wall side by side, piece by piece in turn: intact, shaken until it is cracked, the
same sampled as a run samples it, and with stiffness-proportional damping.  Times are those of the processor,
since other programs use the machine, too; a round's is the least of its pieces.  Printed are the medians of
the rounds, in nanoseconds a contact and step, and their ratio, above one where the new tree is faster.
"""

import argparse
import importlib
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PIECES, STEPS, SAMPLE = 6, 1000, 67  # of a round; of a piece; between two samples, as 2 ms has
STEP_FACTOR = 0.643  # working time step over the critical one


def find(*places):
    """The first of "module:name" that the checkout in PYTHONPATH has: modules have moved."""
    for place in places:
        module, name = place.split(":")
        try:
            return getattr(importlib.import_module(module), name)
        except ImportError:
            continue
    sys.exit(f"error: none of {', '.join(places)} in {os.environ['PYTHONPATH']}; expected a checkout of this project")


def make_walls():
    """{state: (wall, steps between two samples)}, and the number of contacts."""
    import numpy as np

    layout = find("damage.wall.layout:lay_out", "damage.layout:lay_out")(
        find("damage.wall.file:load_wall", "damage.wall_file:load_wall")(ROOT / "walls/symmetric.py"))
    modes = find("damage.law.modes:natural_modes", "damage.modes:natural_modes")(layout)
    step = STEP_FACTOR * modes.critical_time_step_s
    motion = find("damage.motion.loading:Harmonic", "damage.loading:Harmonic")(0.2, 0.1)
    time_s = np.arange(round(0.6 / step)) * step
    solver, walls = find("damage.reference.wall:ReferenceWall"), {}
    for name, shaken, sample, beta in [("intact", False, STEPS, 0.0), ("cracked", True, STEPS, 0.0),
                                       ("intact, sampled", False, SAMPLE, 0.0),
                                       ("cracked, sampled", True, SAMPLE, 0.0), ("intact, beta", False, STEPS, 1e-6),
                                       ("cracked, beta", True, STEPS, 1e-6)]:
        wall = solver(layout, step)
        wall.local_damping = 0.7
        wall.run(round(0.3 / step))
        wall.local_damping = 0.0
        if shaken:
            wall.start(motion.base_acceleration(time_s))
            wall.run(len(time_s))
        wall.time_step = 0.5 * step if beta else step  # which damping lowers
        wall.beta = beta
        walls[name] = wall, sample
    return walls, len(layout.contacts)


def work():
    """Answer every name of a wall on standard input with the processor time of a piece [s], least of several."""
    walls, contacts = make_walls()
    print(contacts, *walls, sep=";", flush=True)
    for line in sys.stdin:
        wall, sample = walls[line.strip()]
        start = time.process_time()
        for _ in range(STEPS // sample):
            wall.run(sample)
        print((time.process_time() - start) / (STEPS // sample * sample), flush=True)


class Tree:
    """A checkout and the process that steps its walls."""

    def __init__(self, folder):
        self.folder = folder
        self.process = subprocess.Popen([sys.executable, "-W", "ignore", __file__, "--worker", folder], cwd=folder,
                                        text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        env={**os.environ, "PYTHONPATH": str(folder)})

    def read(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit(f"error: the steps in {self.folder} ended with exit status {self.process.wait()}")
        return line.strip()

    def piece(self, wall):
        """Seconds a step."""
        print(wall, file=self.process.stdin, flush=True)
        return float(self.read())

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def one_round(folders):
    """{wall: [seconds a step, old and new]}, and the number of contacts; in processes of its own, as where the
    tables come to lie in memory is worth some per cent."""
    trees = [Tree(folder) for folder in folders]
    greetings = [tree.read() for tree in trees]
    contacts, *walls = greetings[0].split(";")
    result = {}
    for wall in walls:
        pieces = []
        for k in range(PIECES):
            order = (0, 1) if k % 2 else (1, 0)
            times = {which: trees[which].piece(wall) for which in order}
            pieces.append([times[0], times[1]])
        result[wall] = [min(piece[which] for piece in pieces) for which in (0, 1)]
    for tree in trees:
        tree.close()
    return result, int(contacts)


def compare(folders, rounds):
    """Print the medians of both trees for every wall, and their ratio."""
    results, contacts = zip(*(one_round(folders) for _ in range(rounds)))
    print(f"{'':18s} {'old':>7s} {'new':>7s}  old/new  single rounds    (ns a contact and step)")
    for wall in results[0]:
        old, new = (statistics.median(result[wall][which] for result in results) for which in (0, 1))
        ratios = [result[wall][0] / result[wall][1] for result in results]
        print(f"{wall:18s} {old / contacts[0] * 1e9:7.2f} {new / contacts[0] * 1e9:7.2f}  {old / new:7.3f}  "
              f"{min(ratios):.3f} to {max(ratios):.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    parsed = parser.parse_args()
    if parsed.worker:
        work()
    elif not (parsed.old / "damage/reference/wall.py").is_file():
        sys.exit(f"error: {parsed.old} holds no damage/reference/wall.py; give the folder of a checkout")
    else:
        compare((parsed.old.resolve(), ROOT), parsed.rounds)


if __name__ == "__main__":
    main()
