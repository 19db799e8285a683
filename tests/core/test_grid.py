"""Mirror, momentum, energy and widths, as one grid over all bodies, contact types and joint laws;
convergence.

A mirrored wall under the mirrored motion has the mirrored motion: to rounding up to the first
failure, and then as long as rounding does not decide which joint fails.  In each step the forces of
the supports, the weight and the inertia of the base's acceleration sum up to the change of the
wall's momentum, and their moments to that of its angular momentum. What came in is stored or
dissipated.  A wall has the same bits alone and beside another one in the lanes of a batch.
"""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from conftest import total_energy
from numpy.testing import assert_allclose
from short_runs import solver_of
from test_deformable import orders
from test_settlement import periods
from test_widths import everything

from damage import Brick, Floor, Joint, Lintel, ModelOptions, Opening, Wall
from damage.law.states import BROKEN, CRUSHED
from damage.linear.modes import natural_modes
from damage.mechanics.tables import INPUT
from damage.motion.loading import FreeVibration
from damage.reference.lanes import run_together
from damage.reference.session import BACKEND
from damage.run.settings import RunSettings
from damage.units import GRAVITY
from damage.wall.layout import lay_out

BRICK = Brick(0.2, 0.1, 0.1, 2000.0)
WEAK = Joint(tensile_strength=2e4, cohesion=3e4)
SOFT = replace(WEAK, mode_i_fracture_energy=0.1, mode_ii_fracture_energy=1.0)
SOFT_AND_CRUSHING = replace(SOFT, compressive_strength=3e5, compressive_fracture_energy=50.0)
STIFFER = {"normal_stiffness": 15e11, "friction_angle": 0.7}
STRETCHES = 10
"""Parts of a run, at whose ends walls are compared."""
LAST = 1, 1, 1, 1, 2, 1
"""Numbers of steps at the end of each: forces of the last step of a number are read."""
DOOR = (Opening(0.4, 0.6, 0.6),)
"""Left of the middle, so that no wall is its own mirror image."""


@dataclass(frozen=True)
class Case:
    """wall: fields of a Wall of 1.6 x 1.0 m; options: of ModelOptions; beside: fields of the Joint
    of the wall beside it in a batch; beta_s: damping by stiffness [s]; peak, pulse_s: of the pulse
    [m/s2, s]; happens: bit of the state that contact points reach."""

    wall: dict = field(default_factory=dict)
    options: dict = field(default_factory=dict)
    beside: dict = field(default_factory=dict)
    beta_s: float = 0.0
    peak: float = 20.0
    pulse_s: float = 0.02
    happens: int = BROKEN

    def walls(self):
        """The Wall and its mirror image."""
        one = Wall(
            **{
                "name": "w",
                "length": 1.6,
                "height": 1.0,
                "openings": DOOR,
                "precompression": 1e5,
                "brick": BRICK,
                "joint": WEAK,
                "lintel": "courses",
            }
            | self.wall
        )
        return one, mirrored(one)


def mirrored(wall):
    """The mirror image of a Wall as long as whole bricks."""
    return replace(
        wall,
        openings=tuple(
            replace(one, left=wall.length - one.right) for one in reversed(wall.openings)
        ),
        outline=tuple((wall.length - x, z) for x, z in reversed(wall.outline)),
        floors=tuple(
            replace(
                one, left=wall.length - one.span(wall)[1], right=wall.length - one.span(wall)[0]
            )
            for one in wall.floors
        ),
    )


