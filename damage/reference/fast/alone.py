"""Fast step of a single wall: a vector holds eight of its bodies, or of its interfaces."""

from damage.mechanics import interfaces
from damage.mechanics.eight import add, bits, load, spread, store
from damage.mechanics.samples import observe
from damage.mechanics.tables import DAMPING
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX, NONE, ONE, WIDTH, clear, pack, total, unpack
from damage.reference.fast.bodies import ALL, adapt, move
from damage.reference.fast.compiled import compiled, entry, inlined
from damage.reference.fast.interfaces import (
    damp_eight,
    evaluate,
    forces_where,
    lines_of,
    poses_in_lanes,
    springs_of_eight,
)
from damage.reference.fast.rows import add_rows, rows_of, set_rows
from damage.reference.fast.step import any_above_zero, forces_by_contacts, remember_last, wall_of

FORCES = INDEX(4)
"""Index of the forces in a body's row, after its Pose."""


@entry
def run(tables, blocks, law, controls, field, clock, ends, stiffness, samples):
    """Advance a wall and write a sample at each of the steps `ends`, as `damage.mechanics.step.run`.

    tables: System of the wall with a first axis of length one; blocks: Blocks of it; controls: (1, 5) as of
    `damage.mechanics.tables.Controls`; field: (1, steps + 1, 3) acceleration of the base along x and z and gravity, in
    each step and the one after the last [m/s2]; clock: number of steps before; ends: (n,) rising numbers of steps from
    now; stiffness, samples: as of `damage.mechanics.samples`.  `find_forces` must be called once before the first run.
    """
    pack(tables, blocks, 1)
    damped, adaptive, step = any_above_zero(controls, 3), any_above_zero(controls, 4), 0
    for k in range(len(ends)):
        if damped:
            poses_to_rows(blocks)
            remember_last(tables, blocks, 1, 1)
        while step < ends[k]:
            move(tables.energy, tables.relaxation, blocks, 1, controls, field, step)
            if adaptive:
                adapt(tables.relaxation, blocks, 1, controls)
            step += 1
            all_forces(tables, blocks, law, clock + step, step == ends[k], damped)
        unpack(tables, blocks, 1)
        observe(wall_of(tables, 0), stiffness, field[0, step], controls[0, 0], samples, 0, k)


@entry
def find_forces(tables, blocks, law, clock, at_end, damped):
    """Forces of the contact points on all bodies at the present displacements [N, N m], into the tables.

    Arguments as of `all_forces`; damped is False, an argument since a constant would have that compiled a second time.
    """
    pack(tables, blocks, 1)
    all_forces(tables, blocks, law, clock, at_end, damped)
    unpack(tables, blocks, 1)


@compiled
def all_forces(tables, blocks, law, step, at_end, damped):
    """Forces of the contact points on all bodies, into the blocks; at_end: as `singly` of
    `damage.mechanics.step.find_forces`."""
    clear(blocks.sums, at.DAMPED, at.KINETIC)
    poses_to_rows(blocks)
    if at_end or (forces_of_damped(blocks) if damped else forces_of_undamped(blocks)):
        forces_of_others(tables, blocks, law, step, at_end, damped)
    forces_from_rows(blocks)
    if damped:
        total(blocks.sums, at.DAMPED, 1)
        tables.energy[0, DAMPING] += blocks.sums[at.DAMPED]


@compiled
def forces_of_undamped(blocks):
    """`forces_of_intact` without damping, compiled apart: a branch inside would need too many registers."""
    return forces_of_intact(blocks, False)


@compiled
def forces_of_damped(blocks):
    """`forces_of_intact` with damping."""
    return forces_of_intact(blocks, True)


@inlined
def forces_of_intact(blocks, damped):
    """Forces of the intact interfaces, eight in a block.  Returns whether there are interfaces that are not intact."""
    rows, first, second, any_other = blocks.rows, blocks.first, blocks.second, 0
    block = NONE
    while block < INDEX(len(blocks.others)):
        row, p = block * WIDTH, block * at.INTERFACE
        a, b = interfaces.Pose(*rows_of(rows, first, row, NONE)), interfaces.Pose(*rows_of(rows, second, row, NONE))
        frame, motion, resultant, intact = evaluate(
            lines_of(blocks.interfaces, p), springs_of_eight(blocks.interfaces, p), a, b, blocks.limits,
            block * at.LIMITS)
        if damped:
            resultant, work = damp_eight(blocks.last, block * at.LAST, load(blocks.bench, at.RATE), motion, resultant,
                                         intact)
            add(blocks.sums, at.DAMPED, work)
        forces = forces_where(intact, frame, resultant)
        add_rows(rows, first, second, row, FORCES, (forces.x, forces.z, forces.moment_a),
                 (-forces.x, -forces.z, -forces.moment_b))
        blocks.others[block] = others = ALL - int(bits(intact))
        any_other |= others
        block += ONE
    return any_other > 0


@compiled
def forces_of_others(tables, blocks, law, step, at_end, damped):
    """Forces of the interfaces that are not intact (at_end: of all), by contact points, after the others."""
    for block in range(len(blocks.others)):
        flags, p = ALL if at_end else int(blocks.others[block]), 8 * block
        while flags:
            if flags & 1 and p < tables.interfaces.shape[1]:
                forces_by_contacts(tables, blocks, 1, law, step, 0, p, at_end, damped)
            flags, p = flags >> 1, p + 1


@compiled
def poses_to_rows(blocks):
    """Copy the poses of the bodies into their rows, and set their forces to zero."""
    bodies, rows, starts, row = blocks.bodies, blocks.rows, blocks.starts, NONE
    while row < INDEX(len(starts)):
        pose, zero = poses_in_lanes(bodies, at.place_of(row, at.BODY)), spread(0.0)
        set_rows(rows, starts, row, NONE, pose.x, pose.z, pose.cos1, pose.sin)
        set_rows(rows, starts, row, FORCES, zero, zero, zero, zero)
        row += WIDTH


@compiled
def forces_from_rows(blocks):
    """Copy the forces on the bodies from their rows."""
    bodies, row = blocks.bodies, NONE
    while row < INDEX(len(blocks.starts)):
        k = at.place_of(row, at.BODY)
        fx, fz, moment, _ = rows_of(blocks.rows, blocks.starts, row, FORCES)
        store(bodies, k + at.FX, fx)
        store(bodies, k + at.FZ, fz)
        store(bodies, k + at.MOMENT, moment)
        row += WIDTH
