"""One joint that softens, along ten paths: what it dissipates, its peaks, and the smooth law beside
its fibres.

Two bricks; the upper one is moved, without turning, and what the joint between does on it is read.
A joint pulled apart dissipates G_I, one that slides out G_II beside what friction takes, at any
pressure; the peaks are f_t and c + p tan(phi).  Where opening and sliding mix, or loading reverses,
no closed form holds: there the two forms are laid side by side (`compared`,
docs/validation/verification.md).
"""

import argparse
import json
import tempfile
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np

from damage.mechanics.tables import FRACTURE, FRICTION
from damage.reference.wall import ReferenceWall
from damage.wall.kinds import BED, GROUND
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Joint, Wall
from verification.problem import Problem, run_yade

JOINT = Joint(
    tensile_strength=0.21 / 0.24 * 0.21e6,
    cohesion=0.21e6,
    friction_angle=float(np.arctan(0.42)),
    mode_i_fracture_energy=5.0,
    mode_ii_fracture_energy=50.0,
)
"""COMP1_3's joints (walls/squat_tested.py) with fracture energies."""
PRESSURES_MPA = (0.0, 0.1, 0.3, 1.0)
FORMS = {"": 0, ", 8 fibres": 8, ", 16 fibres": 16}
"""Name -> fibres."""
NOT_IN_YADE = "its joints are fibres"
FINE, COARSE = 1500, 6000
"""Steps to the first corner, the strength and a half, and from each to the next."""
COARSE_IN_YADE = 1500
"""The same in YADE, for problems."""


def pair(fibres=0, **changes):
    """The layout of two half bricks, one on the other; changes: of JOINT."""
    return lay_out(
        Wall("pair", 0.1125, 0.15, precompression=0.0, joint=replace(JOINT, **changes)),
        ModelOptions(cells=1, fibres=fibres),
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
    layout, joint = pair(), JOINT

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
    apart, out = 4e-4, 3e-3
    held = -0.3e6 / kn
    found = {"tension": path((0, 0), (1.5 * joint.tensile_strength / kn, 0), (apart, 0))}
    for pressure in PRESSURES_MPA:
        opening, peak = -1e6 * pressure / kn, (joint.cohesion + 1e6 * pressure * 0.42) / ks
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
        moved, mean = np.diff(path, axis=0), (stresses[1:] + stresses[:-1]) / 2
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


def drive(path, fibres=0, **changes):
    """The joint Driven along a path in the reference solver; changes: of JOINT."""
    layout = pair(fibres, **changes)
    area = joint_area(layout)
    wall = ReferenceWall(layout, 1e-5)
    forces = []
    for opening, shear in path:
        wall.system.place[1, :2] = shear, opening
        wall.lanes.find_forces(singly=True)
        forces.append(-wall.system.force[1, 1::-1])
    energies = wall.energy[FRICTION], wall.energy[FRACTURE], wall.elastic_energy()
    return Driven(path, np.array(forces) / area, np.array(energies) / area)


def drive_in_yade(paths, fibres, **changes):
    """{name: Driven} of the joint along paths in YADE; changes: of JOINT."""
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder) / "paths.npz", Path(folder) / "found.npz"
        np.savez(given, **paths)
        run_yade("verification/yade_paths.py", given, found, fibres, json.dumps(changes))
        with np.load(found) as results:
            return {
                name: Driven(path, results[name], results[f"{name}/energies"])
                for name, path in paths.items()
            }


