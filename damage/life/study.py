"""The study file of `python3 -m damage life`: a point with all events of each life, a point with the largest alone."""

import json
from pathlib import Path

from damage.files import write_text
from damage.provenance import shown_path
from damage.wall.file import wall_path

NAME = "lives.toml"
POINT, LARGEST = "life", "life_largest"


def write_study(folder, wall, address, options, lives):
    """Write the addresses' files and the study's into a folder; returns the study's path.

    wall: its file or the name of one that ships; address: {key of `damage.exposure.lives.KEYS`: value}, None where not
    given; options: of each run, {name: value}; lives: their number.
    """
    folder = Path(folder)
    address = {name: value for name, value in address.items() if value is not None}
    runs = []
    for point, more in ((POINT, {}), (LARGEST, {"largest_alone": True})):
        write_text(folder / f"{point}.address.toml", _toml(address | more))
        runs.append({"id": point, "wall": str(Path(wall_path(wall)).resolve()),
                     "options": {"address": str((folder / f"{point}.address.toml").resolve()), **options},
                     "lives": lives})
    text = [f"# {lives} lives of {shown_path(wall_path(wall))}; written by python3 -m damage life",
            'name = "lives"', 'pictures = "none"', 'conclusion = "python3 -m damage lives"']
    for run in runs:
        words = ", ".join(f"{name} = {json.dumps(value)}" for name, value in run.pop("options").items())
        text += ["", "[[runs]]", *_toml(run).splitlines(), f"options = {{ {words} }}"]
    return write_text(folder / NAME, "\n".join(text) + "\n")


def _toml(table):
    """A flat table as TOML; JSON's numbers, words and lists are TOML's."""
    return "".join(f"{name} = {json.dumps(value)}\n" for name, value in table.items())
