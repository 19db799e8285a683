"""Dilatant joints as a prototype on top of the plain step: what an option for dilatancy would
change.

    python3 -m paper dilatancy      # two minutes

The joint law stays.  A failed contact point that has slipped by s is thicker by the integral of the
dilatancy,

    d(s) = tan(psi_0) / delta (1 - exp(-delta |s|)),    tan(psi) = tan(psi_0) exp(-delta |s|),

which decays with slip (G. P. A. G. van Zijl (2004), Modeling masonry shear-compression: role of
dilatancy highlighted, J. Eng. Mech. 130(11)); its decrease with pressure is left out, which makes
it larger.  psi_0 and delta are assumed. Its rest position moves by d every few steps, as a negative
plastic closure.
"""

from dataclasses import dataclass, replace

import numpy as np

from damage.applications.cracks.pushed import SPECIMENS
from damage.mechanics.tables import Z
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Wall, softening_energies
from paper.bench import arguments, print_row, print_table
from verification.collapse import settled_wall

DECAY = 2000.0
"""delta [1/m]: half a millimetre of slip takes most of it."""
EVERY = 10
"""Steps between two moves of the rest positions."""
LEVELS = (0.0, 0.2, 0.4)
"""tan(psi_0) [-]."""
SAMPLE_S = 1e-3


def thickening(slip, dilatancy):
    """d(s) [m]; slip [m]; dilatancy: tan(psi_0)."""
    return dilatancy / DECAY * -np.expm1(-DECAY * np.abs(slip))


@dataclass(frozen=True)
class Pushed:
    """displacement, force, lift: of the top [m, N, m], (n,) each; slip: of the contact points at
    the end [m]."""

    displacement: np.ndarray
    force: np.ndarray
    lift: np.ndarray
    slip: np.ndarray


def push(layout, farthest, speed, *, dilatancy, rotates=False, lifts=True):
    """Push the top of a settled wall; a Pushed.  farthest [m]; speed [m/s]; dilatancy: tan(psi_0);
    rotates, lifts: whether the top may."""
    wall = settled_wall(layout)
    wall.start(np.zeros((0, 2)))
    caps = layout.pushed_bodies
    states = wall.system.states
    wall.hold(caps, not rotates)
    if not lifts:
        wall.system.inverse_mass[caps, Z] = wall.system.velocity[caps, Z] = 0.0
    wall.push(speed)
    start = wall.displacement[caps, :2].mean(axis=0)
    rows = []
    steps = max(1, round(SAMPLE_S / wall.time_step / EVERY))
    while not rows or rows[-1][0] < farthest:
        for _ in range(steps):
            wall.run(EVERY)
            states["closure"] = -thickening(states["slip"], dilatancy)
        moved = wall.displacement[caps, :2].mean(axis=0) - start
        rows.append((moved[0], wall.push_force(), moved[1]))
    return Pushed(*np.array(rows).T, states["slip"].copy())


def two_bricks():
    """The Layout of two dry bricks under a rigid mass that cannot turn."""
    brick = Brick(length=0.45)
    return lay_out(
        Wall(
            "pair",
            brick.length / 2,
            2 * brick.height,
            precompression=0.3e6,
            brick=brick,
            joint=Joint(tensile_strength=0.0, cohesion=0.0),
        ),
        ModelOptions(top="beam"),
    )


def integral(layout, slip, dilatancy):
    """Integral of the dilatancy over the slip of two bricks [m]; the joint on the ground slips by a
    hundredth."""
    return float(
        sum(thickening(slip[layout.contacts.second == body], dilatancy).mean() for body in (0, 1))
    )


SCATTERED = {
    f"softening, strengths scatter, draw {seed}": ModelOptions(
        strength_cov=0.35, strength_seed=seed
    )
    for seed in (1, 2)
}
"""Joints whose crack runs in steps without dilatancy, and their ModelOptions."""
WALLS = (
    ("squat_tested", "brittle", True),
    ("comp2_4", "brittle", False),
    *(("comp2_4", label, False) for label in SCATTERED),
)
"""Wall file, what a table calls its joints, whether the top turns."""


def main():
    """Tested walls: residual force by dilatancy, and where the top is kept from lifting."""
    arguments(__doc__)
    print_table(
        "wall",
        "joints",
        "tan ψ_0",
        "top",
        "peak [kN]",
        "mean force from 0.1 to 0.2 % [kN]",
        "to no dilatancy",
        "lift at 0.2 % [mm]",
    )
    for name, label, rotates in WALLS:
        wall = load_wall(name)
        brittle = label not in SCATTERED
        if not brittle:
            wall = replace(
                wall, joint=replace(wall.joint, **softening_energies(wall.joint.tensile_strength))
            )
        layout = lay_out(wall, SCATTERED.get(label, ModelOptions()))
        height = float(layout.bodies.z[layout.pushed_bodies].mean())
        without = None
        for dilatancy, lifts in (
            *((level, True) for level in LEVELS),
            *([(LEVELS[-1], False)] if brittle else []),
        ):
            done = push(
                layout, 2e-3 * height, 8e-3, dilatancy=dilatancy, rotates=rotates, lifts=lifts
            )
            residual = done.force[done.displacement > 1e-3 * height].mean()
            without = without or residual
            print_row(
                SPECIMENS[name],
                label,
                dilatancy,
                "free to lift" if lifts else "kept from lifting",
                f"{done.force.max() / 1e3:.1f}",
                f"{residual / 1e3:.1f}",
                f"{100 * (residual / without - 1):+.1f} %",
                f"{1e3 * done.lift[-1]:.2f}",
            )
