"""Elastic walls: the period of a stack, and the stiffness of a cantilever wall as bricks get finer.

A stack of n bricks: u, w and rotation of each, springs k_n, k_s a length between them.  Joint i
connects the top of brick i (its arm h/2 upwards) with the bottom of brick i + 1, so the joint's
shear displacement is
u' - u + (theta' + theta) h/2 and its closing turn theta' - theta against the sum of k_n x^2; the
vertical motion is a problem of its own.

A wall of running bond, bricks b x h rigid, joints with stiffness k_n, k_s an area (bed: n, s; head:
s_h).  Under a shear gamma = g_1 + g_2 (u = g_1 z, w = g_2 x) a brick may turn by theta; the bed
joints then shear by
(g_1 + theta) h and open by +-(g_2 - theta) b/2, the head joints shear by (g_2 - theta) b.  The
energy is least with both parts in series:

    1/G = 1/(k_s h) + 1/(k_n b^2/(4 h) + k_s,head b),       E_z = k_n h

and a cantilever of length H loaded at its end by F is Timoshenko's beam, u/F = H^3/(3 E I) + H/(5/6
G A).  Cells at the interior leave the bed joint's own bending stiffness a little too low; it
vanishes as bricks get finer, and so do the base's half layer and the bricks' own rotation.
"""

import math

import numpy as np
from scipy.linalg import eigh
from scipy.sparse.linalg import splu

from damage.linear.modes import natural_modes, stiffness_matrix
from damage.measure.cycles import natural_period
from damage.reference.wall import ReferenceWall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Wall
from verification.problem import of_both

UNBREAKABLE = Joint(tensile_strength=1e15, cohesion=1e15)
STACK = Wall("stack", 0.1125, 10 * 0.075, joint=UNBREAKABLE, precompression=0.0)
STACK_S = 0.25
WALL_LENGTH = 0.9
WALL_HEIGHT = 4.5
"""Slender, so that the clamped end counts for little."""
FINER = (1, 2, 4)
_LOAD_N = 1.0
_MOST_MOVES = 20


def problems():
    """First period of a stack of ten; end stiffness of a cantilever wall with bricks of full, half,
    quarter size."""
    stack = lay_out(STACK)
    exact = stack_period(stack)
    limit = beam_stiffness()
    rows = [
        of_both(
            "stack of ten bricks",
            "first period",
            "s",
            exact,
            "dense eigenvalue problem of the module",
            1e-3,
            lambda: free_period(stack),
            "stack",
        )
    ]
    for finer, tolerance in zip(FINER, (0.01, 0.003, 0.001)):
        name = f"cantilever, bricks of 1/{finer}" if finer > 1 else "cantilever, whole bricks"
        rows.append(
            of_both(
                name,
                "force for 1 m at the end",
                "N/m",
                limit,
                "Timoshenko beam, moduli of the module",
                tolerance,
                lambda finer=finer: end_stiffness(finer),
                "cantilever",
                float(finer),
            )
        )
    return rows


# --- a stack -------------------------------------------------------------------------------------


def stack_period(layout):
    """First period [s] of a stack by its own dense matrices, without gravity."""
    bodies = layout.bodies
    contacts = layout.contacts
    n = len(bodies)
    height = float(bodies.height[0])
    stiffness = np.zeros((2 * n, 2 * n))  # u, theta of every brick
    for upper in range(n):
        mine = contacts.second == upper
        area = contacts.area[mine]
        shear = float((contacts.shear_stiffness[mine] * area).sum())
        arm = contacts.x[mine] - bodies.x[upper]
        turning = float((contacts.normal_stiffness[mine] * area * arm**2).sum())
        # Rotation from x towards z: the bottom of a brick moves by +theta h/2, its top by -theta
        # h/2.
        slide = np.zeros(2 * n)
        turn = np.zeros(2 * n)
        slide[2 * upper : 2 * upper + 2] = 1.0, height / 2
        turn[2 * upper + 1] = 1.0
        if upper > 0:
            slide[2 * upper - 2 : 2 * upper] = -1.0, height / 2
            turn[2 * upper - 1] = -1.0
        stiffness += shear * np.outer(slide, slide) + turning * np.outer(turn, turn)
    mass = np.column_stack([bodies.mass, bodies.inertia]).ravel()
    return 2 * math.pi / math.sqrt(eigh(stiffness, np.diag(mass), eigvals_only=True)[0])


