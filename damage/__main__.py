# PYTHON_ARGCOMPLETE_OK
"""`python3 -m damage COMMAND`: run a wall in the reference solver; read histories, records, studies, without YADE."""

from damage.start import begin, is_of_output, leave, missing_library

if __name__ == "__main__":
    begin()  # before what takes its time to import

import io
import os
import sys
from contextlib import nullcontext, redirect_stdout
from pathlib import Path

from damage.errors import InputError, did_you_mean, one_line, warn
from damage.files import json_text, write_text
from damage.history.reader import read_history
from damage.index import SLIP_CRITERIA
from damage.memory import hold_buffers
from damage.provenance import commit, shown_path
from damage.run.options import (
    WALLS_ARE_CODE,
    OneLineParser,
    add_accept,
    add_model_options,
    add_preparation,
    file_path,
    make_parser,
    model_of,
    number_from,
    recorded,
)
from damage.units import MILLIMETRE
from damage.version import VERSION

COMMANDS = {}
"""Name -> (function of the parsed options, what it is for, functions that add an argument to its parser)."""


DELEGATED = {"reference": "run a wall in the reference solver (see reference --help)",
             "study": "run a study: simulations, tables and pictures, by Snakemake (see study --help)"}
"""Commands whose options are those of another program: what they are for."""


class _Silence(io.StringIO):
    """A stream that discards its output."""


