"""Houses in YADE beside what is known by hand; the last line printed is JSON, {check: figures}.

yade tests/yade/checks/space.py block box ...      several of them, of those without numbers

yade tests/yade/checks/space.py block              a dry block rocks about an edge of its face
yade tests/yade/checks/space.py box                four walls stay symmetric
yade tests/yade/checks/space.py corner 0.44 0.48   a dry front, toothed into two side walls, under
                                                   these horizontal accelerations [g] in turn
yade tests/yade/checks/space.py tilt               a house turns with its ground
yade tests/yade/checks/space.py dry                its energies while it slides
yade tests/yade/checks/space.py bonded             the same with bonds: which fail first, and when
yade tests/yade/checks/space.py ties               two blocks with a tie: share of a push, force at
                                                   which it pulls out or buckles, energy
yade tests/yade/checks/space.py masonries          two dry blocks of other friction slide, or rest
yade tests/yade/checks/space.py strip 5e4 0.96 1   a strip between floors bends out of plane, of
                                                   this tensile strength [Pa], under accelerations
                                                   [g], beside the plane model
"""

import json
import math
import os
import sys
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[3]))  # YADE does not look here by itself

import numpy as np
from scipy.sparse.linalg import spsolve
from yade import O, Quaternion, Vector3

from damage import Brick, Joint, ModelOptions, Wall
from damage.house.house import Corner, Diaphragm, House, Placed
from damage.house.layout import lay_out_house
from damage.house.ties import Ties
from damage.linear.modes import natural_modes, stiffness_matrix
from damage.reference.solver import ReferenceSolver
from damage.run.solver import NO_MOTION
from damage.units import GRAVITY
from damage.wall.kinds import SLAB_COURSE
from damage.wall.layout import lay_out
from damage.wall.restraints import Restraint
from yade_scripts.solver import YadeSolver

BRICK = Brick(0.4, 0.2, 0.2)
STRONG = Joint(tensile_strength=1e6, cohesion=1e6)
SIZE = {"height": 0.8, "precompression": 0, "brick": BRICK, "joint": STRONG}
"""Size of the walls of box and tilt."""


def solver_of(house, options=None, share=1 / 3):
    """Its YadeSolver, at rest, with a step of this share of the critical one."""
    layout = lay_out_house(house, options)
    return YadeSolver(layout, share * natural_modes(layout, 1).critical_time_step_s)


def settle(solver, seconds=0.05):
    """Let a solver come to rest under its weight."""
    solver.damp(local=0.7)
    solver.start(NO_MOTION, np.array([GRAVITY]))
    go(solver, seconds)


def go(solver, seconds, on_samples=None):
    """Advance a solver of any kind, to a sample where one is asked for."""
    steps = int(seconds / solver.time_step)
    asked = (steps, on_samples) if on_samples else ()
    for one, *some in solver.advance(steps, *asked) or ():
        one.run(*some)


def rising(solver, multiplier, columns=3):
    """Acceleration of the base [m/s2] over 0.8 s, which comes in 0.3 s."""
    share = np.minimum(np.arange(int(0.8 / solver.time_step)) * solver.time_step / 0.3, 1.0)
    base = np.zeros((len(share), columns))
    base[:, 0] = multiplier * GRAVITY * share**2 * (3 - 2 * share)
    return base


def continued(solver, gravity):
    """Another solver that takes over from the checkpoint of one; gravity [m/s2]."""
    tables = solver.checkpoint()
    other = YadeSolver(solver.layout, solver.time_step)
    other.start(NO_MOTION, np.array([gravity]))
    other.restore(tables)
    return other


def quarter_period(thickness, height, angle):
    """Time [s] in which a rigid block on an edge falls back from an angle [rad] to upright, by its
    equation of motion, in steps of a microsecond.  thickness, height: of the block [m]."""
    alpha = math.atan(thickness / height)
    rate = 3 * GRAVITY / (2 * math.hypot(thickness, height))  # m g R / I about the edge
    time = 0.0
    speed = 0.0
    step = 1e-6
    while angle > 0:
        speed -= step * rate * math.sin(alpha - angle)
        angle += step * speed
        time += step
    return time


