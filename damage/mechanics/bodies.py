"""Motion of the bodies in a time step: central differences, damping of velocities, strain modes.

The generalized coordinates of a rigid body are its displacements along x and z and its rotation
from x towards z; its strain modes are behind them.  All of them obey the same equation.  Where the
inverse mass is zero, the velocity is prescribed.
"""

from damage.elementary import cos, sin
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.rows import (
    bench_of,
    first_force,
    force_of,
    inverse_mass_of,
    keep_bench,
    mass_of,
    mean_of,
    place_of,
    velocity_of,
)
from damage.mechanics.simd import (
    add_part,
    bits,
    either,
    four,
    lane,
    lanes,
    load,
    put_four,
    rows_of,
    store,
    table_width,
    wall_of,
    widest,
    zero,
)
from damage.mechanics.tables import (
    ADAPTIVE,
    ALPHA,
    BETA,
    COS1,
    DRIVEN,
    FOLLOW,
    INERTIAL,
    KINETIC,
    LOCAL,
    MEAN,
    PARTS,
    PLACE,
    RIGID,
    ROTATION,
    SIN,
    SWEPT_X,
    SWEPT_Z,
    TAKEN,
    TIME_STEP,
    VELOCITY,
    Bench,
    X,
    Z,
)

SMALL = 0.01
"""Angle [rad] below which sine and cosine are evaluated by their Taylor series."""


@compiled
def set_bench(n, tables, controls, field, step):
    """Write the parameters of a step to the bench; returns whether mass-proportional or local
    damping acts."""
    damped = False
    for w in range(len(controls)):
        dt = controls[w, TIME_STEP]
        local = controls[w, LOCAL]
        base_x = field[w, step, 0]
        base_z = field[w, step, 1]
        gravity = field[w, step, 2]
        alpha = controls[w, ALPHA] + tables.relaxation[0, 0, w]
        damped |= alpha > 0.0 or local > 0.0
        keep_bench(
            wall_of(n, w),
            tables.bench,
            0,
            True,
            Bench(
                base_x,
                base_z,
                base_z + gravity,
                dt,
                alpha,
                local,
                controls[w, BETA] / dt,
                controls[w, FOLLOW] * dt,
            ),
        )
    return damped


@inlined
def move_all(n, tables, strain, controls, damped):
    """`move_bodies`, of one wall without strain modes eight at once."""
    if strain is None:
        move_bodies(widest(n), tables, strain, controls, damped)
    else:
        move_bodies(n, tables, strain, controls, damped)


@inlined
def move_bodies(n, tables, strain, controls, damped):
    """Advance all bodies; damped: whether the bench has damping; n: a width, ROWS where bodies have
    no strain modes."""
    alike = True
    bench = bench_of(table_width(n), tables.bench, 0)
    for w in range(len(controls)):
        alike &= controls[w, TIME_STEP] == controls[0, TIME_STEP]
    for b in range(0, len(tables.turning), rows_of(n)):
        lost = move_rigidly(n, tables, bench, b, damped)
        if strain is not None:
            if alike:
                lost = move_modes(n, tables, bench, strain, controls[0, TIME_STEP], b, lost, damped)
            else:
                lost = move_modes(n, tables, bench, strain, bench.step, b, lost, damped)
        add_part(n, tables.sums, TAKEN, b, lost)


@inlined
def move_rigidly(n, tables, bench, b, damped):
    """Advance the rigid coordinates of body b by a step; returns the power of their damping [W]."""
    sums = tables.sums
    inertia = tables.inertia
    x, z, rotation, fx, fz, moment = coordinates(n, tables.bodies, tables.every, b)
    swept_x, driven_x, taken_x, vx = move_coordinate(
        n, inertia, b, X, bench, bench.base_x, fx, damped
    )
    swept_z, driven_z, taken_z, vz = move_coordinate(
        n, inertia, b, Z, bench, bench.pull_z, fz, damped
    )
    _, driven, taken, turning = move_coordinate(n, inertia, b, ROTATION, bench, 0.0, moment, damped)
    put(n, tables, b, x + bench.step * vx, z + bench.step * vz, rotation + bench.step * turning)
    add_part(n, sums, SWEPT_X, b, swept_x)
    add_part(n, sums, SWEPT_Z, b, swept_z)
    add_part(n, sums, DRIVEN, b, driven_x + driven_z + driven)
    if damped:
        return taken_x + taken_z + taken
    return zero(n)


@inlined
def coordinates(n, places, every, b):
    """x, z and rotation of body b, and the forces on these; every: numbers of all rows."""
    if rows_of(n) == 1:
        return (
            place_of(n, places, b, X),
            place_of(n, places, b, Z),
            place_of(n, places, b, ROTATION),
            force_of(n, places, b, X),
            force_of(n, places, b, Z),
            force_of(n, places, b, ROTATION),
        )
    x, z = four(n, places, every, b, COS1)[2:]
    rotation, fx, fz, moment = four(n, places, every, b, PLACE + ROTATION)
    return x, z, rotation, fx, fz, moment


