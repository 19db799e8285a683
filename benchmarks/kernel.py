"""The compiled step against that of an older commit, as ratios of pieces that take turns in one
process.

    python3 benchmarks/kernel.py          # against d51e596, before joints could soften
    python3 benchmarks/kernel.py --old COMMIT --rounds 15
    python3 benchmarks/kernel.py --avx2   # as a processor without AVX-512 would be given
    python3 benchmarks/kernel.py --sizes  # nanoseconds a contact and step against wall size, too

The older package is taken from git into a temporary folder under another name.  The symmetric wall
is intact, or shaken until it is cracked, brittle or softening (where the older commit has
softening joints), by the older kernel and the present one alike; it steps
alone, sampled every 2 ms, as 4, 8 and 16 walls together, and with damping proportional to
stiffness.  Times are those of the processor, a wall and step; a ratio is the median over the rounds
of new to old.
"""

import argparse
import contextlib
import importlib.util
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
import timeit
from functools import partial
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
BEFORE_SOFTENING = "d51e596"
STEPS = 15 * 67
SAMPLE = 67
SIZES = ((8, 7), (18, 37), (60, 60), (115, 115))  # bricks along and up


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--old", default=BEFORE_SOFTENING)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--sizes", action="store_true")
    parser.add_argument("--avx2", action="store_true")
    asked = parser.parse_args()
    if asked.avx2:
        os.environ |= {
            "NUMBA_CPU_NAME": "haswell",
            "NUMBA_CPU_FEATURES": "+avx,+avx2,+bmi,+bmi2,+f16c,+fma,+popcnt",
        }
    with tempfile.TemporaryDirectory() as folder:
        take_from_git(asked.old, Path(folder))
        os.environ.setdefault("NUMBA_CACHE_DIR", folder)
        sys.path.insert(0, folder)
        for state in ("intact", "cracked", "softening"):
            compare(state, asked.rounds)
        if asked.sizes:
            against_size()


def take_from_git(commit, folder):
    """The package of a commit as `damage_before` in a folder."""
    archive = subprocess.run(
        ["git", "archive", commit, "damage"], cwd=ROOT, check=True, capture_output=True
    ).stdout
    subprocess.run(["tar", "x", "-C", folder, "--exclude=damage/data"], input=archive, check=True)
    (folder / "damage").rename(folder / "damage_before")
    for path in (folder / "damage_before").rglob("*.py"):
        text = re.sub(
            r"\b(from|import) damage\b", r"\1 damage_before", path.read_text(encoding="utf-8")
        )
        path.write_text(text.replace('"damage.', '"damage_before.'), encoding="utf-8")


def make(package, state, beta=0.0, size=None):
    """A wall of a package at rest under its weight, or cracked; without a size the symmetric
    one."""

    def of(*places):
        """The first of these modules that the package has."""
        for place in places:
            with contextlib.suppress(ModuleNotFoundError):
                return importlib.import_module(f"{package}.{place}")
        sys.exit(
            f"error: {package} has none of {', '.join(places)}; expected a commit since d51e596"
        )

    layout = of("wall.layout").lay_out(wall_of(of("wall.parameters"), size, state))
    modes = of("linear.modes", "law.modes", "wall.modes").natural_modes(layout)
    step = 0.643 * modes.critical_time_step_s
    wall = of("reference.wall").ReferenceWall(layout, step)
    wall.local_damping = 0.7
    wall.run(round((0.3 if size is None else 0.01) / step))
    wall.local_damping = 0.0
    if state != "intact":
        time_s = np.arange(round(0.6 / step)) * step
        wall.start(of("motion.loading").Harmonic(0.2, 0.1).base_acceleration(time_s))
        wall.run(len(time_s))
    if beta:
        wall.time_step = 0.5 * step
        wall.beta = beta
    return wall


