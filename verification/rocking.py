"""A slender block on its corners (Housner 1963, BSSA 53(2), 403-417, doi:10.1785/BSSA0530020403).

With half width b and half height H of the block's middle above the ground, R^2 = b^2 + H^2,
tan(alpha) = b/H and inertia I about a corner, the block lifts off when the base accelerates with g
b/H, and falls back from a tilt theta by

    I theta'' = -m g R sin(alpha - theta)

from rest at theta_0 to the ground in a quarter of its period.  Housner's own T/4 = arccosh(1/(1 -
theta_0/alpha))/p with p^2 = m g R/I puts alpha - theta for its sine; the quadrature here does not.

At the impact Housner's rigid block keeps ((I_o - 2 m b^2) / I_o)^2 of its energy, I_o about a
corner.  One on an elastic joint loses in another way: contact points that land or open have little
force on them and slide, and friction takes it.

    python3 -m verification.rocking  # what is left after one impact, in the reference solver
"""

import math
import sys
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import quad

from damage.mechanics.tables import FRICTION
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Joint, Wall
from verification.block import DRY, SLENDER, STICKY, foot, one_block, settle, solver_of
from verification.problem import of_both

SHARES = (0.2, 0.5, 0.8)
# [s], [rad]; the joint's own compression turns a block that stands by 3e-8
RAMP_S = 0.05
LIFTED = 1e-7


def problems():
    """Acceleration at which the block lifts off; quarter periods from three tilts."""
    layout = layout_of()
    bodies = layout.bodies
    half_width = foot(layout)
    half_height = float(bodies.z[0])
    slenderness = math.atan(half_width / half_height)
    radius = math.hypot(half_width, half_height)
    rate = math.sqrt(
        bodies.mass[0] * GRAVITY * radius / (bodies.inertia[0] + bodies.mass[0] * radius**2)
    )
    return [
        of_both(
            "rocking, onset",
            "base acceleration that overturns, of g",
            "1",
            half_width / half_height,
            "Housner (1963)",
            1e-3,
            onset,
            "onset",
            1,
            1,
        ),
        of_both(
            "toppling stack",
            "base acceleration that overturns four blocks, of g",
            "1",
            half_width / half_height,
            "a rigid body, since any upper part of it stands more",
            2e-3,
            lambda: onset(courses=4),
            "onset",
            1,
            4,
        ),
        of_both(
            "rocking, onset, interior",
            "base acceleration that overturns, of g",
            "1",
            foot(layout_of("interior")) / half_height,
            "Housner (1963), b to the outermost contact point",
            1e-3,
            lambda: onset("interior"),
            "onset",
            0,
            1,
        ),
        *(
            of_both(
                f"rocking from {share:g} alpha",
                "quarter period",
                "s",
                quarter_period(share, slenderness, rate),
                f"Housner (1963), not linearised (linearised {housner(share, rate):.5f} s)",
                {"reference": 1e-3, "yade": 3e-3},
                lambda share=share: fall_back(share * slenderness),
                "fall_back",
                share * slenderness,
            )
            for share in SHARES
        ),
    ]


def housner(share, rate):
    """Quarter period [s] of a slender block from share * alpha, linearised."""
    return math.acosh(1 / (1 - share)) / rate


def quarter_period(share, slenderness, rate):
    """Quarter period [s] by the energy theta'^2/2 = p^2 (cos(alpha - theta) - cos(alpha -
    theta_0)).

    With theta = theta_0 - s^2 the integrand stays finite at the start, which Gauss points never
    hit.
    """
    start = share * slenderness

    def integrand(s):
        theta = start - s * s
        drop = math.cos(slenderness - start) - math.cos(slenderness - theta)
        return 2 * s / math.sqrt(2 * drop)

    return quad(integrand, 0, math.sqrt(start), epsabs=1e-12)[0] / rate


def layout_of(contacts="corners", stiffness=1e13, courses=1):
    """A block on a stiff, dry joint that holds by friction, in one piece or cut into courses of one
    block each."""
    # A wall of half a brick's length has no head joint in any course.
    length = SLENDER.length * (1 if courses == 1 else 2)
    brick = replace(
        SLENDER,
        length=length,
        height=SLENDER.height / courses,
        young_modulus=1e16,
        shear_modulus=1e16,
    )
    joint = Joint(
        normal_stiffness=stiffness,
        shear_stiffness=stiffness,
        tensile_strength=0.0,
        cohesion=0.0,
        friction_angle=STICKY.friction_angle,
    )
    return lay_out(
        Wall("block", SLENDER.length, SLENDER.height, brick=brick, joint=joint, precompression=0.0),
        ModelOptions(contacts=contacts, cells=1),
    )


