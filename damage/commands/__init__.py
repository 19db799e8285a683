"""The commands of the core for `python3 -m damage`: each module adds its own to the table."""

from importlib import import_module

for _name in ("walls", "histories"):
    import_module(f"damage.commands.{_name}")
