"""Commands about histories, and the tests and cracks that they are compared with."""

from dataclasses import fields

from damage.commands.table import (
    DAMAGE,
    DRIFT_LIMIT,
    HISTORIES,
    HISTORY,
    JSON,
    PSI_FROM,
    command,
    out,
    output,
    save,
    show,
    threshold,
)
from damage.commands.walls import plausible_wall
from damage.errors import InputError, warn
from damage.history.info import DAMAGED, WHOLE, check, describe_check, info, origin
from damage.history.info import describe as describe_info
from damage.history.reader import read_history
from damage.index import SLIP_CRITERIA
from damage.provenance import shown_path
from damage.run.options import ACCEPTING, WALLS_ARE_CODE, arg, file_arg, group, model_arguments, model_of, number_from
from damage.units import MILLIMETRE
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions

MODEL = tuple(one.name for one in fields(ModelOptions) if one.name not in (
    "fibres", "brick_order", "plane", "brick_mass", "brick_damping"))
"""Options of a wall's model that export offers; the others are of what it cannot write."""


@command("the damage index and key numbers of a history", HISTORY, JSON, threshold("opening and slip"),
         DRIFT_LIMIT, group(DAMAGE, arg("--slip", choices=SLIP_CRITERIA, default="displacement",
                                        help="when a joint counts as slipped (default displacement)")), PSI_FROM)
def _index(asked):
    from damage.measure.summary import summarise
    from damage.run.report import describe, with_members

    history = read_history(asked.history)
    summary = with_members(summarise(history, asked.threshold_mm * MILLIMETRE, asked.drift_limit_pct / 100,
                                     asked.slip, asked.psi_from_mm * MILLIMETRE), history)
    warn(*summary["warnings"])
    show(asked, summary, describe)


@command("whether histories are complete, ended early, still open or damaged; exit status 2 where one is damaged, 1 "
         "where one has no end", HISTORIES, JSON)
def _check(asked):
    checked = [check(path) for path in asked.histories]
    show(asked, checked, describe_check)
    found = {one["worth"] for one in checked}
    return 2 if DAMAGED in found else int(not found <= {WHOLE})


@command("what made a history: software, command, inputs, every parameter", HISTORY, JSON)
def _info(asked):
    show(asked, info(read_history(asked.history)), describe_info)


@command("cycles, envelope, failure mode and figures of a pushed wall; of several draws of its strengths median and "
         "quantiles", HISTORIES, JSON,
         arg("--to", type=number_from(1e-4, 100), metavar="DRIFT_PCT", help="drift to which the force is averaged "
             "(default: ultimate drift of the test that the wall models, else of the run)"))
def _cycles(asked):
    from damage.laboratory.pushed import describe, describe_draws, draws_report, pushed_report

    histories, to = [read_history(path) for path in asked.histories], asked.to and asked.to / 100
    if len(histories) == 1:
        show(asked, pushed_report(histories[0], to), describe)
    else:
        show(asked, draws_report(histories, to), describe_draws)


@command("the pictures of a history, PNG and PDF", HISTORY, out("folder for the pictures"))
def _plot(asked):
    from damage.draw.run import save_all

    print(*save_all(read_history(asked.history), asked.out), sep="\n")


@command("stresses of the joints of a run with --stresses: at moments, of chosen joints over time, thrust in piers and "
         "arches", HISTORY, JSON,
         arg("--at", metavar="MOMENT,...", default="rest,max,end", help="rest, max, end, times [s] (default "
             "rest,max,end)"),
         arg("--joint", action="append", default=[], metavar="NAME", help="a row of the joints, the place X,Z [m] of "
             "the nearest, or bed:X,Z, head:X,Z; repeatable"),
         out("folder for tables, of each joint over time too, and pictures", required=False))
def _stresses(asked):
    from damage.measure.joint_stress import describe, stress_report

    history, moments = read_history(asked.history), list(dict.fromkeys(asked.at.split(",")))
    report = stress_report(history, moments, asked.joint)
    if asked.out:
        from damage.draw.run import contact_force_picture
        from damage.measure.tables import write_stresses

        write_stresses(history, asked.out, moments, [one["joint"] for one in report["joints"]])
        save([(f"contact_forces_{moment}", contact_force_picture(history, moment)) for moment in moments], asked.out,
             origin(history))
    show(asked, report, describe)


