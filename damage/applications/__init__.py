"""What is built on the core: importing this package lets each application register what it adds.

`python3 -m damage`, `damage.run` and YADE's entry import it, the core does not.
"""

from importlib import import_module

APPLICATIONS = {
    "cracks": ("options", "commands"),
    "studies": ("options", "commands"),
    "report": ("commands",),
    "groningen": ("options", "commands"),
}
"""{folder: its modules that register something}; one may import those before it."""
GROUPS = {
    "first steps": ("demo", "new-wall", "check-bits", "help"),
    "a wall": ("materials", "draw", "modes", "wall-schema"),
    "ground motion": ("record", "exposure", "catalogue"),
    "one run": (
        "reference",
        "index",
        "check",
        "info",
        "plot",
        "stresses",
        "animate",
        "report",
        "tables",
        "compare",
        "export",
        "cracks",
        "calibrate",
        "cycles",
    ),
    "many runs": ("study", "study-tables", "study-schema", "fragility", "dictionary"),
    "lives at an address": ("life", "lives", "claim", "app"),
}
"""Title -> commands, in the order in which help lists them; all others follow."""

for _application, _modules in APPLICATIONS.items():
    for _module in _modules:
        import_module(f"damage.applications.{_application}.{_module}")