def problems():
    """Fracture energies and peaks of both forms."""
    made = paths()

    @cache
    def in_reference(name, fibres):
        return drive(made[name], fibres)

    @cache
    def all_in_yade(fibres):
        pure = paths(coarse=COARSE_IN_YADE)
        return drive_in_yade({name: pure[name] for name, *_ in cases}, fibres)

    solvers = {"reference": in_reference, "yade": lambda name, fibres: all_in_yade(fibres)[name]}

    def both(measure, name, fibres):
        measured = {
            solver: lambda along=along: measure(along(name, fibres))
            for solver, along in solvers.items()
        }
        return measured if fibres else measured | {"yade": NOT_IN_YADE}

    cases = [
        (
            "tension",
            0.0,
            JOINT.mode_i_fracture_energy,
            "G_I",
            JOINT.tensile_strength,
            "f_t",
            "normal_stress",
        )
    ]
    cases += [
        (
            f"shear at {pressure:g} MPa",
            0.42e6 * pressure,
            JOINT.mode_ii_fracture_energy,
            "G_II",
            JOINT.cohesion + 0.42e6 * pressure,
            "c + p tan(phi)",
            "shear_stress",
        )
        for pressure in PRESSURES_MPA
    ]
    found = []
    for (form, fibres), (
        name,
        friction,
        energy,
        energy_name,
        strength,
        strength_name,
        which,
    ) in product(FORMS.items(), cases):
        found.append(
            Problem(
                f"softening, {name}{form}",
                "energy dissipated beside friction",
                "J/m²",
                energy,
                energy_name,
                dict.fromkeys(solvers, 1e-2),
                both(
                    lambda driven, friction=friction: driven.dissipated - friction * driven.slid,
                    name,
                    fibres,
                ),
            )
        )
        found.append(
            Problem(
                f"softening, {name}{form}",
                "peak stress",
                "Pa",
                strength,
                strength_name,
                dict.fromkeys(solvers, 5e-3),
                both(lambda driven, which=which: np.max(getattr(driven, which)), name, fibres),
            )
        )
    return found


def compared(fine=FINE, coarse=COARSE):
    """Both forms along every path: rows of (path, dissipated by the smooth law [J/m2], and for 8
    and 16 fibres what they dissipate more [%], and the root mean square of the stresses' difference
    over the largest stress [%])."""
    rows = []
    for name, path in paths(fine, coarse).items():
        smooth, *others = (drive(path, fibres) for fibres in FORMS.values())
        rows.append([name, smooth.dissipated])
        for other in others:
            rows[-1] += _beside(other, smooth)
    return rows


def compared_in_yade(fine=FINE, coarse=COARSE):
    """YADE's fibres along every path beside the reference's: rows of (path, and for 8 and 16 fibres
    dissipated in YADE [J/m2], how much more that is [%], the stresses' difference as in `compared`
    [%], and the peak's [%])."""
    made = paths(fine, coarse)
    rows = {name: [name] for name in made}
    for fibres in filter(None, FORMS.values()):
        for name, here in drive_in_yade(made, fibres).items():
            there = drive(made[name], fibres)
            peaks = [
                max(np.max(of.normal_stress), np.max(np.abs(of.shear_stress)))
                for of in (here, there)
            ]
            rows[name] += [here.dissipated, *_beside(here, there), 100 * (peaks[0] / peaks[1] - 1)]
    return list(rows.values())


def _beside(other, one):
    """What one Driven dissipates more than another along the same path [%], and the root mean
    square of the stresses' difference over the largest stress [%]."""
    gaps = np.hypot(other.normal_stress - one.normal_stress, other.shear_stress - one.shear_stress)
    largest = np.max(np.hypot(np.maximum(one.normal_stress, 0), one.shear_stress))
    return 100 * (other.dissipated / one.dissipated - 1), 100 * np.sqrt(np.mean(gaps**2)) / largest


def main():
    """Print `compared`, or with --yade `compared_in_yade`, as a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--yade", action="store_true", help="YADE's fibres beside the reference solver's"
    )
    if parser.parse_args().yade:
        print(
            "| path | 8 fibres: dissipated [J/m²] | more [%] | stresses [%] | peak [%] "
            "| 16 fibres: dissipated [J/m²] | more [%] | stresses [%] | peak [%] |\n"
            + "| --- " * 9
            + "|"
        )
        for name, *numbers in compared_in_yade():
            cells = [
                f"{number:{form}}"
                for number, form in zip(numbers, 2 * (".2f", "+.2f", ".2f", "+.2f"))
            ]
            print("| " + " | ".join([name, *cells]) + " |")
        return
    print(
        "| path | dissipated, smooth law [J/m²] | 8 fibres [%] | 16 fibres [%] | stresses, 8 fibres"
        " [%] | 16 fibres [%] |"
    )
    print("| --- " * 6 + "|")
    for name, dissipated, more_8, gap_8, more_16, gap_16 in compared():
        print(
            f"| {name} | {dissipated:.2f} | {more_8:+.1f} | {more_16:+.1f} | {gap_8:.1f} |"
            f" {gap_16:.1f} |"
        )


if __name__ == "__main__":
    main()
