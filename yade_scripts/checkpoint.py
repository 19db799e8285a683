"""The state of a YadeSolver as arrays: a scene of YADE, and what this package keeps beside it.

YADE's scene (`O.save`) lacks the forces on the bodies, the depths of the contacts, the sum of the
work of friction, and interactions that are removed; these are put back, so that the next step is
that of the run that was interrupted. Potential interactions of loose bricks are found anew, which
may change the order of sums.
"""

import tempfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from yade import O, Vector3, utils

from damage.errors import InputError

_PARTS = {
    "tracker": (
        "opening",
        "slip",
        "offset",
        "broken",
        "at_limit",
        "crushed",
        "ended",
        "_open",
        "_stress",
        "_plastic",
        "friction_energy",
        "breaking_energy",
        "fracture_energy",
    ),
    "crushing": ("_strength", "_limit", "_near"),
    "bonds.tables": ("laws", "slid", "states"),
    "scene": (
        "normal_stiffness",
        "follows",
        "holding",
        "_breaks_seen",
        "_passed",
        "on_top",
    ),
    "model": ("signs", "bonded", "closure"),
    "model.work": ("_rest",),
    "machine": ("velocity", "place", "rest"),
    "bearing": ("slip", "friction_j"),
    "": (
        "_supports",
        "_support_velocity",
        "_armed",
        "_input_power",
        "_input_time",
        "_input_energy",
        "clock",
    ),
}
"""Arrays, lists of numbers and numbers of each part of a solver; arrays keep their identity."""
_ENGINES = "NewtonIntegrator", "ForceResetter", "InsertionSortCollider", "InteractionLoop"
"""Engines of the model, which a scene brings along; all others are those of this process."""
_KINDS = "tension", "shear", "opened", "slipped"


def tables_of(solver):
    """Everything that the next steps of a YadeSolver depend on, {name: array}."""
    model = solver.model
    work = solver.model.work
    watched, watching = work.tables()
    return {
        "scene": _saved_scene(),
        "loads": _loads(),
        "forces": _forces(),
        **{table: np.array(getattr(owner, name)) for owner, name, table in _attributes(solver)},
        **{f"passed_{kind}": passed.copy() for kind, passed in solver.tracker._passed.items()},
        "members": _pairs(
            (k, member) for k, members in enumerate(model.members) for member in members
        ),
        "corners": np.array(sorted(model.corners), int),
        "tips": _pairs(model._tip_of.items()),
        "bonds": _pairs((bond.id1, bond.id2) for bond in model.bonds),
        "removed": _removed(solver),
        "gone": np.array(sorted(model.gone), int),
        "slid": np.array(work._law.plasticDissipation()),
        "watched": watched,
        "watching": watching,
        "events": (
            np.array(
                [
                    (step, joint, _KINDS.index(kind), *values, *[0.0] * (4 - len(values)))
                    for step, joint, kind, *values in solver._events
                ],
                float,
            ).reshape(-1, 7)
        ),
    }


def restore(solver, tables):
    """Put a solver of the same layout back to where `tables_of` was; raises InputError where the
    tables are of another."""
    try:
        _load_scene(tables["scene"], solver)
        for owner, name, table in _attributes(solver):
            _set(owner, name, tables[table])
        for kind, passed in solver.tracker._passed.items():
            passed[:] = tables[f"passed_{kind}"]
        _put_forces(tables["loads"], tables["forces"])
        _bind(solver, tables)
        solver.bonds.gather()
        solver._events = [
            (int(step), int(joint), _KINDS[int(kind)], *values)
            for step, joint, kind, *values in tables["events"].tolist()
        ]
        solver._tags = O.tags
    except (KeyError, IndexError, ValueError, AttributeError, TypeError, RuntimeError) as error:
        raise InputError(
            f"the checkpoint's scene cannot be read by this YADE ({error}); expected one that the"
            " same wall left, and the same version of YADE; run it again"
        ) from error


def _attributes(solver):
    """What _PARTS names: (part, attribute, name of its table) of each that the solver has."""
    for path, names in _PARTS.items():
        part = solver
        for step in filter(None, path.split(".")):
            part = getattr(part, step)
        yield from ((part, name, f"{path}.{name}") for name in names if hasattr(part, name))


def _set(owner, name, values):
    """Set an attribute to values: in place where it is an array."""
    old = getattr(owner, name)
    if isinstance(old, np.ndarray) and old.shape:
        old[...] = values
    elif isinstance(old, list):
        setattr(owner, name, values.tolist())
    else:
        setattr(owner, name, values if values.shape else type(old)(values))


def _pairs(pairs):
    return np.array(list(pairs), int).reshape(-1, 2)


def _saved_scene():
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yade"
        O.save(str(path), quiet=True)
        return np.frombuffer(path.read_bytes(), "u1")