def main(arguments=None):
    """Run one command; returns the exit status: 0 done, 1 out of memory, or `check` found a file without an end, 2 bad
    input, 3 a library is missing."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    quiet = arguments[:1] == ["--quiet"]
    if "_ARGCOMPLETE" in os.environ:
        _complete()
    try:
        with redirect_stdout(_Silence()) if quiet else nullcontext():
            return _run(arguments[quiet:], quiet)
    except KeyboardInterrupt:
        return 130
    except Exception as error:
        return _failed(error)


def _run(arguments, quiet):
    if arguments[:1] == ["reference"]:  # its options are those of a run, as YADE's are
        from damage.reference.session import run_reference

        return run_reference([*arguments[1:], *["--quiet"] * (quiet and len(arguments) > 1)])
    if arguments[:1] == ["study"]:  # its options are those of the batch
        from damage.studies.batch import run_study

        return run_study(arguments[1:])
    if arguments == ["--version"]:
        print(f"masonry-damage {VERSION}, commit {commit()}")
        return 0
    hold_buffers()
    if arguments and not arguments[0].startswith("-") and arguments[0] not in COMMANDS:
        known = sorted({*COMMANDS, *DELEGATED})
        raise InputError(f"no command {arguments[0]!r}: expected one of {', '.join(known)}"
                         f"{did_you_mean(arguments[0], known)}")
    asked = _parser().parse_args(arguments)
    return asked.command(asked) or 0


def _complete():
    """Complete the command line for a shell, then exit; needs argcomplete."""
    import argcomplete

    argcomplete.autocomplete(_parser(whole=True))


def _failed(error):
    """Print an error that is no fault of this software in one line; returns the exit status."""
    if isinstance(error, ImportError) and missing_library(error):
        status, message = 3, f"error: {missing_library(error)}"
    elif isinstance(error, InputError):
        status, message = 2, f"error: {error}"
    elif isinstance(error, OSError) and is_of_output(error):
        return 1
    elif isinstance(error, OSError):
        status, message = 2, f"error: {one_line(error)}: expected what this user may read and write; correct that"
    elif isinstance(error, MemoryError):
        status, message = 1, (f"error: out of memory ({one_line(error) or 'no more to be had'}): expected room for it; "
                           "give it more, as by ulimit -v, or a smaller file")
    else:
        raise error
    print(message, file=sys.stderr)
    return status


def _parser(whole=False):
    """The parser of all commands; whole: with the options of `reference`, which has a parser of its own."""
    parser = OneLineParser(prog="python3 -m damage", allow_abbrev=False, description=(
        f"Damage of masonry walls under induced seismicity: masonry-damage {VERSION}. Installed by pip, it is "
        "also the command damage, or masonry-damage."))
    parser.add_argument("--version", action="store_true", help="print the version and the commit, and end")
    parser.add_argument("--quiet", action="store_true", help="before a command: print warnings and errors only")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND", parser_class=OneLineParser)
    run = {"reference": [make_parser("reference", "reference")]} if whole else {}
    for name, purpose in DELEGATED.items():
        commands.add_parser(name, help=purpose, parents=run.get(name, []), conflict_handler="resolve")
    for name, (function, purpose, arguments) in COMMANDS.items():
        command = commands.add_parser(name, help=purpose, description=purpose, allow_abbrev=False)
        command.set_defaults(command=function)
        for add in arguments:
            add(command)
    return parser


def _command(purpose, *arguments):
    """Make a function the command of its name."""
    def keep(function):
        COMMANDS[function.__name__.strip("_").replace("_", "-")] = function, purpose, arguments
        return function
    return keep


def _arg(*names, **options):
    return lambda command: command.add_argument(*names, **options)


def _path(name, metavar, help_=None, **options):
    return _arg(name, type=file_path, metavar=metavar, help=help_, **options)


def _out(help_, metavar="DIR", required=True):
    return _path("--out", metavar, help_, required=required)


_HISTORY = _path("history", "FILE.h5")
_HISTORIES = _path("histories", "FILE.h5", nargs="+")
_JSON = _arg("--json", action="store_true", help="as JSON")
_DRIFT_LIMIT = _arg("--drift-limit-pct", type=number_from(1e-6, 100), default=2.0, help="drift limit (default 2)")


def _threshold(of):
    return _arg("--threshold-mm", type=number_from(1e-6, 1000), default=0.1, help=f"of {of} (default 0.1)")


_PSI_FROM = _arg("--psi-from-mm", type=number_from(1e-6, 1000), default=0.02,
                 help="width from which a crack counts in Psi (default 0.02; 0.1 is what an eye sees)")


def _print_found(asked, found, describe):
    print(json_text(found, indent=2) if asked.json else "\n".join(map(one_line, describe(found).split("\n"))))


def _save(figures, folder, made=""):
    """Write figures, pairs (name, Figure), with the command that made them; print their paths to stderr, because stdout
    may be JSON."""
    from damage.draw.style import save_figures

    for path in save_figures(figures, folder, made):
        if not isinstance(sys.stdout, _Silence):
            print(f"picture: {path}", file=sys.stderr)


# --- first steps --------------------------------------------------------------------------------------

@_command("a first run, in half a minute: the façade that ships under a harmonic motion, with pictures and a report",
          _path("--out", "DIR", "where everything goes (default demo)", default=Path("demo")),
          _arg("--overwrite", action="store_true", help="replace what a demo before has left there"))
def _demo(asked):
    from damage.reference.session import run_reference

    history = asked.out / "symmetric.h5"
    status = run_reference(["symmetric", "--harmonic", "0.2", "0.05", "--rest", "1", "--out", str(history),
                            *["--overwrite"] * asked.overwrite])
    if status:
        return status
    try:
        from damage.html.report import write_report

        print(f"report: {write_report([history])}")
    except ImportError as error:  # of the extra masonry-damage[report]
        print(f"no report: {missing_library(error) or error}")
    print("next: python3 -m damage new-wall my_wall.py, and its first lines say how to run it")
    return 0


@_command("write a wall file to change: a copy of a wall that ships, under the name of the file",
          _path("file", "FILE.py"),
          _arg("--from", dest="source", metavar="NAME", default="symmetric", help="the wall that is copied (default "
               "symmetric); an unknown one lists all"))
def _new_wall(asked):
    from damage.wall.new import new_wall

    path = new_wall(asked.file, asked.source)
    print(f"{path}: change its numbers, then: python3 -m damage reference {path} --harmonic 0.2 0.05")


@_command("masonry and brick formats by name, with values and sources, for damage.masonry(MATERIAL, FORMAT)", _JSON)
def _materials(asked):
    from damage.wall.materials import as_dict, describe

    print(json_text(as_dict(), indent=2) if asked.json else describe())


# --- a history, a wall, a record --------------------------------------------------------------------

@_command("the damage index and key numbers of a history", _HISTORY, _JSON, _threshold("opening and slip"),
          _DRIFT_LIMIT, _arg("--slip", choices=SLIP_CRITERIA, default="displacement",
                             help="when a joint counts as slipped (default displacement)"), _PSI_FROM)
def _index(asked):
    from damage.measure.summary import summarise
    from damage.run.report import describe, with_members

    history = read_history(asked.history)
    summary = with_members(summarise(history, asked.threshold_mm * MILLIMETRE, asked.drift_limit_pct / 100,
                                     asked.slip, asked.psi_from_mm * MILLIMETRE), history)
    warn(*summary["warnings"])
    _print_found(asked, summary, describe)


@_command("whether histories are complete, ended early, still open or damaged; exit status 2 where one is damaged, 1 "
          "where one has no end", _HISTORIES, _JSON)
def _check(asked):
    from damage.history.info import DAMAGED, UNSEALED, WHOLE, check, describe_check

    checked = [check(path) for path in asked.histories]
    _print_found(asked, checked, describe_check)
    found = {one["worth"] for one in checked}
    return 2 if DAMAGED in found else int(not found <= {WHOLE, UNSEALED})


@_command("what made a history: software, command, inputs, every parameter", _HISTORY, _JSON)
def _info(asked):
    from damage.history.info import describe, info

    _print_found(asked, info(read_history(asked.history)), describe)


@_command("cycles, envelope and failure mode of a pushed wall", _HISTORY, _JSON)
def _cycles(asked):
    from damage.laboratory.pushed import describe, pushed_report

    _print_found(asked, pushed_report(read_history(asked.history)), describe)


@_command("pushed laboratory walls beside their tests", _HISTORIES, _out("folder for the pictures"))
def _laboratory(asked):
    from damage.laboratory.pictures import save

    print(*save(map(read_history, asked.histories), asked.out), sep="\n")


@_command("natural periods of a wall with intact joints", _path("wall", "WALL",
          f"a wall file, or the name of a wall that ships. {WALLS_ARE_CODE}"), _JSON,
          lambda command: add_model_options(command, (
              "top", "load", "cells", "contacts", "bricks", "brick_order", "plane", "brick_mass")), add_accept,
          _out("folder for a picture of the shapes", required=False))
def _modes(asked):
    from damage.wall.caps import describe_top
    from damage.wall.floors import describe_floors
    from damage.wall.layout import lay_out
    from damage.wall.modes import natural_modes

    layout = lay_out(_plausible_wall(asked), model_of(asked))
    modes = natural_modes(layout)
    if asked.out:
        from damage.draw.modes import modes_picture

        _save([("modes", modes_picture(layout, modes))], asked.out)
    periods = [float(period) for period in modes.period_s]
    if asked.json:
        print(json_text({"period_s": periods, "critical_time_step_s": modes.critical_time_step_s,
                          "pier_stress_pa": layout.pier_stress}))
        return
    print(*describe_top(layout), *describe_floors(layout.wall), sep="\n")
    for number, period in enumerate(periods, start=1):
        print(f"mode {number}: {period:.5f} s")
    print(f"critical time step: {modes.critical_time_step_s:.4g} s")


@_command("a picture of a wall before it is run: bricks, supports, masses, elastic joints, names of piers and "
          "spandrels",
          _path("wall", "WALL", f"a wall file, or the name of a wall that ships. {WALLS_ARE_CODE}"),
          lambda command: add_model_options(command, ("lintel", "top", "load", "supports")), add_accept,
          _out("the picture (default: the wall's name, .png, in the working folder)", "FILE.png|FILE.svg|FILE.pdf",
               required=False))
def _draw(asked):
    from damage.draw.preview import wall_preview
    from damage.draw.style import save_picture
    from damage.wall.geometry import body_table, joint_table
    from damage.wall.layout import lay_out

    wall = _plausible_wall(asked)
    layout = lay_out(wall, model_of(asked))
    supports = tuple(zip(layout.supports.left, layout.supports.right))
    figure = wall_preview(wall, body_table(layout), joint_table(layout), supports)
    print(save_picture(figure, asked.out or Path(f"{wall.name}.png"), f"wall {shown_path(asked.wall)}"))


def _plausible_wall(asked):
    """The wall of a command's options, its values checked unless the user accepts all."""
    from damage.wall.file import load_wall
    from damage.wall.plausible import check_plausible

    wall = load_wall(asked.wall)
    if not asked.accept_implausible:
        check_plausible(wall)
    return wall