def block():
    """Quarter period [s] of 0.1 x 1 m on two that are held, released from 0.4 of the angle at which
    it would fall, by YADE and by its equation of motion; and by how much the largest opening, out
    of reach of the contacts at first, differs from thickness times angle [m].  Half-way another
    solver takes over from a checkpoint: which contacts were out of reach then, and at the end."""
    thick = 0.1
    high = 1.0
    brick = Brick(length=0.4, height=high, thickness=thick, young_modulus=1e14, shear_modulus=1e14)
    joint = Joint(1e11, 4e10, tensile_strength=0, cohesion=0)
    wall = Wall(
        "block", 0.4, 2 * high, base_course="half", precompression=0, brick=brick, joint=joint
    )
    solver = solver_of(House("block", [Placed(wall, direction=37)]))
    alpha = math.atan(thick / high)
    angle = 0.4 * alpha
    axes = solver.layout.of_body[0]
    *below, state = solver.scene.states
    for half in below:
        half.blockedDOFs = "xyzXYZ"
    foot = Vector3(*axes[1]) * -thick / 2 + Vector3(*(axes[0] * 0.2)) + Vector3(0, 0, high)
    turn = Quaternion(Vector3(*axes[0]), angle)
    state.pos = foot + turn * (state.pos - foot)
    state.ori = turn * state.ori
    for joint in range(solver.layout.n_joints):  # dry from the start
        solver.tracker.breaks(joint, "tension", 0.0, 0.0)
        solver.model.loosen(joint)
    solver.start(NO_MOTION, np.array([GRAVITY]))
    times = []
    angles = []
    gaps = []

    def look(now):
        times.append(float(now.clock[0]) * O.dt)
        angles.append(float(now.out_of_plane[0, -1, 1]))
        gaps.append(now.contacts["opening_m"].max() - thick * math.sin(angles[-1]))
        return angles[-1] > 0 or len(times) < 3

    solver.advance(int(0.1 / O.dt), 10, look)
    gone = sorted(solver.model.gone)
    solver = continued(solver, GRAVITY)
    solver.advance(int(0.25 / O.dt), 10, look)
    quarter = np.interp(0.0, angles[:-3:-1], times[:-3:-1])
    gap = float(np.abs(gaps[2:]).max())
    left = sorted(solver.model.gone)
    return {
        "quarter_s": float(quarter),
        "exact_s": quarter_period(thick, high, angle),
        "gap_m": gap,
        "gone": [gone, left],
    }


def box():
    """A box of four walls, toothed, with a slab and anchored joists, without weight, 400 steps
    after its base began to move along x: largest displacement [m], what mirrored bricks differ by
    over it, kinetic and elastic energy over the work that came in, and momentum [N s] beside the
    impulse of the ground and of the inertia forces."""
    fronts = [Placed(Wall(name, 1.2, **SIZE), (0, y)) for name, y in (("front", 0), ("back", 1.0))]
    sides = [
        Placed(Wall(name, 1.2, base_course="half", **SIZE), (x, -0.1), 90)
        for name, x in (("left", 0.1), ("right", 1.1))
    ]
    corners = [
        Corner((one.wall.name, other.wall.name), "toothed") for one in fronts for other in sides
    ]
    names = tuple(one.wall.name for one in fronts + sides)
    floors = [
        Diaphragm(0.4, names, 300, "concrete"),
        Diaphragm(0.8, ("left", "right"), 50, anchor_spacing=0.4),
    ]
    solver = solver_of(House("box", fronts + sides, corners, floors))
    seen = []
    base = np.zeros((401, 3))
    base[:, 0] = GRAVITY * np.sin(2 * np.pi * np.arange(401) / 200)
    solver.start(base, np.zeros(1))
    solver.advance(400, 1, lambda now: seen.append(now) or True)
    now = seen[-1]
    layout = solver.layout
    moved = np.column_stack([now.displacement[0], now.out_of_plane[0]])
    moved = np.einsum("ni,nij->nj", moved[:, [0, 3, 1]], layout.of_body)
    force = np.array([one.support_force[0, 0, 0] for one in seen])
    force += layout.total_mass * base[:, 0][: len(force)]
    speed = np.array([state.vel[0] for state in solver.scene.states])
    place = layout.centres
    mirrored = place * [1, -1, 1] + [0, 1.0, 0]
    twin = [np.abs(place - one).sum(axis=1).argmin() for one in mirrored]
    size = np.abs(moved).max()
    return {
        "largest_m": float(size),
        "asymmetry": float(np.abs(moved[twin] * [1, -1, 1] - moved).max() / size),
        "balance": float((now.kinetic_j + now.elastic_j)[0] / now.input_j[0]),
        "momentum": float(layout.bodies.mass @ speed),
        "impulse": -O.dt * float(np.sum(force[1:-1]) + force[0] / 2),
    }


