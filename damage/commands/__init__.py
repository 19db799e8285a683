"""The commands of `python3 -m damage`: each module adds its own to the table, in the order in which help lists them."""

from importlib import import_module

for _name in ("walls", "address", "histories", "studies"):
    import_module(f"damage.commands.{_name}")