@_command("intensity measures of a ground-motion record as a run with these options applies it: nothing is filtered "
          "unless --band is given", _path("record", "FILE|NAME", "CSV or plain text (time_s and acc_m_s2, acc_cm_s2, "
          "acc_gal or acc_g; semicolons and decimal commas are read), PEER AT2, miniSEED, or a record that ships, as "
          "BGAR_HGE"), _JSON, add_preparation,
          _path("--plot", "FILE.png", "write a picture: acceleration, velocity and response spectrum"))
def _record(asked):
    from damage.motion.intensity import describe, motion_summary
    from damage.motion.plausible import implausible_peak

    loading = recorded(asked)
    found = motion_summary(loading)
    if implausible := implausible_peak(found["pga_g"]):
        warn(implausible)
    if asked.plot:
        _plot_motion(loading, found, asked.plot)
    _print_found(asked, found, describe)


def _plot_motion(loading, found, path):
    """Write the picture of a motion; its path goes to stderr: stdout may be JSON."""
    from damage.draw.motion import motion_picture
    from damage.draw.style import save_png

    if path.suffix.lower() != ".png":
        raise InputError(f"--plot {path}: expected a name that ends in .png; give it one")
    print(f"picture: {save_png(motion_picture(loading, found), path, f'motion {loading.name}')}", file=sys.stderr)


