"""Spandrels and walls that were loaded again and again, beside Korswagen's tests (2024): tables of
docs/validation/repeated-loading.md.

    python3 -m paper repeated_loading [spandrels] [laws] [walls] [solvers] [summary]
        # docs/tables/benchmarks/repeated_*.csv; all by default

`solvers` needs YADE; `summary` makes the tables beside the tests of the others: run it last.

A spandrel in inverted four-point bending: two supports push it up near its middle, its top is held
down near its ends. A wall is pushed to a drift and back, one way and then two ways.  Both are
steered by displacement; the force at each repetition is that at the amplitude.
"""

import math
import os
import subprocess
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pandas as pd

from damage import Joint, Opening, Wall, brick_of_masonry
from damage.linear.modes import natural_modes
from damage.measure.cracks import PSI_FROM, crack_table, psi
from damage.mechanics.tables import RIGID, Z
from damage.reference.solver import ReferenceSolver
from damage.run.schedule import SOFTENING_STEP_FACTOR
from damage.wall.geometry import joint_table, tributary_ends
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from paper.bench import REPOSITORY, arguments, chosen, option
from yade_scripts import COMMAND

OUT = REPOSITORY / "docs" / "tables" / "benchmarks"
REPETITIONS = 30
BETA_S = 1e-6
COV = 0.35


class Masonry(NamedTuple):
    """modulus [Pa]; tensile_strength, cohesion [Pa]; friction [-]; energies: G_I, G_II [J/m2];
    brick: length, height, thickness with the mortar's share [m]; density [kg/m3]."""

    modulus: float
    tensile_strength: float
    cohesion: float
    friction: float
    energies: tuple
    brick: tuple
    density: float = 1650.0


CLAY = Masonry(3.6e9, 0.16e6, 0.17e6, 0.82, (11.3, 210.0), (0.2183, 0.0589, 0.100))
SILICATE = Masonry(4.0e9, 0.16e6, 0.17e6, 0.82, (11.3, 210.0), (0.2223, 0.0806, 0.102), 1800.0)
"""Clay as tabulated; calcium silicate has no tabulated properties: those of clay, and a modulus of
its own."""


def parts_of(masonry):
    """The Brick and the softening Joint of a Masonry; an apex beyond f_t, which the law needs,
    keeps the tensile strength."""
    strength = min(masonry.tensile_strength, masonry.cohesion / masonry.friction)
    joint = Joint(
        tensile_strength=strength,
        cohesion=masonry.cohesion,
        friction_angle=math.atan(masonry.friction),
        mode_i_fracture_energy=masonry.energies[0],
        mode_ii_fracture_energy=masonry.energies[1],
    )
    return (
        brick_of_masonry(
            masonry.modulus,
            joint,
            **dict(zip(("length", "height", "thickness"), masonry.brick)),
            density=masonry.density,
        ),
        joint,
    )


class Specimen:
    """A wall in the reference solver that is moved by displacement; `force` [N] and `measure` [m]
    are its readings."""

    def __init__(self, layout):
        self.layout = layout
        self._segments = tributary_ends(joint_table(layout))
        modes = natural_modes(layout, 1)
        self._make_wall(SOFTENING_STEP_FACTOR * modes.critical_time_step_s)

    def _make_wall(self, time_step):
        self.wall = ReferenceSolver(self.layout, time_step, beta=BETA_S)
        self.wall.damp(local=0.7, beta=BETA_S)

    def advance(self, time_s):
        """Let time pass."""
        self.wall.run(max(1, round(time_s / self.wall.time_step)))

    def cracks(self):
        """{"widest_um": widest crack [micrometres], "psi": Psi [-]} at present, without the joints
        on the base; NaN and 0 where nothing has cracked."""
        off_base = self._segments[:, 0, 1] > 0
        table = crack_table(
            self._segments[off_base],
            self.wall.opening[off_base],
            self.wall.offset[off_base],
            PSI_FROM,
        )
        return {"widest_um": 1e6 * table["width_m"].max(), "psi": psi(table)}