def free_period(layout):
    """Period [s] of the stack's free vibration, weightless."""
    modes = natural_modes(layout, 1)
    wall = ReferenceWall(layout, 0.3 * modes.critical_time_step_s)
    wall.start(np.zeros((0, 2)), np.zeros(1))
    wall.velocity = 1e-3 * modes.shape[0]
    track = []
    for _ in range(round(STACK_S / wall.time_step / 20)):
        wall.run(20)
        track.append(wall.displacement[layout.drift_bodies, 0].mean())
    return natural_period(20 * wall.time_step * np.arange(len(track)), np.array(track))


# --- a cantilever --------------------------------------------------------------------------------


def cantilever(finer):
    """Layout of the wall with bricks of 1/finer of their size, whose moduli stay the same."""
    brick = Brick(length=0.225 / finer, height=0.075 / finer)
    joint = Joint(
        normal_stiffness=finer * UNBREAKABLE.normal_stiffness,
        shear_stiffness=finer * UNBREAKABLE.shear_stiffness,
        tensile_strength=1e15,
        cohesion=1e15,
    )
    return lay_out(
        Wall("cantilever", WALL_LENGTH, WALL_HEIGHT, brick=brick, joint=joint), ModelOptions()
    )


def running_bond(brick, joint):
    """E_z and G [Pa] of running bond, by the module's formulas."""
    bed_n = 1 / (1 / joint.normal_stiffness + brick.height / brick.young_modulus)
    bed_s = 1 / (1 / joint.shear_stiffness + brick.height / brick.shear_modulus)
    head_s = 1 / (1 / joint.shear_stiffness + brick.length / brick.shear_modulus)
    shear = 1 / (
        1 / (bed_s * brick.height)
        + 1 / (bed_n * brick.length**2 / (4 * brick.height) + head_s * brick.length)
    )
    return bed_n * brick.height, shear


def beam_stiffness():
    """Force over displacement of the end [N/m]: Timoshenko's beam up to the cap's middle, rigid
    above the wall."""
    wall = cantilever(1).wall
    brick = wall.brick
    modulus, shear = running_bond(brick, wall.joint)
    inertia = brick.thickness * WALL_LENGTH**3 / 12
    area = brick.thickness * WALL_LENGTH
    beyond = float(cantilever(1).bodies.z[-1]) - WALL_HEIGHT
    # A force beyond the end: the end's displacement and rotation by force and moment, and the rigid
    # arm.
    length = WALL_HEIGHT
    bending = modulus * inertia
    flexibility = (length**3 / 3 + length**2 * beyond + length * beyond**2) / bending + length / (
        5 / 6 * shear * area
    )
    return 1 / flexibility


def end_stiffness(finer):
    """Force over displacement of the cap [N/m]: pushed in time for whole bricks, at rest by
    `balance` for finer."""
    layout = cantilever(finer)
    cap = len(layout.bodies) - 1
    wall = ReferenceWall(layout, 0.6 * natural_modes(layout, 1).critical_time_step_s)
    wall.start(np.zeros((0, 2)), np.zeros(1))
    if finer > 1:
        return balance(layout, lambda move: _forces_after(wall, move))
    wall.adaptive_damping = 1.0
    wall.hold(np.array([cap]), rotation=False)
    steps = round(0.05 / wall.time_step)
    wall.push(1e-6 / (steps * wall.time_step))
    wall.run(steps)
    wall.push(0.0)
    wall.run(10 * steps)
    return wall.push_force() / wall.displacement[cap, 0]


def balance(layout, forces_after):
    """Force over displacement of the last body [N/m], where a solver's own contact forces balance a
    load on it.

    forces_after(move): moves the bodies on by (n_bodies, 3) and returns the contacts' forces on
    them, alike. The next move comes from a stiffness matrix, which only speeds this up: where it
    ends, the solver alone says.
    """
    solve = splu(stiffness_matrix(layout).tocsc()).solve
    load = np.zeros((len(layout.bodies), 3))
    load[-1, 0] = _LOAD_N
    total = np.zeros_like(load)
    rest = load
    for _ in range(_MOST_MOVES):
        move = solve(rest.ravel()).reshape(-1, 3)
        total += move
        if abs(move[-1, 0]) < 1e-6 * abs(total[-1, 0]):
            return _LOAD_N / total[-1, 0]
        rest = load + forces_after(move)
    raise RuntimeError(
        f"no balance after {_MOST_MOVES} moves; the last one was {move[-1, 0]:.3g} m"
    )


def _forces_after(wall, move):
    """Forces on the bodies of a ReferenceWall after a move (n_bodies, 3)."""
    wall.displacement += move
    return wall.force[:-1]