@_command("the pictures of a history, PNG and PDF", _HISTORY, _out("folder for the pictures"))
def _plot(asked):
    from damage.draw.run import save_all

    print(*save_all(read_history(asked.history), asked.out), sep="\n")


@_command("the moving wall and its cracks as GIF, or as MP4 where ffmpeg is there", _HISTORY,
          _out("the film (default: beside the history, .gif)", "FILE.gif|FILE.mp4", required=False),
          _arg("--window", nargs=2, type=float, metavar=("T0_S", "T1_S"), help="part of the run (default: all of it, "
               "or of a long one what is around its maximum DI)"),
          _arg("--magnify", type=number_from(0, 1e6), metavar="FACTOR", help="on displacements (default: what makes "
               "them visible)"))
def _animate(asked):
    from damage.draw.animation import write_film

    print(write_film(read_history(asked.history), asked.out or asked.history.with_suffix(".gif"), asked.window,
                     asked.magnify))


@_command("a history for ParaView, or the tables of a study for other programs",
          _path("source", "FILE.h5|STUDY_DIR", "a history, or the folder of a study, as results/quick"),
          _path("--vtkhdf", "FILE.vtkhdf", "of a history: one file with all samples, for ParaView 5.12 or newer"),
          _path("--vtk", "DIR", "of a history: a VTU file a snapshot and a PVD file that lists them, for any ParaView"),
          _path("--parquet", "DIR", "of a study: runs.parquet and points.parquet (needs pyarrow)"),
          _path("--netcdf", "FILE.nc", "of a study: both tables as netCDF (needs xarray and h5netcdf)"))
def _export(asked):
    from damage.export.study import write_netcdf, write_parquet
    from damage.export.vtkhdf import write_vtkhdf
    from damage.export.vtu import write_vtu

    if not (asked.vtkhdf or asked.vtk or asked.parquet or asked.netcdf):
        raise InputError("export without a format: expected --vtkhdf FILE.vtkhdf or --vtk DIR of a history, --parquet "
                         "DIR or --netcdf FILE.nc of a study; give one")
    history = read_history(asked.source) if asked.vtkhdf or asked.vtk else None
    if asked.vtkhdf:
        print(write_vtkhdf(history, asked.vtkhdf))
    if asked.vtk:
        print(write_vtu(history, asked.vtk))
    if asked.parquet:
        print(*write_parquet(asked.source, asked.parquet), sep="\n")
    if asked.netcdf:
        print(write_netcdf(asked.source, asked.netcdf))


@_command("compare a history with another, or an ensemble", _path("first", "A.h5"),
          _path("others", "B.h5", "of several the median counts", nargs="+"), _JSON,
          _out("folder for a picture of drift and joints", required=False))