@command("the moving wall and its cracks as GIF, or as MP4 where ffmpeg is there", HISTORY,
         out("the film (default: beside the history, .gif)", "FILE.gif|FILE.mp4", required=False),
         arg("--window", nargs=2, type=float, metavar=("T0_S", "T1_S"), help="part of the run (default: all of it, "
              "or of a long one what is around its maximum DI)"),
         arg("--magnify", type=number_from(0, 1e6), metavar="FACTOR", help="on displacements (default: what makes "
              "them visible)"))
def _animate(asked):
    from damage.draw.animation import write_film

    print(write_film(read_history(asked.history), asked.out or asked.history.with_suffix(".gif"), asked.window,
                     asked.magnify))


@command("a history for ParaView, the tables of a study, or a wall, for other programs",
         file_arg("source", "FILE.h5|STUDY_DIR|WALL", "a history, the folder of a study, as results/quick, or a wall "
                  f"file or the name of a wall that ships. {WALLS_ARE_CODE}"),
         group("the model of a wall", *model_arguments(*MODEL), ACCEPTING),
         output(
             file_arg("--vtkhdf", "FILE.vtkhdf", "of a history: one file with all samples, for ParaView 5.12 or newer"),
             file_arg("--parquet", "DIR", "of a study: runs.parquet and points.parquet (needs pyarrow)"),
             file_arg("--netcdf", "FILE.nc", "of a study: both tables as netCDF (needs xarray and h5netcdf)"),
             file_arg("--opensees", "FILE.py", "of a wall: a model with interface elements for OpenSeesPy"),
             file_arg("--3dec", "FILE.dat", "of a wall: rigid blocks and joints for 3DEC 7", dest="deck")))
def _export(asked):
    from damage.export.study import write_netcdf, write_parquet
    from damage.export.vtkhdf import write_vtkhdf

    of_wall, of_results = asked.opensees or asked.deck, asked.vtkhdf or asked.parquet or asked.netcdf
    if not (of_wall or of_results):
        raise InputError("export without a format: expected --vtkhdf FILE.vtkhdf of a history, --parquet DIR or "
                         "--netcdf FILE.nc of a study, --opensees FILE.py or --3dec FILE.dat of a wall; give one")
    if of_results and (of_wall or model_of(asked) != ModelOptions()):
        raise InputError(f"export of {asked.source} with options of a wall's model, or a format of walls: expected "
                         "them for a wall only; leave them out")
    if of_wall:
        _export_wall(asked)
    if asked.vtkhdf:
        print(write_vtkhdf(read_history(asked.source), asked.vtkhdf))
    if asked.parquet:
        print(*write_parquet(asked.source, asked.parquet), sep="\n")
    if asked.netcdf:
        print(write_netcdf(asked.source, asked.netcdf))


def _export_wall(asked):
    from damage.export.opensees import write_opensees
    from damage.export.threedec import write_3dec

    if asked.source.suffix.lower() == ".h5" or asked.source.is_dir():
        raise InputError(f"export of {asked.source} for OpenSees or 3DEC: expected a wall file, or the name of a wall "
                         "that ships; give the wall that was run")
    layout = lay_out(plausible_wall(asked, asked.source), model_of(asked))
    if asked.deck:  # first, since it refuses all that --opensees does, and more: then neither file is written
        path, said = write_3dec(layout, asked.deck)
        warn(*said)
        print(path)
    if asked.opensees:
        print(write_opensees(layout, asked.opensees))


@command("compare a history with another, an ensemble, or the survey of a real wall", file_arg("first", "A.h5"),
         file_arg("others", "B.h5|SURVEY.csv", "of several histories the median counts; a crack file is compared with "
                  "the end of each history", nargs="+"), JSON,
         out("folder for a picture of drift and joints", required=False))
def _compare(asked):
    from damage.measure.compare import compare, describe

    paths = asked.first, *asked.others
    if surveys := [path for path in paths if path.suffix.lower() == ".csv"]:
        _compare_survey(asked, surveys, [path for path in paths if path not in surveys])
        return
    first, others = read_history(asked.first), [read_history(path) for path in asked.others]
    result = compare(first, others)
    if asked.out:
        from damage.draw.compare import compare_picture

        save([("compare", compare_picture(first, others[0]))], asked.out,
              "\n".join(map(origin, (first, others[0]))))
    show(asked, result, describe)


