"""Commands about a wall before it is run."""

from pathlib import Path

from damage.commands.table import JSON, command, file_arg, group, out, save
from damage.errors import warn
from damage.files import json_text
from damage.provenance import shown_path
from damage.run.options import WALLS_ARE_CODE, add_accept, add_model_options, model_of


@command("masonry and brick formats by name, with values and sources, for damage.masonry(MATERIAL, FORMAT)", JSON)
def _materials(asked):
    from damage.wall.materials import as_dict, describe

    print(json_text(as_dict(), indent=2) if asked.json else describe())


@command("natural periods of a wall with intact joints", file_arg("wall", "WALL",
         f"a wall file, or the name of a wall that ships. {WALLS_ARE_CODE}"),
         group("model", lambda command: add_model_options(command, (
             "lintel", "top", "load", "cells", "contacts", "bricks", "brick_order", "plane", "brick_mass")),
               add_accept),
         JSON, out("folder for a picture of the shapes", required=False))
def _modes(asked):
    from damage.law.modes import natural_modes
    from damage.wall.as_built import describe_floors, describe_lintels, describe_openings, describe_top
    from damage.wall.layout import lay_out

    layout = lay_out(_plausible_wall(asked), model_of(asked))
    modes = natural_modes(layout)
    if asked.out:
        from damage.draw.modes import modes_picture

        save([("modes", modes_picture(layout, modes))], asked.out)
    periods = [float(period) for period in modes.period_s]
    if asked.json:
        print(json_text({"period_s": periods, "critical_time_step_s": modes.critical_time_step_s,
                          "pier_stress_pa": layout.pier_stress}))
        return
    plan = layout.plan
    print(*describe_top(layout), *describe_openings(plan), *describe_floors(plan), *describe_lintels(plan), sep="\n")
    for number, period in enumerate(periods, start=1):
        print(f"mode {number}: {period:.5f} s")
    print(f"critical time step: {modes.critical_time_step_s:.4g} s")


@command("a picture of a wall before it is run: bricks, openings as built, supports, masses, elastic joints, names of "
         "piers and spandrels",
         file_arg("wall", "WALL", f"a wall file, or the name of a wall that ships. {WALLS_ARE_CODE}"),
         group("model", lambda command: add_model_options(command, ("lintel", "top", "load", "supports")), add_accept),
         out("the picture (default: the wall's name, .png, in the working folder)", "FILE.png|FILE.svg|FILE.pdf",
              required=False))
def _draw(asked):
    from damage.draw.preview import wall_preview
    from damage.draw.style import save_picture
    from damage.wall.geometry import body_table, joint_table
    from damage.wall.layout import lay_out

    wall = _plausible_wall(asked)
    layout = lay_out(wall, model_of(asked))
    supports = tuple(zip(layout.supports.left, layout.supports.right))
    figure = wall_preview(layout.plan, body_table(layout), joint_table(layout), supports)
    print(save_picture(figure, asked.out or Path(f"{wall.name}.png"), f"wall {shown_path(asked.wall)}"))


def _plausible_wall(asked):
    """The wall of a command's options, its values checked unless the user accepts all."""
    from damage.wall.as_built import warn_of_courses
    from damage.wall.file import load_wall
    from damage.wall.plan import plan_of
    from damage.wall.plausible import check_plausible

    wall = load_wall(asked.wall)
    if not asked.accept_implausible:
        check_plausible(wall)
    warn(*warn_of_courses(plan_of(wall)))
    return wall


@command("the JSON Schema of walls as TOML, by which editors complete and check them: put it beside yours, and "
         "'#:schema ./wall.schema.json' on its first line")
def _wall_schema(asked):
    from damage.wall.data import wall_schema

    print(json_text(wall_schema(), indent=1))
