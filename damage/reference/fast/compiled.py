"""Compilation of the functions of this folder, which include those of `damage.mechanics`."""

from pathlib import Path

from damage.mechanics.compiled import PLAIN, Package

FAST = Package(Path(__file__).parent, (
    "compiled", "blocks", "rows", "bodies", "interfaces", "contacts", "step", "alone", "together", "modes",
    "deforming"), PLAIN.sources)
compiled, inlined, entry = FAST.compiled, FAST.inlined, FAST.entry


def is_cached():
    """Whether numba has cached the step of a single wall, which every run needs, of these sources."""
    return FAST.is_cached("alone.run")