def _load_scene(scene, solver):
    """Load a scene, of whose engines those of the model alone, and hand these to the model."""
    engines = list(O.engines)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yade"
        path.write_bytes(scene.tobytes())
        O.load(str(path), quiet=True)
    loaded = {_kind_of(engine): engine for engine in O.engines}
    O.engines = [
        loaded[_kind_of(engine)] if _kind_of(engine) in _ENGINES else engine for engine in engines
    ]
    model = solver.model
    model.newton = loaded["NewtonIntegrator"]
    model.law, model.work._law = loaded["InteractionLoop"].lawDispatcher.functors[:2]
    model._material = O.materials["tip"]


def _kind_of(engine):
    return type(engine).__name__


def _loads():
    """Number, force [N] and torque [N m] of each body that is not erased, (n_bodies, 7).  Clumps
    have those of a top that is held or restrained, all others are on their members."""
    return np.array(
        [(body.id, *O.forces.f(body.id, True), *O.forces.t(body.id, True)) for body in O.bodies]
    )


def _forces():
    """Rows of the interactions: bodies, normal and shear force [N], (n, 8)."""
    return np.array(
        [(i.id1, i.id2, *i.phys.normalForce, *i.phys.shearForce) for i in O.interactions]
    ).reshape(-1, 8)


def _put_forces(loads, forces):
    """Set all forces, after an evaluation of the contacts, which gives them their geometry at the
    present positions; it moves nothing and breaks no bond."""
    loop = next(engine for engine in O.engines if _kind_of(engine) == "InteractionLoop")
    dt = O.dt
    O.dt = 0.0
    law = loop.lawDispatcher.functors[0]
    # Bonds at their limits may fail in it by rounding; they and YADE's counts are restored.
    bonds = [
        (i.phys, i.phys.FnMax, i.phys.FsMax)
        for i in O.interactions
        if getattr(i.phys, "isCohesive", False)
    ]
    cracks = law.nbTensCracks, law.nbShearCracks
    loop()
    law.nbTensCracks, law.nbShearCracks = cracks
    for physics, normal_limit, shear_limit in bonds:
        physics.FnMax = normal_limit
        physics.FsMax = shear_limit
        physics.isCohesive = True
    O.dt = dt
    O.forces.f(0, True)  # without this the next does not reset
    O.forces.reset()
    for first, second, *force in forces.tolist():
        phys = O.interactions[int(first), int(second)].phys
        phys.normalForce = Vector3(force[:3])
        phys.shearForce = Vector3(force[3:])
    for body, *load in loads.tolist():
        if any(load):
            O.forces.addF(int(body), Vector3(load[:3]))
            O.forces.addT(int(body), Vector3(load[3:]))


def _removed(solver):
    """Rows of the contact points whose interaction is removed, which YADE would make again where
    its members touch: number, depth [m], stiffnesses [N/m], coefficient of friction, normal and
    shear force [N], (n, 11)."""
    scene = solver.scene
    return np.array(
        [
            (
                *(k, geom.penetrationDepth, phys.kn, phys.ks),
                getattr(phys, "tangensOfFrictionAngle", 0.0),  # none of a tie
                *(*phys.normalForce, *phys.shearForce),
            )
            for k, (bond, geom, phys) in enumerate(
                zip(solver.model.bonds, scene.geometries, scene.physics)
            )
            if not _is_there(bond)
        ]
    ).reshape(-1, 11)


def _is_there(bond):
    return O.interactions.has(bond.id1, bond.id2) and O.interactions[bond.id1, bond.id2].isReal


def _bind(solver, tables):
    """Have a solver read the bodies and interactions of the scene that was loaded."""
    model = solver.model
    scene = solver.scene
    work = solver.model.work
    for number, (first, second) in enumerate(tables["bonds"].tolist()):
        if O.interactions.has(first, second):
            bond = O.interactions[first, second]
            scene.geometries[number] = bond.geom
            scene.physics[number] = bond.phys
        else:
            bond = utils.createInteraction(first, second, virtualI=True)
        model.bonds[number] = bond
    for number, depth, kn, ks, friction, *forces in tables["removed"].tolist():
        slid = Vector3.Zero
        normal = Vector3(forces[:3])
        shear = Vector3(forces[3:])
        scene.geometries[int(number)] = SimpleNamespace(penetrationDepth=depth, shearInc=slid)
        scene.physics[int(number)] = SimpleNamespace(
            kn=kn,
            ks=ks,
            tangensOfFrictionAngle=friction,
            normalForce=normal,
            shearForce=shear,
            isCohesive=False,
        )
    model.gone = set(tables["gone"].tolist())
    for number, members in enumerate(model.members):
        members[:] = tables["members"][tables["members"][:, 0] == number, 1].tolist()
    model.corners.clear()
    model.corners.update(tables["corners"].tolist())
    model._tip_of = dict(tables["tips"].tolist())
    model.turning[:] = [
        O.bodies[model.faces[body, "box"]].state for body in range(len(model.clumps))
    ]
    scene.states[:] = [O.bodies[clump].state for clump in model.clumps]
    contacts = dict(enumerate(zip(scene.geometries, scene.physics)))
    work.watch_again(
        contacts,
        tables["watched"].tolist(),
        tables["watching"].tolist(),
        float(tables["slid"]),
    )
