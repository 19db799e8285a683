"""Restraints: rigid bodies at a wall's edges that the ground drives like its base, as floors and
party walls do.

At the top a beam over the whole length rests on the wall with a bed joint.  It carries the
precompression, rises freely, and its horizontal motion is that of the base, or follows it through a
bearing.  At a side stands a party wall, joined to every course by a head joint; it moves with the
base altogether.  All bodies are computed in the frame of the base, in which what moves with it
rests.

The bearing is a spring k in series with a slider: F = k (u - s) with |F| <= mu N while the slip |s|
stays below the play, elastic beyond it.  u: displacement of the beam; N: the load on top, constant.
"""

import math
from dataclasses import dataclass

from damage.errors import InputError
from damage.fields import check_fields, choice, quantity
from damage.units import GRAVITY

SIDES = ("top", "left", "right")
THICK_M = 0.02
"""Height of the beam, about whose middle a free one rotates, and length of a party wall [m]."""
_OF_TOP = ("rotation", "stiffness", "friction", "play", "mass")


@dataclass(frozen=True)
class Restraint:
    """A restraint of an edge.

    side: "top", "left" or "right".  The rest is of a top: rotation: "fixed" or "free"; stiffness
    [N/m], friction [-] and play [m] of a bearing, stiffness None where the beam is driven itself;
    mass [kg] of the beam, None where all of the precompression is its weight; the rest of that is a
    constant load.
    """

    side: str = choice(SIDES)
    rotation: str = choice(("fixed", "free"), default="fixed")
    stiffness: float | None = quantity(
        "N/m", 1.0, 1e15, (1e3, 1e12), "a rubber bearing; a cast floor", default=None
    )
    friction: float = quantity(
        "1", 0.0, 10.0, (0.01, 1.5), "Teflon; rough stone", zero=True, default=0.0
    )
    play: float = quantity(
        "m", 0.0, 1.0, (1e-5, 0.1), "a tight fit; a joist in a pocket", zero=True, default=0.0
    )
    mass: float | None = quantity("kg", 1e-3, 1e9, (1, 1e6), "a board; a bridge deck", default=None)

    def __post_init__(self):
        check_fields(self)
        if self.stiffness is None and (self.friction or self.play):
            raise InputError(
                f"Restraint with friction {self.friction:g} and a play of {self.play:g} m, but no "
                "stiffness: expected that of its bearing [N/m]; give it, or leave both out"
            )
        if self.side != "top" and (
            given := [name for name in _OF_TOP if getattr(self, name) != getattr(type(self), name)]
        ):
            raise InputError(
                f"Restraint of the {self.side} side with {', '.join(given)}: expected these of a"
                " top alone, since a party wall moves with the base; leave them out"
            )

    def slip(self, displacement, slip, load):
        """Slip of the bearing [m] at a displacement of the beam [m], from the slip before; load: N
        [N]."""
        excess = abs(force := self.stiffness * (displacement - slip)) - self.friction * load
        moved = slip + math.copysign(max(excess, 0.0), force) / self.stiffness
        return min(max(moved, -self.play), self.play)

    @property
    def at_rest(self):
        """Stiffness of the bearing for small motions [N/m], zero within a play without friction."""
        return self.stiffness if not self.play or self.friction else 0.0

    def describe(self, load_kg):
        """It in a line; load_kg: of the top."""
        if self.side != "top":
            return f"party wall at the {self.side} side, driven like the base"
        mass = load_kg if self.mass is None else self.mass
        bearing = (
            "driven like the base"
            if self.stiffness is None
            else (
                f"on a bearing of {self.stiffness:.3g} N/m, friction {self.friction:g}, play"
                f" {1e3 * self.play:g} mm"
            )
        )
        return (
            f"top held by a beam of {mass:.4g} kg, {bearing}; rotation {self.rotation}; it rises"
            f" under {GRAVITY * load_kg / 1e3:.4g} kN"
        )


def top_of(wall):
    """The Restraint of a wall's top, None without one."""
    return next((restraint for restraint in wall.restraints if restraint.side == "top"), None)


def check_restraints(wall):
    """Raise InputError for two restraints of a side, and for a top that cannot have one."""
    sides = [restraint.side for restraint in wall.restraints]
    top = top_of(wall)
    for side in SIDES:
        if sides.count(side) > 1:
            raise InputError(
                f"wall {wall.name}: {sides.count(side)} restraints of the side {side}: expected"
                " one; leave the others out"
            )
    if top is None:
        return
    if wall.outline:
        raise InputError(
            f"wall {wall.name}: a restraint of the top of a wall with an outline: expected a level"
            " top; leave one of them out"
        )
    if not wall.precompression:
        raise InputError(
            f"wall {wall.name}: a restraint of the top without precompression: expected the load on"
            " the beam, as precompression [Pa] over the length; give it, 100 Pa for hardly any"
        )
