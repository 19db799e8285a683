"""The applications of the core: importing this module lets each register what it adds to a run."""

from importlib import import_module

NAMES = "damage.laboratory", "damage.life", "damage.batch"

for _name in NAMES:
    import_module(f"{_name}.register")
