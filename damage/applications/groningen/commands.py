"""Commands about an address: its earthquakes, and lives of walls there."""

import os
import re
import sys
from pathlib import Path

from damage.applications.groningen.exposure.catalogue import SHIPPED, with_later, write_catalogue
from damage.applications.groningen.exposure.exposure import describe as describe_exposure
from damage.applications.groningen.exposure.lives import KEYS, draws_of
from damage.arguments import arg, file_arg, flag, group, number_from
from damage.commands.table import JSON, WALL, command, out, output, save, show, tables
from damage.errors import InputError, warn
from damage.files import is_there, write_text
from damage.provenance import MODEL
from damage.run.options import UNITS
from damage.wall.file import wall_path


def _degrees(word):
    """Degrees, which may have a decimal comma, and a comma behind them."""
    return float(re.sub(r"^(-?\d+),(\d+)$", r"\1.\2", word.removesuffix(",")))


_degrees.__name__ = "float"  # for what argparse says of a word that is none
_ADDRESS = (
    group(
        "address",
        arg("--at", "the address, degrees in WGS84", ("LAT", "LON"), _degrees, nargs=2),
        arg("--rd", "instead: metres in the Dutch grid (EPSG:28992)", ("X", "Y"), float, nargs=2),
        arg(
            "--vs30",
            "mean shear-wave velocity of the upper 30 m (default 200)",
            "M_S",
            float,
            dest="vs30_m_s",
            default=200.0,
        ),
    ),
    group(
        "earthquakes and ground motion",
        arg("--from", "first year (default: the catalogue's)", "YEAR", int, dest="first_year"),
        arg("--to", "last year (default: the catalogue's)", "YEAR", int, dest="last_year"),
        file_arg(
            "--catalogue",
            "FILE",
            "events: CSV, KNMI's all_induced.csv, or the text of an FDSN event service "
            "(default: KNMI's list for the field, 1991-12 to 2022-01, which ships)",
        ),
        arg(
            "--component",
            "larger of both horizontal components (default), their "
            "geometric mean, or the largest in any direction",
            "LRG|GEO|MAX",
        ),
        arg("--model", "ground-motion model (default bommer-2022)", "NAME", default="bommer-2022"),
    ),
)
"""Options of the commands that are about an address; `_address_of` reads them."""
OF_THE_RUN = "settle", "distortion"
"""Keys whose options are of a run, not of the address."""


def _address_of(asked):
    """{key of `damage.applications.groningen.exposure.lives.KEYS`: value} of parsed options."""
    if (asked.at is None) == (asked.rd is None):
        raise InputError(
            f"which address? {'both' if asked.at else 'none'} given: expected --at LAT LON or --rd"
            " X Y; give one of them"
        )
    degrees = ("latitude", "longitude")
    metres = ("easting_rd_m", "northing_rd_m")
    address = dict(zip(degrees, asked.at) if asked.at else zip(metres, asked.rd))
    for name in KEYS:
        value = getattr(asked, name, None)
        if value is not None and name not in OF_THE_RUN:
            address[name] = str(value.resolve()) if name == "catalogue" else value
    return address


@command(
    "the ground motion at an address in the Groningen field: PGV of every earthquake of a"
    " catalogue",
    *_ADDRESS,
    JSON,
    out("folder for the table of all events and the picture", required=False),
    examples=("--at 53.36 6.75", "--rd 246000 597000 --vs30 180 --from 2012 --out exposure"),
)
def _exposure(asked):
    exposure = draws_of(_address_of(asked)).exposure
    if asked.out:
        from damage.applications.groningen.pictures import exposure_picture
        from damage.measure.tables import write_table

        print(
            f"table: {write_table(exposure.table(), asked.out / 'exposure.csv')}", file=sys.stderr
        )
        save([("exposure", exposure_picture(exposure))], asked.out, "exposure")
    show(asked, exposure.as_dict(), describe_exposure)


@command(
    "a catalogue with later earthquakes: the one that ships, and what a file of KNMI's event"
    " service has later; the file is text, of"
    " https://rdsa.knmi.nl/fdsnws/event/1/query?format=text&starttime=2022-01-26",
    file_arg("later", "FILE", "text of an FDSN event service, CSV, or KNMI's all_induced.csv"),
    file_arg(
        "--catalogue", "FILE", "to be continued (default: KNMI's list to 2022-01, which ships)"
    ),
    out(
        "the catalogue with both, for --catalogue of other commands and catalogue = in addresses",
        "FILE.csv",
    ),
    examples=(
        "later.txt --out catalogue.csv",
        "newest.txt --catalogue catalogue.csv --out catalogue_2.csv",
    ),
)
def _catalogue(asked):
    joined, notes = with_later(asked.later, asked.catalogue or SHIPPED)
    print(
        *notes,
        f"{write_catalogue(joined, asked.out)}: {len(joined.events)} events from"
        f" {joined.begin:%Y-%m-%d} to {joined.end:%Y-%m-%d}",
        sep="\n",
    )