def front_between(joint):
    """The House of a front between two side walls, which moves across it."""
    size = SIZE | {"joint": joint, "brick": replace(BRICK, density=2000.0)}
    front = Wall("front", 1.2, **size)
    sides = [Wall(name, 1.0, base_course="half", **size) for name in ("left", "right")]
    return House(
        "corner",
        [Placed(front)] + [Placed(one, (x, -0.1), 90) for one, x in zip(sides, (0.1, 1.1))],
        [Corner(("front", one.name), "toothed") for one in sides],
        heading=90,
    )


def dry():
    """Energies of a dry front that slides between two side walls, over the work that came in: all
    energies, that of friction, and what YADE's own sum lacks of it."""
    solver = solver_of(front_between(Joint(5e9, 2e9, math.atan(0.7), 0, 0)))
    seen = []
    solver.start(NO_MOTION, np.array([GRAVITY]))
    solver.advance(300)
    steps = 2500
    base = np.zeros((steps, 3))
    base[:, 0] = 1.5 * GRAVITY * np.sin(2 * np.pi * np.arange(steps) * O.dt / 0.05)
    solver.start(base, np.array([GRAVITY]))
    solver.advance(steps - 500, 500, lambda now: seen.append(now) or True)
    first = seen[0]
    last = seen[-1]
    names = "kinetic_j", "elastic_j", "friction_j", "fracture_j", "input_j"
    kinetic, elastic, friction, fracture, given = (
        float((getattr(last, name) - getattr(first, name))[0]) for name in names
    )
    raised = (last.displacement - first.displacement)[0, :, 1]
    lifted = GRAVITY * float(solver.layout.bodies.mass @ raised)
    work = solver.model.work
    return {
        "balance": (kinetic + elastic + lifted + friction + fracture) / given,
        "friction": friction / given,
        "left_out": (work.total - work._law.plasticDissipation()) / given,
    }


def tilt():
    """What bodies and joints of two walls below a slab are off a rigid rotation, which the ground
    and they have at first, about a place before the house and across its heading of 30 degrees:
    displacement, and opening or shear, over the largest displacement [-]; another solver takes over
    half-way."""
    walls = [Placed(Wall(name, 0.8, **SIZE), (0, y)) for name, y in (("a", 0), ("b", 1))]
    slab = Diaphragm(0.8, ("a", "b"), 300, "concrete", 0.2)
    house = House("pair", walls, floors=[slab], heading=30)
    solver = solver_of(house, ModelOptions(supports="bricks"))
    layout = solver.layout
    scene = solver.scene
    rate = 1e-3
    axis = np.array([*scene.push_axis])
    about = rate * np.cross(axis, [0.0, 0.0, 1.0])
    start = layout.ground_left.min() * axis
    of_body = layout.of_body
    place = layout.centres
    speed = np.einsum("nij,nj->ni", of_body, np.cross(about, place - start))
    along, across, _ = (of_body @ about).T
    solver.set_velocities(
        np.column_stack([speed[:, 0], speed[:, 2], -across, speed[:, 1], along, 0 * along])
    )
    solver.start(NO_MOTION, np.zeros(1))
    ground = layout.ground.x
    solver.move_supports(np.column_stack([0 * ground, rate * ground, rate + 0 * ground]))
    solver.advance(200)
    solver = continued(solver, 0.0)
    solver.advance(200)
    expected = 400 * O.dt * np.cross(about, place - start)
    moved = np.array([tuple(state.pos) for state in solver.scene.states]) - place
    opening, shear = solver.scene.displacements(np.arange(layout.n_joints), solver._supports)
    largest = np.abs(expected).max()
    return {
        "moved": float(np.abs(moved - expected).max() / largest),
        "opening": float(max(np.abs(opening).max(), np.abs(shear).max()) / largest),
    }