@inlined
def put(n, tables, b, x, z, angle):
    """Write coordinates of body b, cosine less one and sine of its rotation, and forces that are
    zero."""
    places = tables.bodies
    (cos1, sine) = small_rotation(angle)
    none = zero(n)
    if rows_of(n) == 1:
        for k in range(RIGID):
            store(n, places, b, first_force(places) + k, none)
        store(n, places, b, COS1, cos1)
        store(n, places, b, SIN, sine)
        store(n, places, b, PLACE + X, x)
        store(n, places, b, PLACE + Z, z)
        store(n, places, b, PLACE + ROTATION, angle)
    else:
        put_four(n, places, tables.every, b, COS1, (cos1, sine, x, z))
        put_four(n, places, tables.every, b, PLACE + ROTATION, (angle, none, none, none))
    far = bits(abs(angle) >= SMALL)
    if far:
        turn_far(n, places, b, far, angle)


@compiled
def turn_far(n, places, b, far, angle):
    """Write cosine less one, and sine, of those rotations `far` (bits) of body b that are not
    small."""
    for w in range(lanes(n)):
        if far >> w & 1:
            row = b + w if rows_of(n) > 1 else b
            store(wall_of(n, w), places, row, COS1, cos(lane(angle, w)) - 1.0)
            store(wall_of(n, w), places, row, SIN, sin(lane(angle, w)))


@inlined
def small_rotation(angle):
    """Cosine less one, and sine, of an angle below SMALL [rad], by series with a remainder below
    1e-17."""
    square = angle * angle
    return (
        -0.5 * square * (1.0 - square * (1 / 12) * (1.0 - square * (1 / 30))),
        angle * (1.0 - square * (1 / 6) * (1.0 - square * (1 / 20) * (1.0 - square * (1 / 42)))),
    )


@inlined
def total(n, sums, kind):
    """Sum of the partial sums, in their order, into the first of them."""
    value = zero(n)
    for part in range(PARTS):
        value = value + load(n, sums, kind, part)
    store(n, sums, kind, 0, value)


# --- a coordinate ---------------------------------------------------------------------------------


@inlined
def move_coordinate(n, inertia, b, k, bench, field, force, damped):
    """`advance` coordinate k of body b without mass scaling; field: as of `rates`."""
    mass = mass_of(n, inertia, b, k)
    rate, resistance = rates(n, inertia, b, k, bench, field, force, damped)
    return advance(n, inertia, b, k, bench.step, rate - resistance, mass * resistance, force)


@inlined
def rates(n, inertia, b, k, bench, field, force, damped):
    """Acceleration of coordinate k of body b without damping, and its deceleration by damping
    [m/s2 or rad/s2]; both zero where its velocity is prescribed.

    field: acceleration of the base plus gravity along the coordinate; both act against its
    direction.  damped: whether the bench has damping: mass-proportional, of the velocity less its
    running mean, which is updated, and Cundall's local damping, a share of |rate| against the
    velocity.
    """
    free = inverse_mass_of(n, inertia, b, k)
    rate = either(free > 0.0, force * free - field, 0.0)
    resistance = zero(n)
    if damped:
        old = velocity_of(n, inertia, b, k)
        mean = mean_of(n, inertia, b, k)
        mean = mean + bench.follow * (old - mean)
        store(n, inertia, b, MEAN + INERTIAL * k, mean)
        sign = either(old > 0.0, 1.0, either(old < 0.0, -1.0, 0.0))
        resistance = bench.alpha * (old - mean) + bench.local * abs(rate) * sign
        resistance = either(free > 0.0, resistance, 0.0)
    return rate, resistance


@inlined
def advance(n, inertia, b, k, dt, rate, lost, force):
    """Advance the velocity of coordinate k of body b by a step; lost: mass times deceleration by
    damping [N or N m].

    Returns the sum of its momenta before and after [kg m/s], with which the field does work, zero
    where the velocity is prescribed; the powers of that against the force of the contact points,
    zero where it is free, and of the damping [W]; and the velocity.
    """
    old = velocity_of(n, inertia, b, k)
    mass = mass_of(n, inertia, b, k)
    free = inverse_mass_of(n, inertia, b, k)
    new = old + dt * rate
    store(n, inertia, b, VELOCITY + INERTIAL * k, new)
    return (
        either(free > 0.0, mass * (old + new), 0.0),
        -either(free > 0.0, 0.0, force * new),
        lost * (old + 0.5 * dt * rate),
        new,
    )


# --- strain modes: mode m of a body is its coordinate RIGID + m -----------------------------------