def wall_of(parameters, size, state):
    """The numbers of walls/symmetric.py, or a plain wall of so many bricks along and up, in a
    package's own records."""
    brick = parameters.Brick(length=0.225, height=0.075, thickness=0.1025)
    along, up = size or (18, 37)
    openings = (
        [] if size else [parameters.Opening(left=4.5 * 0.225, width=9 * 0.225, height=33 * 0.075)]
    )
    # of later commits
    lintel = {"lintel": "courses"} if "lintel" in parameters.Wall.__dataclass_fields__ else {}
    softening = {}
    if state == "softening":
        if "mode_i_fracture_energy" not in parameters.Joint.__dataclass_fields__:
            sys.exit("joints of the older commit do not soften: no comparison")
        softening = {"mode_i_fracture_energy": 5.0, "mode_ii_fracture_energy": 50.0}
    return parameters.Wall(
        name="benchmark",
        length=along * 0.225,
        height=up * 0.075,
        openings=openings,
        precompression=0.3e6,
        brick=brick,
        joint=parameters.Joint(tensile_strength=0.21e6, cohesion=0.24e6, **softening),
        **lintel,
    )


def compare(state, rounds):
    """Print what a step costs in every way, and its ratio to the older kernel's."""
    from damage.reference.lanes import run_together

    old = make("damage_before", state)
    new = make("damage", state)
    damped = make("damage", state, 1e-6)
    pieces = {
        "old, alone": (old.run, 1),
        "alone": (new.run, 1),
        "alone, beta": (damped.run, 1),
        "old, sampled": (partial(sampled, old), 1),
        "sampled": (partial(sampled, new), 1),
    }
    for number in (4, 8, 16):
        walls = [make("damage", state) for _ in range(number)]
        pieces[f"{number} together"] = (
            lambda steps, walls=walls: run_together(walls, steps),
            number,
        )
    if importlib.util.find_spec("damage_before.reference.lanes"):
        olds = [make("damage_before", state) for _ in range(8)]
        move_olds = importlib.import_module("damage_before.reference.lanes").run_together
        pieces["old, 8 together"] = (lambda steps: move_olds(olds, steps), 8)
    times = {name: [] for name in pieces}
    for run, _ in pieces.values():
        run(STEPS)
    for _ in range(rounds):
        for name, (run, number) in pieces.items():
            spent = timeit.timeit(partial(run, STEPS), timer=time.process_time, number=1)
            times[name].append(spent / STEPS / number)
    broken = int((new.state > 0).sum())
    print(f"{state}, {len(new.system.contacts)} contacts, {broken} broken")
    for name, values in times.items():
        ratios = {
            other: statistics.median(a / b for a, b in zip(values, times[other]))
            for other in ("old, alone", "alone")
        }
        print(
            f"  {name:16s} {min(values) * 1e6:7.2f} us a wall and step, {ratios['old, alone']:.3f}"
            f" of the old one, {ratios['alone']:.3f} of one alone",
            flush=True,
        )
    for name in ("alone", "sampled", "8 together"):
        if f"old, {name}" in times:
            print(
                f"  {name}: minimum {min(times[name]) / min(times[f'old, {name}']):.3f} of the"
                " old one",
                flush=True,
            )


def sampled(wall, steps):
    """Steps of a wall of which a sample is taken every 2 ms."""
    for _ in range(steps // SAMPLE):
        wall.run(SAMPLE)


def against_size():
    """Print nanoseconds a contact and step of plain walls, alone and as 8 together."""
    from damage.reference.lanes import run_together

    for size in SIZES:
        walls = [make("damage", "intact", size=size) for _ in range(8)]
        contacts = len(walls[0].system.contacts)
        steps = max(20, 2_000_000 // len(walls[0].system.contacts))
        cost = {}
        for name, run, number in (
            ("alone", walls[0].run, 1),
            ("8 together", lambda n, walls=walls: run_together(walls, n), 8),
        ):
            run(steps)
            pieces = timeit.repeat(partial(run, steps), timer=time.process_time, number=1, repeat=5)
            cost[name] = min(pieces) / steps / number / contacts * 1e9
        text = ", ".join(f"{name} {value:.2f}" for name, value in cost.items())
        print(
            f"{size[0]} by {size[1]} bricks, {contacts} contacts: {text} ns a contact and step",
            flush=True,
        )


if __name__ == "__main__":
    main()