class Spandrel(Specimen):
    """supports_m, loads_m: distances between the two supports in the middle of its base, and
    between the two places at its top that are held down."""

    def __init__(self, masonry, courses, bricks, supports_m, loads_m, seed):
        brick, joint = parts_of(masonry)
        wall = Wall(
            "spandrel",
            bricks * brick.length,
            courses * brick.height,
            precompression=0.0,
            brick=brick,
            joint=joint,
        )
        super().__init__(
            lay_out(
                wall,
                ModelOptions(
                    supports="bricks",
                    contacts="gauss",
                    cells=2,
                    strength_cov=COV,
                    strength_seed=seed,
                ),
            )
        )
        middle = wall.length / 2
        bodies = self.layout.bodies
        supports = self.layout.supports
        self._pushed = [
            int(np.argmin(np.abs(supports.x - middle - side * supports_m / 2))) for side in (-1, 1)
        ]
        top = np.flatnonzero(bodies.course == bodies.course.max())
        held = [
            top[np.argmin(np.abs(bodies.x[top] - middle - side * loads_m / 2))] for side in (-1, 1)
        ]
        near = np.argsort(np.abs(bodies.x[top] - middle))[:4]
        self._ends = top[
            [near[np.argmin(bodies.x[top][near])], near[np.argmax(bodies.x[top][near])]]
        ]
        self._drop(np.array([k for k in range(len(self.layout.supports)) if k not in self._pushed]))
        self.advance(0.05)
        self._hold(held)
        self._zero = self._reading()

    def _drop(self, supports):
        """Let supports be far below."""
        self.wall.system.place[len(self.layout.bodies) + supports, Z] -= 0.05
        self.wall.refresh()

    def _hold(self, bodies):
        """Keep bodies at their height."""
        for body in bodies:
            self.wall.system.inverse_mass[body, Z] = self.wall.system.velocity[body, Z] = 0.0

    def _reading(self):
        first, second = self._ends
        return self._places()[second, 0] - self._places()[first, 0]

    def _places(self):
        return self.wall.displacement

    @property
    def measure(self):
        """CMOD over the middle of the top course [m]."""
        return self._reading() - self._zero

    @property
    def force(self):
        """Upward force of both supports [N]."""
        return -float(self.wall.support_force[self._pushed, 1].sum())

    def move(self, speed):
        """Speed of the supports upwards [m/s]."""
        velocities = np.zeros((len(self.layout.supports), RIGID))
        velocities[self._pushed, Z] = speed
        self.wall.move_supports(velocities)


SPEED = 4e-3
LOOK_S = 5e-5
STEPS_M = (50e-6, 100e-6, 150e-6)
UNLOADED_N = 2e3
TOO_FAR_S = 1.0


def until(specimen, speed, reached):
    """Move until `reached()`; returns the largest force [N], None where that takes too long."""
    specimen.move(speed)
    largest = -math.inf
    time_s = 0.0
    while not reached():
        specimen.advance(LOOK_S)
        time_s += LOOK_S
        largest = max(largest, specimen.force)
        if time_s > TOO_FAR_S:
            return None
    return largest


def repeated(specimen, amplitudes=STEPS_M, repetitions=REPETITIONS, speed=SPEED):
    """Table of a protocol, unloaded to UNLOADED_N: amplitude and what is left of it unloaded
    [micrometres], repetition, force [N] at the amplitude and largest force on the way, and
    `cracks`."""
    rows = []
    for amplitude in amplitudes:
        for repetition in range(1, repetitions + 1):
            largest = until(
                specimen, speed, lambda amplitude=amplitude: specimen.measure >= amplitude
            )
            if largest is None:
                return pd.DataFrame(rows)
            rows.append(
                {
                    "amplitude_um": 1e6 * amplitude,
                    "repetition": repetition,
                    "force_n": specimen.force,
                    "largest_n": largest,
                    **specimen.cracks(),
                }
            )
            if until(specimen, -speed, lambda: specimen.force <= UNLOADED_N) is None:
                return pd.DataFrame(rows)
            rows[-1]["unloaded_um"] = 1e6 * specimen.measure
    return pd.DataFrame(rows)


# --- walls ----------------------------------------------------------------------------------------

WINDOW = Opening(left=0.66, width=0.78, height=1.51, sill=0.66)
DRIFT = 0.27e-3
WALL_SPEED = 8e-3
WALL_REPETITIONS = 15


class PushedWall(Specimen):
    """A wall of 3.07 x 2.69 m with a window, a cantilever under 0.12 MPa, whose beam on top is
    moved."""

    def __init__(self, masonry, seed):
        brick, joint = parts_of(masonry)
        wall = Wall(
            "wall",
            3.07,
            2.69,
            openings=[WINDOW],
            precompression=0.12e6,
            brick=brick,
            joint=joint,
            lintel="concrete",
        )
        super().__init__(
            lay_out(
                wall,
                ModelOptions(
                    top="beam", contacts="gauss", cells=2, strength_cov=COV, strength_seed=seed
                ),
            )
        )
        self.advance(0.3)
        self.wall.hold(self.layout.pushed_bodies, rotation=False)
        self._zero = self.wall.displacement[self.layout.pushed_bodies[0], 0]

    @property
    def measure(self):
        """Displacement of the beam [m]."""
        return self.wall.displacement[self.layout.pushed_bodies[0], 0] - self._zero

    @property
    def force(self):
        """Force on the beam [N]."""
        return self.wall.push_force()

    def move(self, speed):
        """Speed of the beam [m/s]."""
        self.wall.push(speed)