def _compare(asked):
    from damage.measure.compare import compare, describe

    first, others = read_history(asked.first), [read_history(path) for path in asked.others]
    result = compare(first, others)
    if asked.out:
        from damage.draw.compare import compare_picture
        from damage.history.info import origin

        _save([("compare", compare_picture(first, others[0]))], asked.out,
              "\n".join(map(origin, (first, others[0]))))
    _print_found(asked, result, describe)


@_command("tables of histories as CSV: of one run over time, or one row per run",
          _arg("what", choices=("run", "summary")), _HISTORIES,
          _out("STEM of STEM_index.csv and so on, or the summary's file", "STEM|FILE.csv"))
def _tables(asked):
    from damage.measure.tables import summary_table, write_run_tables, write_table

    if asked.what == "summary":
        write_table(summary_table(asked.histories), asked.out)
    else:
        for path in asked.histories:
            write_run_tables(read_history(path), asked.out)


@_command("one HTML file to send: a run, runs side by side, or a study, for any browser, without a network",
          _path("paths", "PATH", "a history (.h5), up to six of them, or the folder of studies", nargs="+"),
          _out("the file (default: beside the first PATH, of its name, or report.html in a folder)", "FILE.html",
               required=False),
          _arg("--title", metavar="WORDS", help="of the report (default: what ran)"),
          _arg("--author", metavar="NAME", help="who wrote it, below the title"),
          _arg("--text", metavar="WORDS", help="what it begins with, as what was asked and what follows; blank lines "
               "separate paragraphs"))
def _report(asked):
    from damage.html.report import Words, write_report

    print(write_report(asked.paths, asked.out, Words(asked.title, asked.author, asked.text)))


_ADDRESS = (
          _arg("--at", nargs=2, type=float, metavar=("LAT", "LON"), help="the address, degrees in WGS84"),
          _arg("--rd", nargs=2, type=float, metavar=("X", "Y"), help="instead: metres in the Dutch grid (EPSG:28992)"),
          _arg("--vs30", type=float, default=200.0, metavar="M_S", help="mean shear-wave velocity of the upper 30 m "
               "(default 200)"),
          _arg("--from", dest="first", type=int, metavar="YEAR", help="first year (default: the catalogue's)"),
          _arg("--to", dest="last", type=int, metavar="YEAR", help="last year (default: the catalogue's)"),
          _path("--catalogue", "FILE", "events: CSV, or the text of an FDSN event service (default: KNMI's list for "
                "the field, 1991-12 to 2022-01, which ships)"),
          _arg("--component", metavar="LRG|GEO|MAX", help="larger of both horizontal components (default), their "
               "geometric mean, or the largest in any direction"),
          _arg("--model", default="bommer-2022", metavar="NAME", help="ground-motion model (default bommer-2022)"))
"""Options of the commands that are about an address; `_exposure_of` reads them."""


def _exposure_of(asked):
    from damage.exposure.catalogue import SHIPPED, read_catalogue
    from damage.exposure.exposure import Exposure
    from damage.exposure.ground_motion import model_named
    from damage.exposure.places import at, at_rd

    if (asked.at is None) == (asked.rd is None):
        raise InputError("exposure of which address? expected --at LAT LON or --rd X Y; give one of them")
    return Exposure(at(*asked.at) if asked.at else at_rd(*asked.rd),
                    read_catalogue(asked.catalogue or SHIPPED).between(asked.first, asked.last),
                    model_named(asked.model, asked.component), asked.vs30)


@_command("the ground motion at an address in the Groningen field: PGV of every earthquake of a catalogue", *_ADDRESS,
          _JSON, _out("folder for the table of all events and the picture", required=False))
def _exposure(asked):
    from damage.exposure.exposure import describe

    exposure = _exposure_of(asked)
    if asked.out:
        from damage.draw.exposure import exposure_picture
        from damage.measure.tables import write_table

        print(f"table: {write_table(exposure.table(), asked.out / 'exposure.csv')}", file=sys.stderr)
        _save([("exposure", exposure_picture(exposure))], asked.out, "exposure")
    _print_found(asked, exposure.as_dict(), describe)