def onset(contacts="corners", courses=1, stand=None):
    """Largest steady base acceleration [g] that the block stands, by bisection; stand: as
    `stands`."""
    # of b/H
    low = 0.5
    high = 2.0
    layout = layout_of(contacts, courses=courses)
    stand = stand or stands
    expected = foot(layout) / float(layout.bodies.z.mean())
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (middle, high) if stand(layout, middle * expected) else (low, middle)
    return (low + high) / 2 * expected


def stands(layout, acceleration_g):
    """Whether the block stands a base acceleration that grows slowly to this value and stays
    there."""
    wall = solver_of(layout, 0.5)
    settle(wall, GRAVITY, 0.005)
    wall.local_damping = 0.7
    steps = round(RAMP_S / wall.time_step)
    ramp = np.minimum(np.arange(4 * steps) / steps, 1.0)
    wall.start(np.column_stack([-acceleration_g * GRAVITY * ramp, 0 * ramp]))
    wall.run(len(ramp))
    return abs(wall.displacement[0, 2]) < LIFTED


def tilted(layout, tilt):
    """Displacement (x, z) of the block's middle when it is tilted clockwise about its right corner,
    and how far that corner sinks into its joint under the block's weight [m]."""
    half_width = foot(layout)
    half_height = float(layout.bodies.z[0])
    radius = math.hypot(half_width, half_height)
    angle = math.atan2(half_height, -half_width) - tilt
    sag = (
        layout.bodies.mass[0]
        * GRAVITY
        / (layout.contacts.normal_stiffness * layout.contacts.area).max()
    )
    return half_width + radius * math.cos(angle), radius * math.sin(angle) - half_height, sag


def tilt_it(wall, tilt):
    """Put the block of a ReferenceWall at a tilt about its right corner, at rest."""
    x, z, sag = tilted(wall.layout, tilt)
    wall.displacement = (x, z - sag, -tilt)


def fall_back(tilt):
    """Time [s] from rest at a tilt about the right corner until the block stands upright."""
    wall = solver_of(layout_of(), 0.5)
    tilt_it(wall, tilt)
    before = -tilt
    while True:
        wall.run(1)
        now = wall.displacement[0, 2]
        if now >= 0:
            return (wall.step - now / (now - before)) * wall.time_step
        before = now


# --- through the impact ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Impact:
    """After one impact, at the next turn, in shares of the energy at the first: left; friction;
    tilt over the first."""

    left: float
    friction: float
    tilt: float


def rock(share, contacts="corners", joint=DRY):
    """The Impact of a block on a joint of a wall that falls back from a share of its
    slenderness."""
    wall = solver_of(one_block(SLENDER, joint, contacts=contacts, cells=1), 0.5)
    tilt = share * math.atan(foot(wall.layout) / float(wall.layout.bodies.z[0]))
    tilt_it(wall, tilt)
    start = energy_of(wall)
    before = -tilt
    while wall.displacement[0, 2] < 0 or wall.displacement[0, 2] > before:
        before = wall.displacement[0, 2]
        wall.run(20)
    return Impact(energy_of(wall) / start, float(wall.energy[FRICTION]) / start, before / tilt)


def energy_of(wall):
    """Kinetic energy, height and strain of the joint [J] above those of the block that stands
    without load."""
    bodies = wall.layout.bodies
    contacts = wall.layout.contacts
    (sigma, tau) = wall.stresses
    velocity = wall.velocity[0]
    moved = (
        0.5 * bodies.mass[0] * (velocity[0] ** 2 + velocity[1] ** 2)
        + 0.5 * bodies.inertia[0] * velocity[2] ** 2
    )
    strain = sigma**2 / contacts.normal_stiffness + tau**2 / contacts.shear_stiffness
    return (
        moved
        + bodies.mass[0] * GRAVITY * wall.displacement[0, 1]
        + 0.5 * float(np.sum(contacts.area * strain))
    )


def main():
    print("| contact points | tan phi | from, of alpha | energy left | friction took | Housner |")
    print("| --- " * 6 + "|")
    for contacts in ("interior", "corners"):
        layout = one_block(SLENDER, contacts=contacts, cells=1)
        half_width = foot(layout)
        half_height = float(layout.bodies.z[0])
        inertia = layout.bodies.inertia[0] / layout.bodies.mass[0] + half_width**2 + half_height**2
        for joint in (DRY, STICKY):
            for share in SHARES:
                found = rock(share, contacts, joint)
                print(
                    f"| {contacts} | {math.tan(joint.friction_angle):.3g} | {share:g} |"
                    f" {found.left:.3f} | {found.friction:.3f} |"
                    f" {(1 - 2 * half_width**2 / inertia) ** 2:.3f} |"
                )
    return 0


if __name__ == "__main__":
    sys.exit(main())