def pushed(specimen, protocol, drift):
    """Rows of a protocol, "one-way" or "two-way": force [N] at the amplitude in each repetition,
    both ways, and `cracks`."""
    amplitude = drift * specimen.layout.wall.height
    rows = []
    for repetition in range(1, WALL_REPETITIONS + 1):
        until(specimen, WALL_SPEED, lambda: specimen.measure >= amplitude)
        rows.append(
            {
                "protocol": protocol,
                "drift": drift,
                "repetition": repetition,
                "plus_n": specimen.force,
                **specimen.cracks(),
            }
        )
        if protocol == "two-way":
            until(specimen, -WALL_SPEED, lambda: specimen.measure <= -amplitude)
            rows[-1]["minus_n"] = specimen.force
            until(specimen, WALL_SPEED, lambda: specimen.measure >= 0)
        else:
            until(specimen, -WALL_SPEED, lambda: specimen.measure <= 0)
    return rows


SPANDRELS = {"clay": (CLAY, 9, 6, 0.388, 0.803), "calcium silicate": (SILICATE, 7, 6, 0.398, 0.819)}


def spandrels():
    """All repetitions of spandrels, three draws."""
    tables = [
        repeated(Spandrel(*SPANDRELS[name], seed)).assign(material=name, draw=seed)
        for seed in (1, 2, 3)
        for name in SPANDRELS
    ]
    pd.concat(tables).to_csv(OUT / "repeated_spandrels.csv", index=False, float_format="%.6g")


STRONG = 10.0
"""Factor on G_II of the joints that slip hardly consumes."""


def laws():
    """What takes the force: clay spandrels whose joints slip does not consume, brittle ones, and a
    slower test."""
    first, second = CLAY.energies
    cases = {
        "as tabulated": (CLAY, SPEED),
        "a quarter of the speed": (CLAY, SPEED / 4),
        "ten times G_II": (CLAY._replace(energies=(first, STRONG * second)), SPEED),
        "ten times G_I": (CLAY._replace(energies=(STRONG * first, second)), SPEED),
        "brittle": (CLAY._replace(energies=(None, None)), SPEED),
    }
    tables = []
    for name, (masonry, speed) in cases.items():
        specimen = Spandrel(masonry, *SPANDRELS["clay"][1:], 1)
        tables.append(repeated(specimen, STEPS_M[:2], speed=speed).assign(case=name, draw=1))
        pd.concat(tables).to_csv(OUT / "repeated_laws.csv", index=False, float_format="%.6g")


def walls():
    """All repetitions of clay walls, first one way, then two ways."""
    specimen = PushedWall(CLAY, 1)
    tables = []
    for step, protocol in product((1.0, 2.0), ("one-way", "two-way")):
        tables.append(pd.DataFrame(pushed(specimen, protocol, step * DRIFT)).assign(draw=1))
        pd.concat(tables).to_csv(OUT / "repeated_walls.csv", index=False, float_format="%.6g")


COMPARED = 4
"""Repetitions of the smallest spandrel in both solvers."""


def compared(kind):
    """Table of the smallest spandrel in its first step; kind: Spandrel or a subclass."""
    return repeated(kind(*SPANDRELS["calcium silicate"], 1), STEPS_M[:1], COMPARED)


def solvers():
    """The smallest spandrel in both solvers."""
    with TemporaryDirectory() as made:
        subprocess.run(
            [*COMMAND, Path(__file__).with_name("spandrel_in_yade.py"), Path(made) / "yade.csv"],
            check=True,
            env={**os.environ, "PYTHONPATH": str(REPOSITORY)},
        )
        tables = [
            compared(Spandrel).assign(solver="reference"),
            pd.read_csv(Path(made) / "yade.csv").assign(solver="yade"),
        ]
    pd.concat(tables).to_csv(OUT / "repeated_solvers.csv", index=False, float_format="%.6g")