def elastic_stresses(layout, direction):
    """Normal stress, and both shear stresses, of all joints under forces of the size of the bodies'
    weight in this direction in the house (n_joints, 3) [Pa]."""
    contacts = layout.contacts
    along, across, up = np.einsum("nij,j->in", layout.of_body, direction)
    force = np.zeros((len(layout.bodies), 6))
    force[:, [0, 3, 1]] = np.column_stack([along, across, up]) * GRAVITY
    force *= layout.bodies.mass[:, None]
    moved = spsolve(stiffness_matrix(layout).tocsc(), force.ravel()).reshape(force.shape)
    moved = np.vstack([moved, np.zeros(6)])  # the ground
    found = []
    stiffnesses = contacts.normal_stiffness, contacts.shear_stiffness, contacts.shear_stiffness
    for rows, stiffness in zip(layout.directions, stiffnesses):
        apart = [
            (row * moved[end]).sum(axis=1)
            for row, end in zip(rows, (contacts.first, contacts.second))
        ]
        found.append(stiffness * sum(apart))
    return np.column_stack(found)[: layout.n_joints]


def bonded():
    """Acceleration [g] at which the first bond fails, its wall, -1 between two, and its place [m],
    as it grows to 3 g in 0.6 s; and the same by the elastic stresses under it and the weight."""
    joint = Joint(5e9, 2e9, math.atan(0.7), tensile_strength=2e4, cohesion=3e4)
    solver = solver_of(front_between(joint))
    layout = solver.layout
    steps = int(0.6 / O.dt)
    weight, push = (elastic_stresses(layout, one) for one in ([0, 0, -1.0], [0, -1.0, 0]))
    for least in np.arange(0.0, 3.0, 0.001):
        normal, *shear = (weight + least * push).T
        fails = normal > joint.tensile_strength
        limit = joint.cohesion - np.minimum(normal, 0.0) * math.tan(joint.friction_angle)
        fails |= np.hypot(*shear) > limit
        if fails.any():
            break
    found = {"elastic": _failure(layout, least, np.flatnonzero(fails)[0])}
    settle(solver)
    base = np.zeros((steps, 3))
    base[:, 0] = 3 * GRAVITY * np.arange(steps) / steps
    solver.start(base, np.array([GRAVITY]))
    events = []
    while not events and solver.clock < steps:
        solver.advance(50)
        events = solver.drain_events()
    step, first, kind, *_ = events[0]
    return found | {"yade": _failure(layout, 3 * step / steps, first), "kind": kind}


def _failure(layout, multiplier, joint):
    return {
        "multiplier": float(multiplier),
        "wall": int(layout.contacts.wall[joint]),
        "place": np.round(layout.contacts.place[joint], 3).tolist(),
        "upright": bool(layout.contacts.upright[joint]),
    }


def corner(*multipliers):
    """Whether a front of 1.2 x 0.8 m between side walls of 1.0 m falls: speed of its top [mm/s],
    and how many bricks have moved, after 0.8 s under each acceleration."""
    house = front_between(Joint(5e9, 2e9, math.atan(0.7), 0, 0))
    found = {}
    for multiplier in multipliers:
        solver = solver_of(house)
        settle(solver)
        solver.start(rising(solver, multiplier), np.array([GRAVITY]))
        for _ in range(8):
            go(solver, 0.1)
            moved = solver.scene.motion()[:, 3]
            if np.abs(moved).max() > 0.03:
                break
        front_top = solver.layout.wall_drift_bodies[0]
        speed = max(abs(solver.scene.states[body].vel[1]) for body in front_top)
        found[multiplier] = {"speed_mm_s": 1e3 * speed, "moved": int(np.sum(np.abs(moved) > 2e-3))}
    return found


