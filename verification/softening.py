"""One joint that softens, along ten paths: what it dissipates, its peaks, and YADE beside the
reference solver.

Two bricks; the upper one is moved, without turning, and what the joint between does on it is read.
A joint pulled apart dissipates G_I, one that slides out G_II beside what friction takes, at any
pressure; the peaks are f_t and c + p tan(phi).  Where opening and sliding mix, or loading reverses,
no closed form holds: there the two solvers are laid side by side (`compared`,
docs/validation/verification.md).
"""

import argparse
import json
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from damage.mechanics.tables import FRACTURE, FRICTION
from damage.reference.wall import ReferenceWall
from damage.wall.kinds import BED, GROUND
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Joint, Wall
from verification.problem import SOLVERS, Problem, run_yade

JOINT = Joint(
    tensile_strength=0.21 / 0.24 * 0.21e6,
    cohesion=0.21e6,
    friction_angle=float(np.arctan(0.42)),
    mode_i_fracture_energy=5.0,
    mode_ii_fracture_energy=50.0,
)
"""COMP1_3's joints (walls/squat_tested.py) with fracture energies."""
PRESSURES_MPA = (0.0, 0.1, 0.3, 1.0)
FINE = 1500
"""Steps to the first corner, the strength and a half."""
COARSE = 6000
"""Steps from each corner to the next."""
COARSE_IN_YADE = 1500
"""Steps from each corner to the next in YADE, for problems."""


def pair(**changes):
    """The layout of two half bricks, one on the other; changes: of JOINT."""
    return lay_out(
        Wall("pair", 0.1125, 0.15, precompression=0.0, joint=replace(JOINT, **changes)),
        ModelOptions(cells=1),
    )


def between(layout):
    """Row of the first contact point of the joint between the two bricks, which are all alike."""
    return int(np.flatnonzero(_in_joint(layout.contacts))[0])


def joint_area(layout):
    """Area of that joint [m2]."""
    return float(layout.contacts.area[_in_joint(layout.contacts)].sum())


def _in_joint(contacts):
    return (contacts.kind == BED) & (contacts.first != GROUND)


def paths(fine=FINE, coarse=COARSE):
    """{name: (n, 2) opening and shear displacement [m]}, with so many steps to the first corner and
    to each other."""
    layout = pair()
    joint = JOINT

    def path(*corners):
        parts = [
            np.linspace(a, b, coarse if number else fine, endpoint=False)
            for number, (a, b) in enumerate(zip(corners[:-1], corners[1:]))
        ]
        return np.vstack([*parts, corners[-1]])

    kn, ks = (
        values[between(layout)]
        for values in (layout.contacts.normal_stiffness, layout.contacts.shear_stiffness)
    )
    apart = 4e-4
    out = 3e-3
    held = -0.3e6 / kn
    found = {"tension": path((0, 0), (1.5 * joint.tensile_strength / kn, 0), (apart, 0))}
    for pressure in PRESSURES_MPA:
        opening = -1e6 * pressure / kn
        peak = (joint.cohesion + 1e6 * pressure * 0.42) / ks
        found[f"shear at {pressure:g} MPa"] = path(
            (opening, 0), (opening, 1.5 * peak), (opening, out)
        )
    found["opening and sliding alike"] = path((0, 0), (1e-5, 1e-5), (apart, apart))
    found["slid by 0.15 mm, then opened"] = path(
        (held, 0), (held, 1e-5), (held, 1.5e-4), (apart, 1.5e-4)
    )
    found["opened by 0.02 mm, closed, then slid"] = path(
        (0, 0), (1e-5, 0), (2e-5, 0), (held, 0), (held, out)
    )
    found["opened and closed, further each time"] = path(
        (0, 0),
        *(
            (corner, 0)
            for amplitude in (1e-5, 2e-5, 4e-5, 8e-5, apart)
            for corner in (amplitude, held)
        ),
    )
    found["slid to and fro, further each time"] = path(
        (held, 0),
        *(
            (held, sign * amplitude)
            for amplitude in (2e-5, 5e-5, 1e-4, 2e-4, 4e-4)
            for sign in (1, -1)
        ),
    )
    return found


class Driven:
    """The joint along a path; arrays (n,): normal_stress, shear_stress [Pa] (tension, and with the
    displacement, positive), work done on it; numbers: friction, fracture, dissipated and stored at
    the end [J/m2].

    stresses: (n, 2), normal and shear; energies: friction, fracture, stored."""

    def __init__(self, path, stresses, energies):
        self.path = path
        self.normal_stress, self.shear_stress = stresses.T
        moved = np.diff(path, axis=0)
        mean = (stresses[1:] + stresses[:-1]) / 2
        self.work = np.concatenate([[0.0], np.cumsum(np.sum(moved * mean, axis=1))])
        self.friction, self.fracture, self.stored = energies
        self.at_start = 0.5 * self.normal_stress[0] * path[0, 0]

    @property
    def dissipated(self):
        """By the work done and what is stored, not by the law's own account [J/m2]."""
        return self.work[-1] + self.at_start - self.stored

    @property
    def slid(self):
        """Inelastic slip at the end of a path to one side [m]."""
        layout = pair()
        return (
            self.path[-1, 1]
            - self.shear_stress[-1] / layout.contacts.shear_stiffness[between(layout)]
        )