@inlined
def move_modes(n, tables, bench, strain, dt, b, lost, damped):
    """Advance velocities and amplitudes of all modes of body b by a step; returns `lost` plus the
    powers of their damping [W].

    The damping of a mode itself is implicit, so that it does not shorten the stable time step.  dt:
    time step [s], a number where it is equal in all walls: the division is then one of numbers;
    damped: as of `rates`.
    """
    # masses are equal in all walls
    places = tables.bodies
    inertia = tables.inertia
    wall = wall_of(n, 0)
    for m in range(strain.shapes.shape[2]):
        k = RIGID + m
        half = 0.5 * dt * strain.damping[b, m]
        old = velocity_of(n, inertia, b, k)
        place = place_of(n, places, b, k)
        force = force_of(n, places, b, k) - strain.stiffness[b, m] * place
        rate, resistance = rates(n, inertia, b, k, bench, 0.0, force, damped)
        new = ((1.0 - half) * old + dt * (rate - resistance)) * (1.0 / (1.0 + half))
        middle = 0.5 * (old + new)
        store(n, places, b, PLACE + k, place + dt * new)
        store(n, inertia, b, VELOCITY + INERTIAL * k, new)
        store(n, places, b, first_force(places) + k, 0.0)
        lost = (
            lost
            + mass_of(wall, inertia, b, k) * (resistance + strain.damping[b, m] * middle) * middle
        )
    return lost


# --- kinetic energy -------------------------------------------------------------------------------


@compiled
def adapt(n, tables, strain, controls):
    """Set the adaptive damping of the next step from the kinetic energy of this one."""
    sums = tables.sums
    inertia = tables.inertia
    relaxation = tables.relaxation
    sums[KINETIC] = 0.0
    for b in range(len(inertia)):
        add_part(
            n,
            sums,
            KINETIC,
            b,
            kinetic_energy(
                n,
                inertia,
                b,
                velocity_of(n, inertia, b, X),
                velocity_of(n, inertia, b, Z),
                velocity_of(n, inertia, b, ROTATION),
            ),
        )
        if strain is not None:
            add_part(n, sums, KINETIC, b, kinetic_of_modes(n, inertia, strain, b))
    total(n, sums, KINETIC)
    for w in range(len(controls)):
        kinetic = sums[KINETIC, 0, w]
        share = controls[w, ADAPTIVE]
        last = relaxation[0, 1, w]
        relaxation[0, 0, w] = adaptive_damping(kinetic, last, share, controls[w, TIME_STEP])
        # a wall that relaxes later begins without
        relaxation[0, 1, w] = kinetic if share > 0.0 else 0.0


@inlined
def adaptive_damping(kinetic, last, share, dt):
    """Mass-proportional damping [1/s] for static solutions: Cundall's adaptive global damping, as
    in UDEC.

    Its power is a constant share [-] of the rate of change of the kinetic energy, so that it adapts
    to the dominant mode.  kinetic, last: kinetic energy now and in the last step [J]; dt: time step
    [s].
    """
    if not kinetic > 0.0:
        return 0.0
    # Limited to what stops every body in two steps, since the ratio is unbounded near rest.
    return min(share * abs(kinetic - last) / (dt * (kinetic + last)), 0.5 / dt)


@inlined
def kinetic_energy(n, inertia, b, x, z, rotation):
    """Kinetic energy of the rigid motion of body b with these velocities [J]."""
    linear = x * x + z * z
    return 0.5 * (
        mass_of(n, inertia, b, X) * linear + mass_of(n, inertia, b, ROTATION) * rotation * rotation
    )


@inlined
def kinetic_of_modes(n, inertia, strain, b):
    """Kinetic energy of the strain modes of body b [J]."""
    energy = zero(n)
    for k in range(RIGID, RIGID + strain.shapes.shape[2]):
        velocity = velocity_of(n, inertia, b, k)
        energy = energy + 0.5 * mass_of(wall_of(n, 0), inertia, b, k) * velocity * velocity
    return energy


@inlined
def energies_of_modes(n, tables, strain):
    """Kinetic and elastic energy of all strain modes [J].

    The velocities, known at half steps, are advanced to the time of the amplitudes.
    """
    kinetic = zero(n)
    stored = zero(n)
    wall = wall_of(n, 0)
    if strain is None:
        return kinetic, stored
    bodies = tables.bodies
    inertia = tables.inertia
    dt = bench_of(n, tables.bench, 0).step
    for b in range(len(strain.stiffness)):
        for m in range(strain.shapes.shape[2]):
            place = place_of(n, bodies, b, RIGID + m)
            velocity = velocity_of(n, inertia, b, RIGID + m)
            rate = force_of(n, bodies, b, RIGID + m) - strain.stiffness[b, m] * place
            rate = rate * inverse_mass_of(wall, inertia, b, RIGID + m)
            velocity = (velocity + 0.5 * dt * rate) / (1.0 + 0.5 * dt * strain.damping[b, m])
            kinetic = kinetic + 0.5 * mass_of(wall, inertia, b, RIGID + m) * velocity * velocity
            stored = stored + 0.5 * strain.stiffness[b, m] * place * place
    return kinetic, stored