def _compare_survey(asked, surveys, paths):
    from damage.measure.survey import beside, describe_beside, read_survey

    if len(surveys) > 1 or not paths or asked.out:
        raise InputError(f"compare with {surveys[0]}: expected one survey, histories beside it, and no --out; "
                         "correct it")
    found = []
    for history in map(read_history, paths):
        layout = lay_out(history.masonry_wall, history.model)
        found.append({"run": str(history.path)} | beside(
            read_survey(surveys[0], layout), history.opening_m[-1], history.slip_by("displacement")[-1], layout))
    show(asked, found, lambda found: "\n".join(line for one in found for line in (one["run"], *describe_beside(one))))


@command("tables of histories as CSV: of one run over time, or one row per run",
         arg("what", choices=("run", "summary")), HISTORIES,
         out("STEM of STEM_index.csv and so on, or the summary's file", "STEM|FILE.csv"))
def _tables(asked):
    from damage.measure.tables import summary_table, write_run_tables, write_table

    if asked.what == "summary":
        write_table(summary_table(asked.histories), asked.out)
        return
    if len(asked.histories) > 1:
        raise InputError(f"tables run of {len(asked.histories)} histories: expected one, as all would have the names "
                         "of --out; give each its own command, or tables summary")
    write_run_tables(read_history(asked.histories[0]), asked.out)


@command("one HTML file to send: a run, runs side by side, or a study, for any browser, without a network",
         file_arg("paths", "PATH", "a history (.h5), up to six of them, or the folder of studies", nargs="+"),
         out("the file (default: beside the first PATH, of its name, or report.html in a folder)", "FILE.html",
              required=False),
         group("words", arg("--title", metavar="WORDS", help="of the report (default: what ran)"),
               arg("--author", metavar="NAME", help="who wrote it, below the title"),
               arg("--text", metavar="WORDS", help="what it begins with, as what was asked and what follows; blank "
                   "lines separate paragraphs"),
               arg("--language", choices=("en", "nl"), default="en", help="of each run's summary (default en); the "
                   "technical part is English")))
def _report(asked):
    from damage.html.report import Words, write_report

    print(write_report(asked.paths, asked.out, Words(asked.title, asked.author, asked.text, asked.language)))


@command("pushed laboratory walls beside their tests", HISTORIES, out("folder for the pictures"))
def _laboratory(asked):
    from damage.laboratory.pictures import save

    print(*save(map(read_history, asked.histories), asked.out), sep="\n")


@command("cracks, Psi and index of a history, of digitised cracks or of a DIC field",
         file_arg("source", "FILE", "a history (.h5) or a crack file (CSV)", nargs="?"),
         group("a history", arg("--at", metavar="MOMENT,...", help="max, end, times [s] (default max,end)")),
         group("a crack file or a DIC field",
               file_arg("--dic", "FIELD.csv", "instead of FILE: a DIC displacement field"),
               file_arg("--wall", "walls/NAME.py", f"the wall of a crack file or a field. {WALLS_ARE_CODE}"),
               arg("--tolerance-mm", type=number_from(1e-3, 1000), metavar="MM", help="of a crack file: how far from "
                   "a joint a crack may be drawn (default: half a brick's height)"),
               arg("--margin-mm", type=number_from(0, 1000), metavar="MM",
                   help="of a field: how far inside a brick's edges points count (default 10)")),
         threshold("opening, slip and width"), PSI_FROM, DRIFT_LIMIT,
         output(file_arg("--export", "CRACKS.csv", "write the cracks of a history or a field as a crack file")),
         out("folder for a picture of each load level, or moment", required=False), JSON)
def _cracks(asked):
    from damage.laboratory.crack_report import crack_report, describe

    report, drawn = crack_report(**{name: value for name, value in vars(asked).items()
                                    if name not in ("command", "json", "version", "quiet")})
    if asked.out:
        from damage.laboratory.crack_picture import crack_pictures

        save(crack_pictures(*drawn, asked.threshold_mm * MILLIMETRE), asked.out,
              f"cracks of {shown_path(asked.source or asked.dic)}")
    show(asked, report, describe)