def _draws(help_, **more):
    """The option of how many lives are drawn."""
    draws = arg("--draws", help_, "N", number_from(2, 10000, int), **more)
    return group("lives", draws)


def _lives_options(within, strong):
    """Options of how lives are drawn and run, with these defaults."""
    draws = group(
        "lives",
        arg("--seed", "of the draws (default 0)", "N", number_from(0, 2**31, int), default=0),
        arg(
            "--above",
            "PGV from which an event is part of a life (default 8); the largest always is",
            "MM_S",
            number_from(0.01, 1000),
            dest="above_mm_s",
            default=8.0,
        ),
        arg(
            "--within",
            f"stations whose records are used (default {within:g} km from the epicentre)",
            "KM",
            number_from(0.1, 1000),
            dest="within_km",
            default=within,
        ),
        arg(
            "--scale-to",
            "what records are scaled to: the drawn PGV "
            "(default), or the spectral acceleration at 0.2 s that it implies",
            "pgv|sa",
            default="pgv",
        ),
        arg(
            "--strong",
            "shares of the Arias "
            "intensity that a record's window leaves out at its start and end (default "
            f"{strong[0]:g} {strong[1]:g}; 0 0: longer windows, which crack more walls)",
            "SHARE",
            float,
            nargs=2,
            default=strong,
        ),
    )
    return draws, _RUN_OPTIONS, _BATCH_OPTIONS


_RUN_OPTIONS = group(
    "runs",
    arg(
        "--rest",
        "free vibration after each event (default 0.2), before the damped stage",
        "S",
        number_from(0, 100),
        default=0.2,
    ),
    arg(
        "--strength-cov",
        "scatter of the joints' strengths (default 0.3)",
        "COV",
        number_from(0, 2),
        default=0.3,
    ),
    arg(
        "--inputs",
        "the wall as given, or what nobody knows of it drawn, with tests of its masonry"
        " or without (default typical)",
        choices=("given", "tested", "typical"),
        default="typical",
    ),
    arg("--settle", "settlement of the ground before the first event", "PROFILE|FILE.csv"),
    arg("--distortion", "of a named profile", "1/500"),
)
_BATCH_OPTIONS = group(
    "batch",
    arg(
        "-j",
        "processes (default: one a core)",
        "N",
        number_from(1, 9999, int),
        dest="jobs",
        default=os.cpu_count(),
    ),
    flag("--remake", "make runs again that another version made"),
)


@command(
    "lives of a wall at an address in the Groningen field: the earthquakes of the catalogue one"
    " after the other, damage carried over, their motions and the joints' strengths drawn; the same"
    " command continues",
    WALL,
    *_ADDRESS,
    *_lives_options(10.0, (0.05, 0.1)),
    _draws("lives (default 100)", default=100),
    out("folder of the study: tables, pictures, report"),
    examples=(
        "symmetric --at 53.36 6.75 --out results/life",
        "my_wall.toml --at 53.36 6.75 --settle hogging --distortion 1/3000 --out results/settled",
    ),
)
def _life(asked):
    from damage.applications.groningen.life.results import NAME, life_study
    from damage.applications.studies.batch import run
    from damage.applications.studies.folder import while_locked

    address = _address_of(asked)
    draws = draws_of(address)
    draws.life(1)  # says what is wrong before anything is written
    wall_path(asked.wall)
    warn(*draws.exposure.warnings)
    options = _options_of(asked) | _settlement(asked.settle, asked.distortion)
    with while_locked(asked.out, Path(NAME).stem) as lock:
        study = life_study(
            asked.out,
            asked.wall,
            address,
            options,
            asked.draws,
        )
        out = asked.out.absolute()
        return run(study, out, asked.jobs, "summary", remake=asked.remake, lock=lock)


def _options_of(asked):
    """{name: value} of the options of every run."""
    return {"rest": asked.rest, "strength-cov": asked.strength_cov, "inputs": asked.inputs}


def _settlement(settle, distortion):
    """{name: value} of the options of a settlement, of those that are given; its file, if it is
    one, is found from any folder."""
    if settle and is_there(settle):
        settle = str(Path(settle).resolve())
    given = {"settle": settle, "distortion": distortion}
    return {name: value for name, value in given.items() if value}


