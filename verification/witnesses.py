"""Two programs of others on dry walls: a script for an interpreter that has them.

    python -m pip install compas-lmgc90==0.1.11 compas_cra==0.8.0      # not needed by anything else
    python verification/witnesses.py < WALL.json

WALL.json: friction [-], thickness [m], blocks: [x, z of the centre, length, height] [m], levels:
multipliers of horizontal body load under which it falls, reach [m].  Prints {"lmgc90": [[level,
times [s], displacements of the centre of mass along the wall [m]], ...], "compas_cra": multiplier}.

LMGC90 is contact dynamics (Jean 1999, doi:10.1016/S0045-7825(98)00383-1): rigid blocks and Coulomb
friction without dilatancy.  The load is raised from rest to each level and held there until a block
has moved by the reach, or HOLD_S.  compas_cra (Kao et al. 2022, doi:10.1016/j.cad.2022.103216)
finds contacts, and the matrices of equilibrium and friction, of which the largest multiplier is
taken here.
"""

import contextlib
import json
import sys

import numpy as np

# the multiplier depends on neither
GRAVITY = 9.81
DENSITY = 2000.0
STEP_S = 2e-3
RAMP_S = 0.4
HOLD_S = 1.6
"""At 1e-2 s blocks of LMGC90 creep by millimetres under loads that they carry."""
NEAREST = 16  # bodies among which compas_cra seeks those in contact
CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / 2
FACES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def boxes(wall, ground):
    """Vertices (8, 3) of the ground's pieces and of every block [m]."""
    found = []
    for x, z, wide, high in [*ground, *wall["blocks"]]:
        found.append(
            [
                [x + wide * across, wall["thickness"] * through, z + high * up]
                for up in (-0.5, 0.5)
                for across, through in CORNERS
            ]
        )
    return found


def fall(wall, multiplier):
    """Times since a level was reached [s] and displacements of the centre of mass since then [m] in
    LMGC90."""
    from compas_lmgc90.solver import Solver

    solver = Solver(dt=STEP_S, density=DENSITY)
    length = max(x + wide / 2 for x, _, wide, _ in wall["blocks"])
    bodies = boxes(wall, [(length / 2, -0.1, length, 0.2)])
    solver.geometry_from_v_f([{"vertices": box, "faces": FACES} for box in bodies])
    solver.set_supports(z_threshold=0.0)
    solver.contact_law("IQS_CLB", wall["friction"])
    for block, (_, _, wide, high) in enumerate(wall["blocks"], start=1):
        force = multiplier * GRAVITY * DENSITY * wide * high * wall["thickness"]
        solver.apply_force(block, "Fx", np.array([[0.0, RAMP_S, 1e3], [0.0, force, force]]))
    solver.preprocess()
    places = []
    for _ in range(round((RAMP_S + HOLD_S) / STEP_S) + 1):
        places.append(np.array(solver.lmgc90.compute_one_step().bodies)[1:])
        if np.abs(places[-1] - places[0]).max() > wall["reach"]:
            break
    weight = np.prod(np.array(wall["blocks"])[:, 2:], axis=1)
    moved = np.array(places)[round(RAMP_S / STEP_S) :, :, 0] @ weight / weight.sum()
    return (STEP_S * np.arange(len(moved))).tolist(), (moved - moved[0]).tolist()


def bound(wall):
    """Largest multiplier in equilibrium, of the contacts, equilibrium and friction of
    compas_cra."""
    from compas_assembly.datastructures import Block
    from compas_cra.algorithms import assembly_interfaces_numpy
    from compas_cra.datastructures import CRA_Assembly
    from compas_cra.equilibrium import equilibrium_setup, friction_setup
    from scipy.optimize import linprog
    from scipy.sparse import csr_matrix, hstack

    assembly = CRA_Assembly()
    ground = [(x, -0.1, wide, 0.2) for x, z, wide, high in wall["blocks"] if z < high]
    for box in boxes(wall, ground):  # a piece under each block: contacts are sought near each body
        assembly.add_block(Block.from_vertices_and_faces(box, FACES))
    assembly.set_boundary_conditions(range(len(ground)))
    assembly_interfaces_numpy(assembly, nmax=NEAREST, amin=1e-4)
    equal = csr_matrix(equilibrium_setup(assembly))
    friction = csr_matrix(friction_setup(assembly, wall["friction"]))
    weight = np.prod(np.array(wall["blocks"])[:, 2:], axis=1)
    live, dead = np.zeros((2, len(weight), 6))
    live[:, 0] = dead[:, 2] = weight
    forces = equal.shape[1]  # normal and two of friction at each vertex of a contact
    solution = linprog(
        np.append(np.zeros(forces), -1.0),
        A_ub=hstack([friction, csr_matrix((friction.shape[0], 1))]),
        b_ub=np.zeros(friction.shape[0]),
        A_eq=hstack([equal, csr_matrix(live.reshape(-1, 1))]),
        b_eq=dead.ravel(),
        bounds=[*[(0, None), (None, None), (None, None)] * (forces // 3), (0, None)],
        method="highs-ipm",  # the simplex method does not end for 146 blocks
    )
    return float(solution.x[-1])


def main():
    wall = json.load(sys.stdin)
    with contextlib.redirect_stdout(sys.stderr):  # both programs print
        falls = [[level, *fall(wall, level)] for level in wall["levels"]]
        found = {"lmgc90": falls, "compas_cra": bound(wall)}
    print("\n" + json.dumps(found))


if __name__ == "__main__":
    main()