GABLE = {"outline": ((0.0, 0.5), (0.6, 1.0), (1.6, 0.6)), "openings": (), "precompression": 0.0}
GRID = {
    "bricks, interior points": Case(),
    "corner points": Case(options={"contacts": "corners"}, beside=STIFFER),
    "Gauss points": Case(options={"contacts": "gauss"}),
    "bricks below a gable": Case(GABLE),
    "cap of the whole top": Case(options={"top": "beam"}),
    "mass on the top course": Case(options={"top": "uniform", "load": "piers"}),
    "slab and timber floor": Case(
        {"floors": (Floor(0.3, 300.0, 0.0, 0.4), Floor(0.9, 500.0, kind="concrete"))}
    ),
    "lintel as a beam": Case({"lintel": Lintel("concrete")}),
    "lintel as an arch": Case({"lintel": Lintel("arch")}),
    "one support a brick": Case(options={"supports": "bricks"}),
    "soil": Case(options={"soil": 1e8}),
    "damping by stiffness": Case(beside=STIFFER, beta_s=1e-6),
    "softening joints": Case({"joint": SOFT}, beside=STIFFER, peak=40.0),
    "crushing joints": Case({"joint": replace(WEAK, compressive_strength=3e5)}, happens=CRUSHED),
    "crushing that softens": Case({"joint": SOFT_AND_CRUSHING}, beside=STIFFER, happens=CRUSHED),
    "bricks that split": Case({"brick": replace(BRICK, tensile_strength=2e4)}),
    "softening, crushing and splitting at corner points": Case(
        {
            "joint": SOFT_AND_CRUSHING,
            "brick": replace(BRICK, tensile_strength=2e4, fracture_energy=0.5),
        },
        {"contacts": "corners"},
        beside=STIFFER,
        peak=40.0,
        happens=CRUSHED,
    ),
    "strain modes": Case(options={"bricks": "deformable", "contacts": "gauss"}),
    "strain modes, softening and crushing": Case(
        {"joint": SOFT_AND_CRUSHING},
        {"bricks": "deformable"},
        beside=STIFFER,
        peak=40.0,
        happens=CRUSHED,
    ),
}