@_command("lives of a wall at an address in the Groningen field: the earthquakes of the catalogue one after the other, "
          "damage carried over, their motions and the joints' strengths drawn",
          _path("wall", "WALL", f"a wall file, or the name of a wall that ships. {WALLS_ARE_CODE}"), *_ADDRESS,
          _arg("--draws", type=number_from(1, 100000, int), default=10, metavar="N", help="lives (default 10)"),
          _arg("--seed", type=number_from(0, 2**31, int), default=0, help="of the draws (default 0)"),
          _arg("--above", type=number_from(0.01, 1000), default=2.0, metavar="MM_S", help="PGV from which an event is "
               "part of a life (default 2)"),
          _arg("--within", type=number_from(0.1, 1000), default=10.0, metavar="KM", help="stations whose records are "
               "used (default 10 km from the epicentre)"),
          _arg("--rest", type=number_from(0, 100), default=0.5, metavar="S", help="free vibration after each event "
               "(default 0.5)"),
          _arg("--strength-cov", type=number_from(0, 2), default=0.3, metavar="COV", help="scatter of the joints' "
               "strengths (default 0.3)"),
          _out("folder for tables and picture; lives that are there are not run again"))
def _life(asked):
    from damage.draw.life import life_picture
    from damage.life.draw import Draws
    from damage.life.runs import describe, over_time, run_lives, write_lives

    exposure = _exposure_of(asked)
    years, count = exposure.catalogue.years, asked.draws
    table = run_lives(asked.wall, Draws(exposure, asked.above, asked.within, asked.seed), count, asked.out,
                      rest=asked.rest, strength_cov=asked.strength_cov)
    print(*write_lives(table, years, count, asked.out), sep="\n")
    place = f"{exposure.place.latitude:.4f}, {exposure.place.longitude:.4f}"
    title = f"{count} lives of wall {Path(asked.wall).stem} at {place}"
    _save([("life", life_picture(table, over_time(table, count, years), title))], asked.out, title)
    print(describe(table, count, years))


# --- studies ----------------------------------------------------------------------------------------

@_command("figures 6 to 12 of the source paper and crack maps from the results of studies",
          _path("results", "RESULTS_DIR", "folder that holds the studies' folders, each with tables/points.csv"),
          _out("folder for the figures"),
          _path("--records", "DIR", "folder of records that do not ship (default records)", default=Path("records")))
def _figures(asked):
    from damage.studies.figures import make_figures
    from damage.studies.results import load_results

    made = 0
    for name, outcome in make_figures(load_results(asked.results, asked.records), asked.out):
        if isinstance(outcome, str):
            print(f"not made: {name}: {outcome}")
            continue
        made += 1
        print(*outcome, sep="\n", flush=True)
    if made == 0:
        raise InputError(f"{asked.results} allows no figure; expected results of the studies harmonic or ida")


@_command("judge the paper's statements by the tables of studies",
          _path("results", "RESULTS_DIR", "folder with studies below it"), _JSON,
          _path("--markdown", "FILE", "write the document, too"),
          _path("--readme", "README.md", "renew the results between its markers, too"))
def _paper(asked):
    from damage.paper.report import as_json, as_markdown, describe, update_readme
    from damage.paper.verdict import judge

    findings = judge(asked.results)
    if asked.markdown:
        write_text(asked.markdown, as_markdown(findings))
    if asked.readme:
        update_readme(findings, asked.readme)
    print(json_text(as_json(findings), indent=2) if asked.json else describe(findings))


@_command("which modelling choices move the paper's claims, by the tables of the study readings",
          _path("results", "RESULTS_DIR", "folder with the study below it"),
          _path("--markdown", "FILE", "write the document, too"))
def _readings(asked):
    from damage.paper.readings import as_markdown, conclusions, judge_readings, table

    found = judge_readings(asked.results)
    if asked.markdown:
        write_text(asked.markdown, as_markdown(found))
    print("\n".join([*table(found), "", *conclusions(found)]))


@_command("combined modelling choices by the paper's claims that they meet, by the tables of the study combinations",
          _path("results", "RESULTS", "folder with the study below it"),
          _path("--markdown", "FILE", "write the document, too"))