TESTED = {
    "clay": ("18 to 29", "110 to 740", "15 to 21"),
    "calcium silicate": ("29 to 35", "90 to 190", "13 to 15"),
}
"""Tests of the spandrels of three steps of 30 repetitions: peak force [kN]; CMOD at it
[micrometres], of clay of all; force lost in the mean of the steps [%] (P. A. Korswagen,
dissertation, TU Delft, 2024, tables 3.1, 3.2 and 6.1.1)."""
TESTED_WALLS = {"one-way": "-16 to -51", "two-way": "+4 to -13, -57 to +1"}
"""Change of the force by a repetition [N], of two ways each."""
TESTED_GROWTH = {"one-way": "none in the first step, slight beyond", "two-way": "more than one-way"}
"""Growth of a width at equal amplitude, in words of the source, which tabulates none (sections
3.2.3 and 6.1.2)."""
TESTED_PSI = "small increase in general, in places a decrease"
"""Growth of Psi of walls (figure 6.1.4 and its text)."""


def summary():
    """The tables beside the tests, from the tables of all repetitions."""
    spandrels, walls = (
        pd.read_csv(OUT / f"repeated_{name}.csv") for name in ("spandrels", "walls")
    )
    rows = [
        row
        for material, tables in spandrels.groupby("material")
        for row in of_spandrels(material, tables)
    ]
    rows += [
        row
        for case, table in walls.groupby(["drift", "protocol"], sort=False)
        for row in of_wall(*case, table)
    ]
    pd.DataFrame(rows, columns=["case", "quantity", "model", "test"]).to_csv(
        OUT / "repeated_loading.csv", index=False
    )
    laws = pd.read_csv(OUT / "repeated_laws.csv")
    pd.DataFrame(
        [
            {
                "joints": name,
                "CMOD [µm]": f"{step:g}",
                "first force [kN]": f"{force.iloc[0] / 1e3:.3g}",
                **{
                    f"after {count}": f"{force.iloc[count - 1] / force.iloc[0]:.2f}"
                    for count in (2, 5, 10, 30)
                },
            }
            for (name, step), force in laws.groupby(["case", "amplitude_um"], sort=False)["force_n"]
        ]
    ).to_csv(OUT / "repeated_causes.csv", index=False)


def of_spandrels(material, tables):
    """Rows of the spandrels of a material: ranges over the draws, of steps their mean."""
    found = []
    for _, one in tables.groupby("draw"):
        highest = one.loc[one["largest_n"].idxmax()]
        force, left, psis = (
            one.pivot_table(index="amplitude_um", columns="repetition", values=name)
            for name in ("force_n", "unloaded_um", "psi")
        )
        found.append(
            (
                highest["largest_n"] / 1e3,
                highest["amplitude_um"],
                100 * (1 - force[REPETITIONS] / force[1]).mean(),
                100 * (1 - force[REPETITIONS] / force[2]).mean(),
                (left[REPETITIONS] - left[1]).mean(),
                (psis[REPETITIONS] - psis[1]).mean(),
            )
        )
    quantities = (
        "peak force [kN]",
        "CMOD at the peak [µm], steps of 50",
        "force lost in 30 repetitions [%]",
        "... of that after the second [%]",
        "growth of CMOD at 2 kN in 30 repetitions [µm]",
        "growth of Psi at equal CMOD in 30 repetitions",
    )
    for quantity, values, tested in zip(quantities, zip(*found), (*TESTED[material], "", "", "")):
        yield f"spandrels, {material}", quantity, f"{min(values):.3g} to {max(values):.3g}", tested


def of_wall(drift, protocol, table):
    """Rows of the wall in a protocol."""
    last = table["repetition"].max() - 1
    case = f"wall, clay, {protocol}"
    at = f"at {1e3 * drift:.2g} per mil"
    change = [
        (abs(table[side].iloc[-1]) - abs(table[side].iloc[0])) / last
        for side in ("plus_n", "minus_n")
        if table[side].notna().all()
    ]
    yield (
        case,
        f"change a repetition {at} [N]",
        ", ".join(f"{one:+.0f}" for one in change),
        TESTED_WALLS[protocol],
    )
    ends = table[["widest_um", "psi"]].iloc[[0, -1]].to_numpy().T
    if np.isnan(ends).any():  # cracks were not followed in it
        return
    yield (
        case,
        f"widest crack {at}, repetitions 1 and {last + 1} [µm]",
        ", ".join(f"{one:.0f}" for one in ends[0]),
        TESTED_GROWTH[protocol],
    )
    yield (
        case,
        f"Psi {at}, repetitions 1 and {last + 1}",
        ", ".join(f"{one:.2f}" for one in ends[1]),
        TESTED_PSI,
    )


def main():
    tables = {table.__name__: table for table in (spandrels, laws, walls, solvers, summary)}
    asked = arguments(
        __doc__, option("tables", nargs="*", metavar="TABLE", help=", ".join(tables))
    ).tables
    for name in chosen(asked, tables, "table"):
        tables[name]()
