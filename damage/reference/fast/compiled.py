"""How the functions of this folder are compiled: as those of `damage.mechanics`, which are compiled into them."""

from pathlib import Path

from damage.mechanics.compiled import PLAIN, Package

FAST = Package(Path(__file__).parent, (
    "compiled", "blocks", "rows", "bodies", "interfaces", "contacts", "step", "alone", "together"),
    [path for path in PLAIN.sources if path.name not in ("step.py", "rows.py", "loose.py")])  # the plain step alone
compiled, inlined = FAST.compiled, FAST.inlined


def is_cached():
    """Whether numba has cached the step of one wall, which every run needs, as these sources have it."""
    return FAST.is_cached("alone.run")
