"""Names that were removed: options of commands and runs, keys of studies and walls, fields of
histories."""

from typing import Any, NamedTuple


class Retired(NamedTuple):
    """What is said of a name that was removed.

    Attributes
    ----------
    sentence : str
        What was removed, in which version, and what to use instead.
    default : object
        The value that says in files of older versions what its absence says now.
    """

    sentence: str
    default: Any = None


RETIRED = {
    "fibres": Retired(
        "--fibres was removed in 0.2; softening joints follow the joint law itself in both"
        " solvers: leave it out",
        default=0,
    ),
    "perturb": Retired(
        "--perturb was removed in 0.2; members of an ensemble differ by --scatter, a share of the"
        " joints' strengths"
    ),
    "past-collapse": Retired(
        "--past-collapse was removed in 0.2; give --after-fall in YADE, which follows bricks until"
        " they rest"
    ),
    "new-contacts": Retired(
        "--new-contacts was removed in 0.2; bricks whose joints have ended collide in YADE: leave"
        " it out, and run the wall with ./yade",
        default=False,
    ),
    "opensees": Retired(
        "--opensees of export was removed in 0.2; history.joints of a run has each contact point's"
        " bodies, place, stiffnesses and strengths, docs/guides/other-programs.md what OpenSees"
        " calls them"
    ),
    "brick-order": Retired(
        "--brick-order was removed in 0.2; deformable bricks have strain modes of order 2: leave it"
        " out",
        default=2,
    ),
    "plane": Retired(
        "--plane was removed in 0.2; deformable bricks are in plane stress: leave it out",
        default="stress",
    ),
    "brick-mass": Retired(
        "--brick-mass was removed in 0.2; the mass of deformable bricks' strain modes is taken 9"
        " times: leave it out",
        default=9.0,
    ),
    "soil-velocity": Retired(
        "--soil-velocity was removed in 0.2; springs of the soil have no damping: leave it out, or"
        " give --rayleigh",
        default=0.0,
    ),
    "brick-cells": Retired(
        "--brick-cells was removed in 0.2; deformable bricks have strain modes, in the reference"
        " solver: give --bricks deformable alone",
        default=0,
    ),
}
"""{name without dashes before it, words joined by dashes: Retired}."""


def retired(name):
    """Return the Retired of an option, a key or a field; None for any other name.

    >>> retired("--past-collapse") is retired("past_collapse") is RETIRED["past-collapse"]
    True
    """
    return RETIRED.get(str(name).lstrip("-").replace("_", "-"))
