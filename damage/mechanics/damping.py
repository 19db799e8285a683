"""Stiffness-proportional damping of interfaces."""

from damage.mechanics import contacts, interfaces, rows, strain_modes
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.contacts import Points
from damage.mechanics.simd import add_part, either, flags_of, table_width
from damage.mechanics.tables import DAMPED, ROW


@inlined
def damp(n, tables, row, motion, resultant, changed, which):
    """Return the Resultant with stiffness-proportional damping [N, N m]; store motion and elastic
    resultant for the next step, and add up the work, in the walls `which` (flags).

    changed: change of the elastic resultant since the last step.
    """
    before = rows.last_motion(n, tables.last, row)
    rows.keep_motion(n, tables.last, row, which, motion)
    rows.keep_resultant(n, tables.last, row, which, resultant)
    bench = rows.bench_of(table_width(n), tables.bench, 0)
    viscous, work = interfaces.add_viscous(bench.rate, motion, before, resultant, changed)
    add_part(n, tables.sums, DAMPED, row, either(which, work, 0.0))
    return viscous


@compiled
def remember_last(n, tables, strain, which):
    """Store present motions and resultants of all interfaces, for stiffness-proportional damping in
    the next step, in the walls `which` (bits)."""
    asked = flags_of(n, which)
    for p in range(len(tables.interfaces)):
        interface = tables.interfaces[p]
        motion = rows.moved(n, tables, p)[1]
        start = ROW(interface.start)
        size = strain_modes.points_at_once(strain, interface)
        while start < interface.stop:
            points = Points(p, start, start + size, strain_modes.last_row(strain, p, start))
            here = strain_modes.motion_at(n, tables.bodies, strain, interface, start, motion)
            rows.keep_motion(n, tables.last, points.row, asked, here)
            rows.keep_resultant(
                n,
                tables.last,
                points.row,
                asked,
                contacts.present_resultant(n, tables, points, here),
            )
            start += size
