"""Walls in larger units beside the same walls in bricks: what changes, and what a run costs.

    python3 -m paper coarse_units [WALL ...]

Fronts of weak clay with fracture energies, on ground that settled by hogging of 1/1500, under the
strong part of a record of Zeerijp of 3.2 cm/s, times 2: first period; elastic stiffness under a
horizontal load in proportion to mass, base shear over displacement of the drift course; at the end
the damage index, Psi, widest crack, number and length of cracks from 0.1 mm, before and after the
motion; processor time.
"""

import time
from dataclasses import replace

import numpy as np
from scipy.sparse.linalg import spsolve

import damage
from damage.index import THRESHOLD
from damage.law.modes import natural_modes, stiffness_matrix
from damage.measure.cracks import psi_history
from damage.measure.summary import summarise
from damage.units import MILLIMETRE
from damage.wall.coarser import coarser
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from paper.bench import BGAR, arguments, option, print_row, print_table

WALLS = "terrace_end", "two_storeys", "calcium_silicate"
UNITS = (1, 1), (2, 2), (2, 3), (3, 3)
JOINT = {
    "tensile_strength": 0.112e6,
    "cohesion": 0.119e6,
    "mode_i_fracture_energy": 5.6,
    "mode_ii_fracture_energy": 102.0,
}
RUN = {
    "record": BGAR,
    "scale": 2.0,
    "window": (18.5, 20.5),
    "rest": 0.2,
    "settle": "hogging",
    "distortion": 1 / 1500,
    "settling": "adaptive",
}


def stiffness(layout):
    """Base shear over the displacement of the drift course under a horizontal load in proportion to
    mass [N/m], elastic."""
    load = np.zeros((len(layout.bodies), 3))
    load[:, 0] = layout.bodies.mass
    moved = spsolve(stiffness_matrix(layout).tocsc(), load.ravel()).reshape(load.shape)
    return load.sum() / moved[layout.drift_bodies, 0].mean()


def cracks_of(row):
    """Psi, widest crack [mm], number and length [m] of cracks of a row of `psi_history`, in
    words."""
    return (
        f"{row['psi']:.1f}; {row['max_width_m'] / MILLIMETRE:.2f}; {row['cracks']:.0f};"
        f" {row['crack_length_m']:.1f}"
    )


def show(name):
    """Print the rows of a wall."""
    for units in UNITS:
        wall = load_wall(name)
        wall = replace(wall, joint=replace(wall.joint, **JOINT))
        layout = lay_out(coarser(wall, *units), ModelOptions(supports="bricks"))
        began = time.process_time()
        history = damage.run(wall, units=units, **RUN)
        cracks = psi_history(history, THRESHOLD)
        took = time.process_time() - began
        print_row(
            wall.name,
            "{} x {}".format(*units),
            layout.n_joints,
            f"{1e3 * natural_modes(layout, 1).period_s[0]:.1f}",
            f"{stiffness(layout) / 1e6:.2f}",
            f"{summarise(history)['residual']['DI']:.3f}",
            cracks_of(cracks[cracks["time_s"] <= 0].iloc[-1]),
            cracks_of(cracks.iloc[-1]),
            f"{took:.0f}",
        )


def main():
    asked = arguments(__doc__, option("walls", nargs="*", default=WALLS, metavar="WALL"))
    print_table(
        "wall",
        "units",
        "contact points",
        "T1 [ms]",
        "stiffness [kN/mm]",
        "damage index",
        "settled: Psi; widest [mm]; cracks; length [m]",
        "shaken: the same",
        "processor [s]",
    )
    for one in asked.walls:
        show(one)
