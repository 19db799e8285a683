"""A wall as a model for OpenSeesPy: a Python script of rigid bricks on interface elements.

A brick is a node with mass; a contact point is two nodes in one place, tied rigidly to the nodes of
its bodies, with an element between them.  No element of OpenSees has this project's joint law; two
in turn have it:

    intact bond    `zeroLength` with elastic springs of k_n A and k_s A
    failed joint   `flatSliderBearing`: no tension, |shear| <= tan(phi) times the present normal
                   force, by a return mapping; opening resets its slip

The script replaces one by the other where, after a step, the normal force exceeds f_t A or the
shear force reaches c A - tan(phi) N.  The slider begins at the shear displacement that the bond
had, which was elastic.

Commands: https://opensees.github.io/OpenSeesDocumentation and https://openseespydoc.readthedocs.io.
"""

import math

from damage.errors import InputError
from damage.files import write_text
from damage.law.modes import contact_normals
from damage.provenance import commit
from damage.units import GRAVITY
from damage.version import VERSION

_SCRIPT = '''"""{made}

OpenSeesPy (pip install openseespy). Units: N, m, kg, s; x along the wall, y up. Displacements are
small. `build()` makes the model, `weight()` loads it, `static` and `transient` advance an analysis
and break joints.
"""

from math import inf

import openseespy.opensees as ops

GRAVITY = {gravity}
FRICTION = {friction}  # coefficient
BODIES = [  # node, x, y [m], mass [kg], moment of inertia [kg m2]
{bodies}
]
JOINTS = [
    # element, first body or 0 for the ground, second body, x, y [m], normal from first to second;
    # times the area of the joint: normal and shear stiffness [N/m], tensile strength, cohesion [N]
{joints}
]
TOP = {top}  # bodies whose mean displacement is that of the top
INTACT = {{}}  # element: (its two nodes, unit normal, stiffnesses, strengths)


def build():
    """Make the model, all joints intact."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for node, x, y, mass, inertia in BODIES:
        ops.node(node, x, y)
        ops.mass(node, mass, mass, inertia)
    ops.frictionModel("Coulomb", 1, FRICTION)
    ops.uniaxialMaterial("Elastic", 1, 0.0)  # no moment
    INTACT.clear()
    for joint, first, second, x, y, nx, ny, kn, ks, tension, cohesion in JOINTS:
        ends = len(BODIES) + 2 * joint - 1, len(BODIES) + 2 * joint
        for node, body in zip(ends, (first, second)):
            ops.node(node, x, y)
            if body:
                ops.rigidLink("beam", body, node)
            else:
                ops.fix(node, 1, 1, 1)
        ops.uniaxialMaterial("Elastic", 2 * joint, kn)
        ops.uniaxialMaterial("Elastic", 2 * joint + 1, ks)
        ops.element("zeroLength", joint, *ends, "-mat", 2 * joint, 2 * joint + 1, "-dir", 1, 2,
                    "-orient", nx, ny, 0.0, -ny, nx, 0.0)
        INTACT[joint] = ends, (nx, ny), (kn, ks), (tension, cohesion)


def break_joints():
    """Replace elements of joints beyond their strength by sliders; returns how many failed."""
    failed = []
    for joint, (ends, (nx, ny), (kn, ks), (tension, cohesion)) in INTACT.items():
        (x1, y1, _), (x2, y2, _) = map(ops.nodeDisp, ends)
        normal = kn * ((x2 - x1) * nx + (y2 - y1) * ny)
        shear = ks * ((y2 - y1) * nx - (x2 - x1) * ny)
        if normal > tension or abs(shear) >= cohesion - FRICTION * normal:
            failed.append(joint)
    for joint in failed:
        ends, (nx, ny), (kn, ks), _ = INTACT.pop(joint)
        ops.remove("element", joint)
        ops.element("flatSliderBearing", joint, *ends, 1, ks, "-P", 2 * joint, "-Mz", 1,
                    "-orient", nx, ny, 0.0, -ny, nx, 0.0, "-iter", 50, 1e-2)
    return len(failed)


def solver(tolerance, algorithm="KrylovNewton"):
    """What all analyses have in common; tolerance: of the unbalanced forces [N]; algorithm: in
    time, "Newton"."""
    ops.wipeAnalysis()
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("UmfPack")
    ops.test("NormUnbalance", tolerance, 100)
    ops.algorithm(algorithm)


def static(steps, integrator, *words):
    """Static steps; words: of the integrator, the increment last.  False where one found no
    equilibrium."""
    for _ in range(steps):
        increment = words
        while True:
            ops.integrator(integrator, *increment)
            ops.analysis("Static")
            if ops.analyze(1):
                return False
            if not break_joints():
                break
            increment = *words[:-1], 0.0  # the same load, without the joints that failed
    return True


def transient(steps, dt):
    """Steps in time, of an integrator that was chosen before.  False where one found no
    equilibrium."""
    for _ in range(steps):
        if ops.analyze(1, dt):
            return False
        break_joints()
    return True


def weight(steps=10):
    """Apply the weight, then hold it."""
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for node, _, _, mass, _ in BODIES:
        ops.load(node, 0.0, -GRAVITY * mass, 0.0)
    solver(1e-8 * GRAVITY * sum(mass for _, _, _, mass, _ in BODIES))
    found = static(steps, "LoadControl", 1 / steps)
    ops.loadConst("-time", 0.0)
    return found


def top(direction=1):
    """Mean displacement of the top [m]: 1 along x, 2 up."""
    return sum(ops.nodeDisp(node, direction) for node in TOP) / len(TOP)


if __name__ == "__main__":
    build()
    found = weight()
    mass, failed = sum(mass for _, _, _, mass, _ in BODIES), len(JOINTS) - len(INTACT)
    print(f"mass {{mass:.3f}} kg, settlement {{-top(2):.6e}} m, "
          f"{{failed}} of {{len(JOINTS)}} contact points failed" if found else "no equilibrium")
'''


