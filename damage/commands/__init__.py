"""The commands of `python3 -m damage`: each module adds its own to the table, in the order in which help lists them."""

from importlib import import_module

for _name in ("first_steps", "walls", "motions", "address", "histories", "laboratory", "studies", "fragility"):
    import_module(f"damage.commands.{_name}")