THICK = 0.2
HIGH = 2.4
WIDE = 0.4
DENSITY = 2000.0
"""Sizes and density of a strip [m, kg/m3]."""


def strips(strength):
    """Solvers of a strip of 12 courses below a floor as heavy as it, which moves with the base; in
    YADE a house, in the reference solver a plane wall as long as the strip is thick."""
    joint = Joint(1e11, 4e10, math.atan(0.75), strength, 2 * strength)
    rigid = {"density": DENSITY, "young_modulus": 1e14, "shear_modulus": 1e14}
    common = {"precompression": 0, "joint": joint}
    load = DENSITY * HIGH  # [kg/m2]
    wall = Wall("strip", WIDE, HIGH + 0.2, brick=Brick(WIDE, 0.2, THICK, **rigid), **common)
    slab = Diaphragm(HIGH + 0.2, ("strip",), load, "concrete", 0.2)
    space = solver_of(House("strip", [Placed(wall)], floors=[slab], heading=90))
    for floor in np.flatnonzero(space.layout.bodies.course == SLAB_COURSE):
        space.scene.states[floor].blockedDOFs = "xyXYZ"
    common |= {"precompression": load * GRAVITY, "restraints": [Restraint("top")]}
    wall = Wall("strip", THICK, HIGH, brick=Brick(WIDE, 0.2, WIDE, **rigid), **common)
    layout = lay_out(wall, ModelOptions(contacts="corners", cells=9))
    step = natural_modes(layout, 1).critical_time_step_s / 3
    return {"yade": space, "plane": ReferenceSolver(layout, step)}


def strip(strength, *multipliers):
    """Results of each solver under each acceleration: speed at mid-height [mm/s] after 0.8 s or at
    20 mm, {height of a bed joint [m]: face, -1 or 1, where it is open by a third of the most}, and
    {height: acceleration [g] at its first failure}."""
    return {
        f"{name} {multiplier:g}": _bent(solver, multiplier)
        for multiplier in multipliers
        for name, solver in strips(strength).items()
    }


def _bent(solver, multiplier):
    layout = solver.layout
    moved = [0.0]
    seen = []
    failed = {}
    contacts = layout.contacts
    middle = np.abs(layout.bodies.z - HIGH / 2).argmin()
    settle(solver)
    base = rising(solver, multiplier, layout.MOTION_AXES)
    solver.start(base, np.array([GRAVITY]))
    solver.drain_events()
    while solver.clock < len(base) - 0.01 / solver.time_step and abs(moved[-1]) < 0.02:
        go(solver, 0.01, lambda now: seen.append(now) or True)
        now = seen[-1]
        motion = now.out_of_plane if layout.IN_SPACE else now.displacement
        moved.append(float(motion[-1, middle, 0]))
        for step, joint, *_ in solver.drain_events():
            at = round(float(contacts.z[joint]), 2)
            failed.setdefault(at, round(float(base[min(step, len(base) - 1), 0] / GRAVITY), 2))
    opening = np.zeros(layout.n_joints)
    opening[now.joints] = now.contacts["opening_m"][-1]
    y = contacts.y if layout.IN_SPACE else contacts.x - THICK / 2
    wide = np.flatnonzero((opening > opening.max() / 3) & ~contacts.upright[: layout.n_joints])
    wide = wide[np.argsort(np.abs(y[wide]))]  # faces last, which stay
    return {
        "speed_mm_s": 1e2 * 1e3 * (moved[-1] - moved[-2]),
        "open": {round(float(contacts.z[one]), 2): float(np.sign(y[one])) for one in wide},
        "failed": failed,
    }