def write_opensees(layout, path):
    """Write a damage.wall.layout.Layout of rigid bricks as a script for OpenSeesPy; returns the
    path.

    Raises InputError for bricks, joints or soil that it cannot have, and where the path cannot be
    written.
    """
    _check_rigid(layout)
    wall, bodies = layout.wall, layout.bodies
    rows = (
        (k + 1, *values)
        for k, values in enumerate(zip(bodies.x, bodies.z, bodies.mass, bodies.inertia))
    )
    return write_text(
        path,
        _SCRIPT.format(
            made=_made_by(layout),
            gravity=GRAVITY,
            friction=_number(math.tan(wall.joint.friction_angle)),
            bodies=_table(rows),
            joints=_table(_joints(layout)),
            top=[int(k) + 1 for k in layout.drift_bodies],
        ),
    )


def _check_rigid(layout):
    """Raise InputError where a Layout has what rigid blocks on brittle joints lack."""
    joint, options = layout.wall.joint, layout.options
    problems = (
        (
            layout.strain is not None,
            "deformable bricks with strain modes",
            "rigid ones; leave --bricks deformable out",
        ),
        (
            joint.softens,
            "joints that soften",
            "brittle ones; take the wall's fracture energies out",
        ),
        (
            joint.compressive_strength is not None,
            "joints that crush",
            "none; take the compressive strength out",
        ),
        (layout.wall.restraints, "restraints of its edges", "free ones; take the restraints out"),
        (
            options.soil_velocity > 0,
            "soil with radiation damping",
            "soil without it; leave --soil-velocity out",
        ),
    )
    for found, what, expected in problems:
        if found:
            raise InputError(
                f"--opensees of wall {layout.wall.name} with {what}: expected {expected}"
            )


def _made_by(layout):
    """One line: the wall, its choices, and what wrote it."""
    return (
        f"Wall {layout.wall.name} ({', '.join(layout.options.tags()) or 'usual model'}), written by"
        f" masonry-damage {VERSION}, commit {commit()}."
    )


def _joints(layout):
    """Rows of JOINTS, one a contact point."""
    contacts = layout.contacts
    forces = (
        getattr(contacts, name) * contacts.area
        for name in ("normal_stiffness", "shear_stiffness", "tensile_strength", "cohesion")
    )
    (nx, nz), ends = (
        contact_normals(contacts).T,
        [[max(int(body) + 1, 0) for body in of] for of in (contacts.first, contacts.second)],
    )
    return zip(range(1, len(contacts) + 1), *ends, contacts.x, contacts.z, nx, nz, *forces)


def _number(value):
    """The shortest text of a number that is read back exactly; integers have no point.

    >>> _number(0.1), _number(3), _number(float("inf"))
    ('0.1', '3', 'inf')
    """
    return repr(value.item() if hasattr(value, "item") else value)


def _table(rows):
    return "\n".join(f"    ({', '.join(map(_number, row))})," for row in rows)