class Run:
    """A wall under the rising half of a pulse along x, and half of it along z; side: 1, or -1 for
    the mirror image; level: factor on the pulse."""

    def __init__(self, case, wall, side=1, level=1.0):
        self.layout = lay_out(wall, ModelOptions(**case.options))
        self.side = side
        self.middle = wall.length / 2
        settings = RunSettings(FreeVibration(), self.layout.options)
        self.solver = BACKEND.make(
            self.layout, 0.3 * natural_modes(self.layout, 1).critical_time_step_s, settings
        )
        self.solver.damp(beta=case.beta_s)
        self.solver.add_static_displacement()
        self.stretch = int(case.pulse_s / 2 / STRETCHES / self.solver.time_step)
        time_s = self.solver.time_step * np.arange(STRETCHES * self.stretch + 1)
        pulse = level * case.peak * np.sin(np.pi * time_s / case.pulse_s)
        self.base = np.column_stack([side * pulse, 0.5 * pulse])
        self.solver.start(self.base)
        bodies = self.layout.bodies
        contacts = self.layout.contacts
        along = side * (bodies.x - self.middle)
        both = np.where(contacts.first < 0, 0.0, along[contacts.first]) + along[contacts.second]
        self.bodies = in_order(along, bodies.z)
        part = slice(self.layout.n_joints)
        # corners of up to four interfaces coincide
        self.joints = in_order(
            *(
                values[part]
                for values in (
                    contacts.kind,
                    both,
                    contacts.z - bodies.z[contacts.second],
                    side * (contacts.x - self.middle),
                    contacts.z,
                )
            )
        )

    def seen(self):
        """Displacements (n_bodies, 3) and states (n_joints,), in the order and with the signs of
        the wall itself."""
        return (self.solver.displacement * [self.side, 1, self.side])[
            self.bodies
        ], self.solver.state[self.joints]

    def advance(self):
        """Run a stretch; returns what forces and the change of momentum differ by at its end, over
        the larger of the weight and the forces on the supports, (3, 3): along x, along z, and
        moments about the middle of the base.

        First at a step whose forces are read, contact point by contact point; then across one whose
        forces are not: intact interfaces have their resultant springs, and what acts from outside
        is interpolated to third order.  The third row is the error of this, estimated by what
        interpolation to first order differs by: an impact within these steps is no polynomial.
        """
        solver = self.solver
        solver.run(self.stretch - sum(LAST))
        place = []
        force = []
        pushed = [GRAVITY * self.layout.total_mass]
        for count in LAST:
            solver.run(count)
            place.append(solver.displacement)
            force.append(self.acting(place[-1], solver.support_force, self.base[solver.clock]))
            pushed.append(np.abs(solver.support_force[:, :2]).sum())
        velocity = [
            (new - old) / count / solver.time_step
            for old, new, count in zip(place, place[1:], LAST[1:])
        ]
        momenta = [self.momenta(velocity[k], place[at]) for k, at in ((0, 1), (1, 1))]
        read = np.subtract(*momenta[::-1]) / solver.time_step - force[1]
        unread = np.array([-1, 4, 4, -1]) @ force[2:] / 6
        momenta = [self.momenta(velocity[k], (place[3] + place[4]) / 2) for k in (2, 4)]
        across = np.subtract(*momenta[::-1]) / solver.time_step - (force[3] + unread + force[4])
        unsure = unread - (force[3] + force[4]) / 2
        return np.abs([read, across, unsure]) / max(pushed)

    def acting(self, place, push, base):
        """Forces on the wall along x and z and their moment, (3,) [N, N, N m]; place: (n_bodies,
        3); push: of the wall on the supports, (n_supports, 3); base: acceleration (2,) [m/s2]."""
        bodies = self.layout.bodies
        force = -self.layout.bodies.mass[:, None] * (base + [0.0, GRAVITY])
        moment = (bodies.x - self.middle + place[:, 0]) @ force[:, 1] - (
            bodies.z + place[:, 1]
        ) @ force[:, 0]
        at = self.layout.supports.x - self.middle
        return np.array(
            [
                *(force.sum(axis=0) - push[:, :2].sum(axis=0)),
                moment - np.sum(push[:, 2] + at * push[:, 1]),
            ]
        )

    def momenta(self, velocity, place):
        """Momenta along x and z and angular momentum, (3,); velocity, place: (n_bodies, 3)."""
        bodies = self.layout.bodies
        (vx, vz, spin) = velocity.T
        x = bodies.x - self.middle + place[:, 0]
        z = bodies.z + place[:, 1]
        return np.array(
            [
                bodies.mass @ vx,
                bodies.mass @ vz,
                bodies.mass @ (x * vz - z * vx) + bodies.inertia @ spin,
            ]
        )


def in_order(*last_key_first):
    return np.lexsort([np.round(values, 7) for values in last_key_first])


def cases():
    """Names of the grid, and whether a wall is run beside another, too: of strain modes by the
    longer checks alone, as code of eight walls with them takes a minute to compile."""
    for name, case in GRID.items():
        deforms = case.options.get("bricks") == "deformable"
        yield name, not deforms
        if deforms:
            yield pytest.param(name, True, marks=pytest.mark.long)


@pytest.mark.parametrize(("name", "wide"), cases())
def test_mirror_momentum_energy_and_width(name, wide):
    """Found: 2e-12 of the largest displacement while all are intact, 1e-10 afterwards; 2e-9 of the
    forces where these are read, 1e-2 where they are interpolated while joints fail, 3e-2 where an
    impact makes interpolation uncertain by as much.  Energies close to 3e-5 once the pulse is over;
    during it the work of a step by the force at its beginning is off by 0.1 %."""
    case = GRID[name]
    reached = 0
    wall, mirror = case.walls()
    runs = [Run(case, wall), Run(case, mirror, -1)]
    other = replace(wall, joint=replace(wall.joint, **case.beside))
    batch = [Run(case, other, level=0.5).solver, Run(case, wall).solver] if wide else []
    solver = runs[0].solver
    began = total_energy(solver)
    largest = 0.0
    for _ in range(STRETCHES):
        if wide:
            run_together(batch, runs[0].stretch - sum(LAST), *LAST)
        for run in runs:
            read, across, unsure = run.advance()
            assert read.max() < 1e-8
            assert across.max() < (0.015 + unsure.max() if run.solver.state.any() else 1e-3)
        (here, state), (there, image) = (run.seen() for run in runs)
        failed = state.any() or image.any()
        assert np.abs(there - here).max() <= (1e-7 if failed else 1e-10) * np.abs(here).max()
        assert np.array_equal(state, image)
        assert not wide or everything(solver) == everything(batch[1])
        largest = max(largest, solver.kinetic_energy() + abs(solver.energy[INPUT]))
        reached |= np.bitwise_or.reduce(state)
    assert reached & case.happens
    solver.run(20)
    assert total_energy(solver) == pytest.approx(began, abs=5e-5 * largest)