def _combinations(asked):
    from damage.paper.combinations import (
        as_markdown,
        conclusions,
        judge_combinations,
        table_of_best,
        table_of_effects,
    )

    found = judge_combinations(asked.results)
    if asked.markdown:
        write_text(asked.markdown, as_markdown(found))
    print("\n".join([*conclusions(found), "", *table_of_best(found), "", *table_of_effects(found)]))


@_command("cracks, Psi and index of a history, of digitised cracks or of a DIC field",
          _path("source", "FILE", "a history (.h5) or a crack file (CSV)", nargs="?"),
          _path("--dic", "FIELD.csv", "instead of FILE: a DIC displacement field"),
          _path("--wall", "walls/NAME.py", f"the wall of a crack file or a field. {WALLS_ARE_CODE}"),
          _path("--export", "CRACKS.csv", "write the cracks of a history or a field as a crack file"),
          _arg("--at", metavar="MOMENT,...", help="of a history: max, end, times [s] (default max,end)"),
          _threshold("opening, slip and width"), _PSI_FROM, _DRIFT_LIMIT,
          _arg("--tolerance-mm", type=number_from(1e-3, 1000),
               help="how far from a joint a crack may be drawn (default: half a brick's height)"),
          _arg("--margin-mm", type=number_from(0, 1000),
               help="of a field: how far inside a brick's edges points count (default 10)"),
          _out("folder for a picture of each load level", required=False), _JSON)
def _cracks(asked):
    from damage.laboratory.crack_report import crack_report, describe

    report, drawn = crack_report(**{name: value for name, value in vars(asked).items()
                                    if name not in ("command", "json", "version", "quiet")})
    if asked.out:
        from damage.laboratory.crack_picture import crack_pictures

        _save(crack_pictures(*drawn, asked.threshold_mm * MILLIMETRE), asked.out,
              f"cracks of {shown_path(asked.source or asked.dic)}")
    _print_found(asked, report, describe)


@_command("probabilities of exceeding levels of damage, from a study with scattered strengths",
          _path("study", "STUDY_DIR", "folder of a study, as results/fragility"),
          _out("folder for tables and pictures"),
          _arg("--intensity", metavar="COLUMN", help="column of summary.csv with a number above zero in every run "
               "(default: that of the study file, else sa_eigen_period_g; PGA is pga_g)"),
          _arg("--state", action="append", dest="states", metavar="STATE", help="damage state, a column of summary.csv "
               'and the level that it exceeds, as "moderate: max_psi > 2"; may be repeated (default: those of the '
               "study file, else levels of DI, crack width and Psi)"),
          _arg("--at", type=number_from(1e-12, 1e12), nargs="+", metavar="X", help="also print the probability at "
               "these intensities, with its intervals"),
          _arg("--leave-one-out", action="store_true", help="compare each record with the curves of all others"),
          _path("--unseen", "STUDY_DIR", "compare the runs of this other study with the curves"),
          _arg("--after-damage", action="store_true", help="of a study of sequences: by Psi before each shock"),
          _arg("--replicates", type=number_from(0, 100_000, int), default=500, metavar="N",
           help="bootstrap samples (default 500)"),
          _path("--export", "DIR", "folder for the curves in other tools' formats: NRML (OpenQuake), a CSV of "
                "coefficients with units, arrays"))
def _fragility(asked):
    from damage.measure.columns import made_by_words
    from damage.studies.fragility import STATES, load_runs
    from damage.studies.states import leading, parse_state, study_choices

    clash = [name for name in ("export", "at", "leave_one_out", "unseen") if getattr(asked, name)]
    if asked.after_damage and clash:
        raise InputError(f"--{clash[0].replace('_', '-')} with --after-damage: expected one of them; leave one out")
    chosen = study_choices(asked.study)
    states = tuple(map(parse_state, asked.states or chosen["states"])) or STATES
    runs = load_runs(asked.study)
    intensity = asked.intensity or chosen["intensity"] or leading(runs)
    draw = _fragility_after_damage if asked.after_damage else _fragility_curves
    figures = draw(asked, runs, intensity, states)
    _save(figures, asked.out, f"study {shown_path(asked.study)}; {made_by_words(runs)}")