def leaves(share=1 / 3):
    """Solver of two blocks on the ground, 0.2 m apart, with a tie between their middles, and the
    compliance of one there [m/N], by sliding and rocking."""
    size = 0.4
    thick = 0.1
    high = 0.2
    joint = Joint(1e10, 4e9, tensile_strength=1e7, cohesion=1e7)
    brick = Brick(size, high, thick, young_modulus=1e14, shear_modulus=1e14)
    walls = [
        Placed(Wall(name, size, high, precompression=0, brick=brick, joint=joint), (0, y), 0)
        for name, y in (("inner", 0), ("outer", 0.2))
    ]
    ties = Ties(("inner", "outer"), 6.25, TIE_N_M, tension=1000, compression=500)
    area = size * thick
    compliance = 1 / (4e9 * area) + (high / 2) ** 2 / (1e10 * area * thick**2 / 12)
    return solver_of(House("leaves", walls, ties=[ties]), share=share), compliance


def masonries():
    """How far [mm] two dry blocks with a friction of 0.4 and 0.6 slide in 0.2 s under 0.5 g, and
    the one with less by hand."""
    size = {"length": 0.4, "height": 0.2, "precompression": 0}
    walls = []
    for y, friction in ((0, 0.6), (1, 0.4)):
        joint = Joint(1e10, 4e9, math.atan(friction), tensile_strength=0, cohesion=0)
        brick = Brick(0.4, 0.2, 0.2, density=4000 * friction)
        walls.append(Placed(Wall(f"block-{y}", brick=brick, joint=joint, **size), (0, y)))
    solver = solver_of(House("masonries", walls))
    settle(solver, 0.02)
    solver.damp()
    steps = round(0.2 / O.dt)
    base = np.zeros((steps, 3))
    base[:, 0] = 0.5 * GRAVITY
    solver.start(base, np.array([GRAVITY]))
    before = solver.scene.motion()[:, 0]
    solver.advance(steps)
    moved = 1e3 * (before - solver.scene.motion()[:, 0])
    return {"moved_mm": moved.tolist(), "exact_mm": 1e3 * 0.5 * 0.1 * GRAVITY * 0.2**2}


TIE_N_M = 1e7


def ties():
    """Share of a push on one block that the tie carries to the other, and the forces [N] at which
    it fails, away and towards, beside two springs and a third; and energies [J] over those at the
    start, of a block that was knocked away, before and after the tie has failed."""
    found = {}
    for name, sign in (("tension", 1), ("compression", -1)):
        solver, compliance = leaves()
        solver.damp(local=0.7)
        solver.start(NO_MOTION, np.zeros(1))
        force = 0.0
        share = 0.0
        while solver.ties.failed == 0:
            share = float(solver.ties.forces()[0]) * sign / force if force else 0.0
            force += 50.0
            O.forces.setPermF(solver.model.clumps[1], (0, sign * force, 0))
            solver.advance(150)
        exact = TIE_N_M * compliance / (1 + 2 * TIE_N_M * compliance)
        found[name] = {"share": share, "exact_share": exact, "force_n": force}
        found[name]["exact_n"] = (1000 if sign > 0 else 500) / exact
    solver, _ = leaves(1 / 20)
    speed = np.zeros((2, 6))
    speed[1, 3] = 0.5
    solver.set_velocities(speed)
    solver.start(NO_MOTION, np.zeros(1))
    energies = []

    def look(now):
        energies.append(float((now.kinetic_j + now.elastic_j + now.fracture_j)[0]))
        return True

    solver.advance(1000, 1, look)
    energies = np.array(energies) / (0.5 * solver.layout.bodies.mass[1] * 0.5**2)
    return found | {"energies": [energies.min(), energies.max()], "failed": solver.ties.failed}


CHECKS = {
    "block": block,
    "box": box,
    "corner": corner,
    "bonded": bonded,
    "masonries": masonries,
    "strip": strip,
    "dry": dry,
    "ties": ties,
    "tilt": tilt,
}
names = [word for word in sys.argv[1:] if word in CHECKS]
numbers = map(float, sys.argv[1 + len(names) :])
print(json.dumps({name: CHECKS[name](*numbers) for name in names}))
sys.stdout.flush()
os._exit(0)