def drive(path, **changes):
    """The joint Driven along a path in the reference solver; changes: of JOINT."""
    layout = pair(**changes)
    area = joint_area(layout)
    wall = ReferenceWall(layout, 1e-5)
    forces = []
    for opening, shear in path:
        wall.system.place[1, :2] = shear, opening
        wall.lanes.find_forces(singly=True)
        forces.append(-wall.system.force[1, 1::-1])
    energies = wall.energy[FRICTION], wall.energy[FRACTURE], wall.elastic_energy()
    return Driven(path, np.array(forces) / area, np.array(energies) / area)


def drive_in_yade(paths, **changes):
    """{name: Driven} of the joint along paths in YADE; changes: of JOINT."""
    with tempfile.TemporaryDirectory() as folder:
        given = Path(folder) / "paths.npz"
        found = Path(folder) / "found.npz"
        np.savez(given, **paths)
        run_yade("verification/yade_paths.py", given, found, json.dumps(changes))
        with np.load(found) as results:
            return {
                name: Driven(path, results[name], results[f"{name}/energies"])
                for name, path in paths.items()
            }


def problems():
    """Fracture energies and peaks on the pure paths."""
    made = paths()

    @cache
    def in_reference(name):
        return drive(made[name])

    @cache
    def in_yade():
        pure = paths(coarse=COARSE_IN_YADE)
        return drive_in_yade({name: pure[name] for name, *_ in cases})

    def both(measure, name):
        return {
            "reference": lambda: measure(in_reference(name)),
            "yade": lambda: measure(in_yade()[name]),
        }

    tension = JOINT.mode_i_fracture_energy, "G_I", JOINT.tensile_strength, "f_t", "normal_stress"
    cases = [("tension", 0.0, *tension)]
    for pressure in PRESSURES_MPA:
        friction = 0.42e6 * pressure
        strength = JOINT.cohesion + friction, "c + p tan(phi)", "shear_stress"
        energy = JOINT.mode_ii_fracture_energy, "G_II"
        cases.append((f"shear at {pressure:g} MPa", friction, *energy, *strength))
    found = []
    for name, friction, energy, energy_name, strength, strength_name, which in cases:
        found.append(
            Problem(
                name=f"softening, {name}",
                quantity="energy dissipated beside friction",
                unit="J/m²",
                exact=energy,
                source=energy_name,
                tolerance=dict.fromkeys(SOLVERS, 1e-2),
                solvers=both(
                    lambda driven, friction=friction: driven.dissipated - friction * driven.slid,
                    name,
                ),
            )
        )
        found.append(
            Problem(
                name=f"softening, {name}",
                quantity="peak stress",
                unit="Pa",
                exact=strength,
                source=strength_name,
                tolerance=dict.fromkeys(SOLVERS, 5e-3),
                solvers=both(lambda driven, which=which: np.max(getattr(driven, which)), name),
            )
        )
    return found


class Compared(NamedTuple):
    """YADE beside the reference solver along a path: dissipated in both [J/m2], the root mean
    square of the stresses' difference over the largest stress [%], and how much the peak is higher
    in YADE [%]."""

    path: str
    reference: float
    yade: float
    stresses: float
    peak: float


def compared(fine=FINE, coarse=COARSE):
    """A Compared of every path, a list."""
    made = paths(fine, coarse)
    rows = []
    for name, here in drive_in_yade(made).items():
        there = drive(made[name])
        gaps = np.hypot(
            here.normal_stress - there.normal_stress, here.shear_stress - there.shear_stress
        )
        largest = np.max(np.hypot(np.maximum(there.normal_stress, 0), there.shear_stress))
        peak, expected = (
            max(np.max(driven.normal_stress), np.max(np.abs(driven.shear_stress)))
            for driven in (here, there)
        )
        rows.append(
            Compared(
                name,
                there.dissipated,
                here.dissipated,
                100 * np.sqrt(np.mean(gaps**2)) / largest,
                100 * (peak / expected - 1),
            )
        )
    return rows


def main():
    """Print `compared` as a table."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    print("| path | reference [J/m²] | YADE [J/m²] | more [%] | stresses [%] | peak [%] |")
    print("| --- " * 6 + "|")
    for row in compared():
        more = 100 * (row.yade / row.reference - 1)
        print(
            f"| {row.path} | {row.reference:.2f} | {row.yade:.2f} | {more:+.3f} |"
            f" {row.stresses:.3f} | {row.peak:+.3f} |"
        )


if __name__ == "__main__":
    main()