def _fragility_after_damage(asked, runs, intensity, states):
    """Tables of `--after-damage`; returns its figures."""
    from damage.measure.tables import write_table
    from damage.studies.after_damage import load_shocks, table_after_damage
    from damage.studies.fragility_picture import picture_after_damage

    shocks = load_shocks(runs, asked.study, states)
    table = table_after_damage(shocks, intensity, asked.replicates, states)
    print(table.to_string(index=False, float_format="%.3f"))
    print(write_table(table, asked.out / f"fragility_after_damage_{intensity}.csv"))
    drawn = {} if asked.states is None else {"states": states}
    return [(f"fragility_after_damage_{wall}_{intensity}", picture_after_damage(
        wall, of_wall, table[table["wall"] == wall], intensity, **drawn)) for wall, of_wall in shocks.groupby("wall")]


def _fragility_curves(asked, runs, intensity, states):
    """Tables and exports of fragility curves; returns their figures."""
    from damage.measure.columns import slip_criteria
    from damage.measure.tables import write_table
    from damage.studies.fragility import at_intensities, efficiency_table, fit_all, fragility_table, in_words, load_runs
    from damage.studies.fragility_picture import fragility_pictures
    from damage.studies.left_out import beside_unseen, leave_one_out, scores

    fits = fit_all(runs, intensity, asked.replicates, states)
    print(in_words(fits))
    print(write_table(fragility_table(fits, intensity).assign(slip=" or ".join(slip_criteria(runs))),
                      asked.out / f"fragility_{intensity}.csv"))
    tables = {"efficiency": efficiency_table(runs, states, intensity)}
    if asked.at:
        tables[f"fragility_{intensity}_at"] = at_intensities(fits, asked.at)
    compared = {"left_out": lambda: leave_one_out(runs, states)} if asked.leave_one_out else {}
    if asked.unseen:
        compared["unseen"] = lambda: beside_unseen(runs, load_runs(asked.unseen), states)
    for name, compare in compared.items():
        table = compare()
        print(write_table(table, asked.out / f"{name}.csv"))
        tables[f"{name}_scores"] = scores(table)
    for name, table in tables.items():
        print(table.to_string(index=False, float_format="%.3f"))
        print(write_table(table, asked.out / f"{name}.csv"))
    if asked.export:
        from damage.export.curves import left_out, write_curves

        print(*write_curves(fits, asked.export, runs.groupby("wall")["eigen_period_s"].median()), sep="\n")
        print(*left_out(fits), sep="\n", end="\n" if left_out(fits) else "")
    return fragility_pictures(runs, fits, intensity)


@_command("the tables of a study, from the runs that exist so far", _path("study", "STUDY.toml"),
          _path("folder", "DIR", "the study's folder; tables go to DIR/tables"),
          _arg("--solver", choices=("yade", "reference", "both"), default="both",
           help="whose runs the study names (default both)"),
          _path("--root", "DIR", "where walls and records lie (default: the working folder)"),
          _arg("-j", dest="jobs", type=number_from(1, 1000, int), default=1, metavar="N", help="processes (default 1)"))
def _study_tables(asked):
    from damage.studies.definition import load_study
    from damage.studies.tables import write_study_tables

    print(*write_study_tables(load_study(asked.study, asked.solver, asked.root), asked.folder, asked.jobs), sep="\n")


@_command("the JSON Schema of study files, by which editors complete and check them: put it beside yours, and "
          "'#:schema ./study.schema.json' on its first line")
def _study_schema(asked):
    from damage.studies.schema import study_schema

    print(json_text(study_schema(), indent=1))


@_command("the JSON Schema of walls as TOML, by which editors complete and check them: put it beside yours, and "
          "'#:schema ./wall.schema.json' on its first line")
def _wall_schema(asked):
    from damage.wall.data import wall_schema

    print(json_text(wall_schema(), indent=1))


@_command("the data dictionary: every column of every table, as dictionary.csv and dictionary.md",
          _out("folder for both"))
def _dictionary(asked):
    from damage.export.dictionary import write_dictionary

    print(*write_dictionary(asked.out), sep="\n")


if __name__ == "__main__":
    leave(main())
