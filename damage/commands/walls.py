"""Commands before a run: first steps, walls, motions."""

import sys
from pathlib import Path

from damage.arguments import arg, file_arg, flag, group, number_from
from damage.commands.table import JSON, STYLE, WALL, command, out, output, program, save, show
from damage.errors import InputError, did_you_mean, warn
from damage.files import json_text
from damage.house.coarser import in_units
from damage.house.house import load_wall_or_house
from damage.house.layout import lay_out_building
from damage.house.meeting import warn_of_lone_walls
from damage.house.plausible import check_plausible
from damage.linear.modes import natural_modes
from damage.motion import intensity
from damage.motion.formats import NAMES
from damage.motion.loading import PERIODS_S
from damage.motion.plausible import (
    faint_warnings,
    implausible_motion,
    implausible_peak,
    implausible_velocity,
    record_warnings,
)
from damage.provenance import shown_path
from damage.run.motion_options import PREPARATION, recorded
from damage.run.options import ACCEPTING, UNITS, arguments_of, model_of
from damage.wall import as_built, materials
from damage.wall.file import load_wall, wall_schema
from damage.wall.model_options import ModelOptions
from damage.wall.plan import plan_of


@command(
    "masonry and brick formats by name, with values and sources, for damage.masonry(MATERIAL,"
    " FORMAT)",
    JSON,
    examples=("", "--json > materials.json"),
)
def _materials(asked):
    print(json_text(materials.as_dict(), indent=2) if asked.json else materials.describe())


@command(
    "natural periods of a wall with intact joints",
    WALL,
    group(
        "model",
        UNITS,
        *arguments_of(ModelOptions, "lintel", "top", "load", "cells", "contacts", "bricks"),
        ACCEPTING,
    ),
    JSON,
    out("folder for a picture of the shapes", required=False),
    STYLE,
    examples=("symmetric", "my_wall.toml --bricks deformable --out pictures"),
)
def _modes(asked):
    layout = _laid_out(load_wall(asked.wall), asked)
    modes = natural_modes(layout)
    if asked.out:
        from damage.draw.preview import modes_picture

        save([("modes", modes_picture(layout, modes))], asked.out)
    periods = [float(period) for period in modes.period_s]
    if asked.json:
        print(
            json_text(
                {
                    "period_s": periods,
                    "critical_time_step_s": modes.critical_time_step_s,
                    "pier_stress_pa": layout.pier_stress,
                }
            )
        )
        return
    plan = layout.plan
    print(
        *as_built.describe_top(layout),
        *as_built.describe_openings(plan),
        *as_built.describe_floors(plan),
        *as_built.describe_lintels(plan),
        sep="\n",
    )
    for number, period in enumerate(periods, start=1):
        print(f"mode {number}: {period:.5f} s")
    print(f"critical time step: {modes.critical_time_step_s:.4g} s")


@command(
    "a picture of a wall before it is run: bricks, openings as built, supports, masses, elastic"
    " joints, names of piers and spandrels; of a house, its plan, too",
    WALL,
    group(
        "model", UNITS, *arguments_of(ModelOptions, "lintel", "top", "load", "supports"), ACCEPTING
    ),
    out(
        "the picture (default: the wall's name, .png, in the working folder)",
        "FILE.png|FILE.svg|FILE.pdf",
        required=False,
    ),
    STYLE,
    examples=("symmetric", "my_wall.toml --top beam --out my_wall.svg", "small"),
)
def _draw(asked):
    from damage.draw.house_preview import preview
    from damage.draw.style import save_picture

    layout = _laid_out(load_wall_or_house(asked.wall), asked)
    made = f"wall {shown_path(asked.wall)}"
    print(save_picture(preview(layout), asked.out or Path(f"{layout.wall.name}.png"), made))


def _laid_out(building, asked):
    """Lay out a damage.Wall, or House, in the units that are asked for, its values checked unless a
    command's options accept all; warns of what is built otherwise than given."""
    building = in_units(building, asked.units)
    if not asked.accept_implausible:
        check_plausible(building)
    layout = lay_out_building(building, model_of(asked))
    texts = warn_of_lone_walls(building)
    for plan in map(plan_of, building.each_wall):
        texts += as_built.warn_of_courses(plan) + as_built.warn_of_slabs(plan)
        texts += as_built.warn_of_apex(plan.wall.joint)
    warn(*dict.fromkeys(texts))
    return layout