@command(
    "a claim: the same front with and without the earthquakes, with and without settlement, beside"
    " a survey of its cracks; one sheet that prints on A4, and every number as JSON; the same"
    " command continues",
    WALL,
    *_ADDRESS,
    group(
        "survey",
        file_arg(
            "--cracks", "SURVEY.csv", "its cracks (docs/reference/crack-format.md)", required=True
        ),
    ),
    *_lives_options(3.5, (0.05, 0.15)),
    _draws(
        "draws (default: 10 for a first sheet, then 96 and more, up to 800, until the intervals"
        " are narrow and enough draws resemble the survey; an answer needs 50 that do)"
    ),
    group(
        "runs",
        UNITS,
        file_arg(
            "--levels",
            "LEVELS.csv",
            "instead of --settle: levels of a course, with columns x_m, height_m, date",
        ),
    ),
    output(arg("--language", "of the sheet (default en)", choices=("en", "nl"), default="en")),
    out("folder for the sheet, its numbers and the runs"),
    examples=(
        "my_house.toml --at 53.36 6.75 --cracks survey.csv --out results/claim",
        (
            "my_house.toml --at 53.36 6.75 --cracks survey.csv --settle hogging --distortion 1/1500"
            " --language nl --out results/claim"
        ),
    ),
)
def _claim(asked):
    from damage.applications.groningen.claim.dutch import translated_to

    with translated_to(asked.language):
        return _make_claim(asked)


def _make_claim(asked):
    from damage.applications.groningen.claim.make import Claim, make_claim
    from damage.applications.groningen.claim.sheet import set_aside
    from damage.applications.groningen.claim.twins import NAME
    from damage.applications.studies.folder import while_locked

    if asked.out.is_dir():
        # a claim that is being made has the lock
        with while_locked(asked.out.absolute(), Path(NAME).stem):
            set_aside(asked.out)
    if asked.levels and (asked.settle or asked.distortion):
        raise InputError(
            "--levels and --settle or --distortion: expected one of them, as levels say shape and"
            " size; leave the other out"
        )
    if asked.distortion and not asked.settle:
        raise InputError("--distortion belongs to --settle; give both")
    return make_claim(
        Claim(
            wall=asked.wall,
            address=_address_of(asked),
            survey=asked.cracks,
            options=_options_of(asked),
            settlement=_settlement(asked.levels or asked.settle, asked.distortion),
            draws=asked.draws,
            language=asked.language,
            units=tuple(asked.units),
        ),
        asked.out,
        asked.jobs,
        asked.remake,
    )


@command(
    "a claim as a page of this machine: address, front, photograph, cracks and sheet, step by step;"
    " it listens on the loopback interface alone and writes below --out only (needs Flask:"
    " pip install .[groningen], or Debian's python3-flask)",
    flag(
        "--no-browser",
        "print the page's address, open no browser",
        dest="opened",
        action="store_false",
    ),
    out("folder of the claim"),
    examples=("--out results/claim", "--out results/claim --no-browser"),
)
def _app(asked):
    from damage.applications.groningen.app.server import serve

    serve(asked.out, asked.opened)


@command(
    "what became of the lives of walls: probabilities of visible damage by year, the share of the"
    " largest event, the contribution of each; tables, pictures and one HTML report, in the folder",
    file_arg("results", "FOLDER", "folder of a study with lives"),
    output(file_arg("--markdown", "FILE", "write the text, too")),
    out("folder for the tables (default: figures in FOLDER)", required=False),
    examples=("results/life", "results/life --markdown lives.md --out figures"),
)
def _lives(asked):
    from damage.applications.groningen.life.results import (
        contributions,
        describe,
        largest_alone,
        lives_of,
        over_time,
        write_lives,
    )
    from damage.applications.groningen.pictures import contributions_picture, life_picture
    from damage.applications.report.report import Heading, write_report

    parts = lives_of(asked.results)
    folder = asked.out or asked.results / "figures"
    print(*write_lives(parts, folder), sep="\n")
    text = describe(parts)
    if asked.markdown:
        write_text(asked.markdown, text + "\n")
    print(text)
    alone = {point: lives[1] for point, lives in largest_alone(parts).items()}
    for part in parts:
        if not part.draws.choices.largest_alone:
            title = f"{part.point}: {len(part.last)} lives"
            save(
                [
                    (
                        f"life_{part.point}",
                        life_picture(part.table, over_time(part), alone.get(part.point), title),
                    ),
                    (
                        f"life_{part.point}_events",
                        contributions_picture(contributions(part), title),
                    ),
                ],
                folder,
                title,
            )
    paragraphs = text.replace("\n  ", "; ").replace("\n", "\n\n")
    print(write_report([asked.results], None, Heading("Lives of a wall", None, paragraphs)))


MODEL.append("applications/groningen/exposure/**/*.py")  # draws motions


@tables
def _tables():
    from damage.applications.groningen.exposure.columns import TABLES

    return TABLES