# --- orders of convergence in the contact points per half brick -----------------------------------

LENGTH = 0.4
HEIGHT = 0.8
WIDTH = 0.2
STIFF_DRY = Joint(12e10, 4e10, tensile_strength=0.0, cohesion=0.0)
CELLS = 4, 8, 16


def block(contacts, cells):
    """The Layout of a rigid block on a dry base."""
    wall = Wall(
        "block",
        LENGTH,
        HEIGHT,
        precompression=0.0,
        brick=Brick(LENGTH, HEIGHT, WIDTH),
        joint=STIFF_DRY,
    )
    return lay_out(wall, ModelOptions(contacts=contacts, cells=cells))


def segments(contacts, cells):
    """Parts of the base between contact points, or around each."""
    return 2 * (cells - 1 if contacts == "corners" else cells)


@pytest.mark.parametrize("contacts", ["interior", "corners", "gauss"])
def test_the_rocking_period_of_an_intact_base_is_of_second_order_in_the_cells(contacts):
    """The stiffness is the integral of x^2 over the base: points in the middle of cells miss 1 /
    n^2 of it, those at their ends have 2 / n^2 too much, two Gauss points have it all."""
    layouts = [block(contacts, cells) for cells in CELLS]
    exact = periods(layouts[0], weight=False).max()
    errors = [natural_modes(layout, 1).period_s[0] / exact - 1 for layout in layouts]
    if contacts == "gauss":
        assert_allclose(errors, 0.0, atol=2.0**-26)  # to which periods are rounded
    else:
        assert_allclose(
            orders([segments(contacts, cells) for cells in CELLS], errors), 2.0, atol=0.1
        )
        assert all(error > 0 for error in errors) == (contacts == "interior")


def tilt(layout, closed):
    """Rotation of the block at rest under a horizontal acceleration by which `closed` of its base's
    length bears, over that of Navier's triangle of stresses, of length c: 2 N / (k c^2)."""
    weight = GRAVITY * layout.total_mass
    c = closed * LENGTH
    solver = solver_of(layout, 0.5)
    solver.damp(adaptive=1.0)
    along = (LENGTH / 2 - c / 3) / (HEIGHT / 2) * GRAVITY
    solver.start(np.tile([along, 0.0], (20_002, 1)))
    solver.run(20_000)
    assert solver.kinetic_energy() < 1e-12
    return (
        abs(solver.displacement[0, 2])
        * layout.contacts.normal_stiffness[0]
        * WIDTH
        * c**2
        / (2 * weight)
    )


@pytest.mark.parametrize("contacts", ["interior", "corners", "gauss"])
def test_the_tilt_of_a_base_that_gapes_is_of_second_order_in_the_cells(contacts):
    """Stresses have a kink where the base opens, anywhere in a cell: of second order in the mean
    over eleven places, Gauss points included."""
    errors = [
        np.sqrt(
            np.mean(
                [
                    (tilt(block(contacts, cells), closed) - 1) ** 2
                    for closed in np.linspace(0.4, 0.9, 11)
                ]
            )
        )
        for cells in CELLS
    ]
    assert_allclose(orders([segments(contacts, cells) for cells in CELLS], errors), 2.0, atol=0.3)