@command(
    "the JSON Schema of walls as TOML, by which editors complete and check them: put it beside"
    " yours, and '#:schema ./wall.schema.json' on its first line",
    examples=("> wall.schema.json", "| less"),
)
def _wall_schema(asked):
    print(json_text(wall_schema(), indent=1))


@program("run a wall in the reference solver (see reference --help)")
def _reference(words, quiet):
    from damage.reference.session import run_reference

    return run_reference([*words, *["--quiet"] * (quiet and bool(words))])


@command(
    "does this machine compute the published histories, bit for bit? Runs of every kind, under a"
    " minute after the first compilation; exit status 1 where one differs",
    arg("runs", "of these alone (default: all short ones)", "RUN", nargs="*"),
    flag("--long", "the longer runs, too"),
    examples=("", "harmonic softening", "--long"),
)
def _check_bits(asked):
    from damage.mechanics.compiled import COMPILING, is_cached
    from damage.reference import bits

    if unknown := sorted(set(asked.runs) - set(bits.CASES)):
        raise InputError(
            f"run {unknown[0]}: expected one of {', '.join(bits.CASES)}"
            f"{did_you_mean(unknown[0], bits.CASES)}"
        )
    if not is_cached():
        print(COMPILING, flush=True)
    digests = {}
    known = bits.published()
    for name in asked.runs or [
        name for name, case in bits.CASES.items() if asked.long or not case.is_long
    ]:
        digest = bits.digests([name])
        digests |= digest
        different = bits.differing(digest, known).get(name, [])
        print(
            f"{name}: {'differs in ' + ', '.join(different) if different else 'equal'}", flush=True
        )
    print(bits.verdict(digests, known))
    return int(bool(bits.differing(digests, known)))


@command(
    "write a wall file to change: a copy of a wall that ships, as data, under the name of the file",
    file_arg("file", "FILE.toml"),
    arg(
        "--from",
        "the wall that is copied (default symmetric); an unknown one lists all",
        "NAME",
        dest="source",
        default="symmetric",
    ),
    examples=("my_wall.toml", "my_wall.toml --from solid"),
)
def _new_wall(asked):
    from damage.wall.new import new_wall

    path = new_wall(asked.file, asked.source)
    print(
        f"{path}: change its numbers, then: python3 -m damage reference {path} --harmonic 0.2 0.05"
    )


@command(
    "intensity measures of a ground-motion record as a run with these options applies it: nothing"
    " is filtered unless --band is given",
    file_arg(
        "record",
        "FILE|NAME",
        f"{NAMES} (docs/guides/own-record.md), or a record that ships, as BGAR_HGE; columns of CSV"
        " or plain text: time_s and acc_m_s2, acc_cm_s2, acc_gal or acc_g, or --unit",
    ),
    group(
        "preparation of the record",
        *PREPARATION,
        arg(
            "--period",
            "first period of a wall (of `modes`): also Sa there, of the motion as that wall"
            " gets it, interpolated where its steps are coarse",
            "T1_S",
            number_from(*PERIODS_S),
        ),
    ),
    JSON,
    output(
        file_arg(
            "--plot", "FILE.png", "write a picture: acceleration, velocity and response spectrum"
        )
    ),
    STYLE,
    examples=("BGAR_HGE", "record.csv --window 17 27 --plot record.png"),
)
def _record(asked):
    loading = recorded(asked)
    if asked.period is not None:
        loading = loading.for_period(asked.period)
    measures = intensity.motion_summary(loading, asked.period)
    warn(
        *implausible_motion(loading),
        *filter(
            None,
            (implausible_peak(measures["pga_g"]), implausible_velocity(measures["pgv_cm_s"] / 100)),
        ),
        *faint_warnings(measures["pga_g"]),
        *record_warnings(loading),
        *intensity.end_warnings(loading.applied()),
        *intensity.drift_warnings(loading),
    )
    if asked.plot:
        from damage.draw.motion import motion_picture
        from damage.draw.style import save_picture

        if asked.plot.suffix.lower() != ".png":
            raise InputError(f"--plot {asked.plot}: expected a name that ends in .png; give it one")
        path = save_picture(motion_picture(loading, measures), asked.plot, f"motion {loading.name}")
        print(f"picture: {path}", file=sys.stderr)  # stdout may be JSON
    show(asked, measures, intensity.describe)
