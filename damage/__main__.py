"""`python3 -m damage COMMAND`: read histories and records, compute modes, without YADE."""

import json
import sys
from pathlib import Path

from damage.errors import InputError
from damage.index import SLIP_CRITERIA
from damage.run.options import OneLineParser, add_model_options, model_of
from damage.units import MILLIMETRE


def main(arguments=None):
    """Run one command; returns the exit status: 0 done, 2 bad input."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    if arguments[:1] == ["reference"]:  # its options are those of a run, as YADE's are
        return _reference(arguments[1:])
    try:
        parsed = _parser().parse_args(arguments)
        parsed.command(parsed)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:  # the reader of a pipe went away, as `| head` does
        sys.stderr.close()
    except KeyboardInterrupt:
        return 130
    return 0


def _parser():
    parser = OneLineParser(prog="python3 -m damage", allow_abbrev=False,
                           description="Damage of masonry walls under induced seismicity.")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND",
                                     parser_class=OneLineParser)
    _add_command(commands, "reference", None, "run a wall in the reference solver (see reference --help)")
    _add_index(commands)
    _add_cycles(commands)
    _add_laboratory(commands)
    _add_modes(commands)
    _add_record(commands)
    _add_plot(commands)
    _add_compare(commands)
    _add_figures(commands)
    _add_paper(commands)
    _add_cracks(commands)
    _add_fragility(commands)
    return parser


def _add_command(commands, name, function, help_):
    command = commands.add_parser(name, help=help_, description=help_, allow_abbrev=False)
    command.set_defaults(command=function)
    return command


def _reference(arguments):
    """Run a wall file in the built-in solver: the words after `reference`."""
    from damage.reference.session import run_reference

    return run_reference(arguments)


def _add_index(commands):
    command = _add_command(commands, "index", _index, "the damage index and key figures of a history")
    command.add_argument("history", type=Path, metavar="FILE.h5")
    command.add_argument("--json", action="store_true", help="as JSON")
    command.add_argument("--threshold-mm", type=float, default=0.1, help="of opening and slip (default 0.1)")
    command.add_argument("--drift-limit-pct", type=float, default=2.0, help="drift limit (default 2)")
    command.add_argument("--slip", choices=SLIP_CRITERIA, default="displacement",
                         help="when a joint counts as slipped (default displacement)")


def _index(parsed):
    from damage.history.reader import read_history
    from damage.measure.summary import summarise
    from damage.run.report import describe

    summary = summarise(read_history(parsed.history), parsed.threshold_mm * MILLIMETRE,
                        parsed.drift_limit_pct / 100, parsed.slip)
    print(json.dumps(summary, indent=2) if parsed.json else describe(summary))


def _add_cycles(commands):
    command = _add_command(commands, "cycles", _cycles, "cycles, envelope and failure mode of a pushed wall")
    command.add_argument("history", type=Path, metavar="FILE.h5")
    command.add_argument("--json", action="store_true", help="as JSON")


def _cycles(parsed):
    from damage.history.reader import read_history
    from damage.laboratory.pushed import describe, figures

    found = figures(read_history(parsed.history))
    print(json.dumps(found, indent=2) if parsed.json else describe(found))


def _add_laboratory(commands):
    command = _add_command(commands, "laboratory", _laboratory, "pushed laboratory walls beside their tests")
    command.add_argument("histories", type=Path, nargs="+", metavar="FILE.h5")
    command.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the pictures")


def _laboratory(parsed):
    from damage.history.reader import read_history
    from damage.laboratory.pictures import save

    for path in save([read_history(path) for path in parsed.histories], parsed.out):
        print(path)


def _add_modes(commands):
    command = _add_command(commands, "modes", _modes, "natural periods of a wall with intact joints")
    command.add_argument("wall", type=Path, metavar="walls/NAME.py")
    command.add_argument("--json", action="store_true", help="as JSON")
    add_model_options(command, ("top", "cells", "contacts"))
    command.add_argument("--out", type=Path, metavar="DIR", help="folder for a picture of the shapes")


def _modes(parsed):
    from damage.wall.file import load_wall
    from damage.wall.layout import lay_out
    from damage.wall.modes import natural_modes

    layout = lay_out(load_wall(parsed.wall), model_of(parsed))
    modes = natural_modes(layout)
    if parsed.out:
        from damage.draw.modes import modes_picture

        _save([("modes", modes_picture(layout, modes))], parsed.out)
    periods = [float(period) for period in modes.period_s]
    if parsed.json:
        print(json.dumps({"period_s": periods, "critical_time_step_s": modes.critical_time_step_s}))
        return
    for number, period in enumerate(periods, start=1):
        print(f"mode {number}: {period:.5f} s")
    print(f"critical time step: {modes.critical_time_step_s:.4g} s")


def _save(figures, folder):
    """Write figures, pairs (name, Figure), and tell their paths on stderr: stdout may be JSON."""
    from damage.draw.style import save_figures

    try:
        for path in save_figures(figures, folder):
            print(f"picture: {path}", file=sys.stderr)
    except OSError as error:
        raise InputError(f"cannot write to {folder}: {error.strerror}; choose another --out") from error


def _add_record(commands):
    command = _add_command(commands, "record", _record, "intensity measures of a ground-motion record")
    command.add_argument("record", type=Path, metavar="FILE")
    command.add_argument("--json", action="store_true", help="as JSON")


def _record(parsed):
    from damage.motion.formats import read_record
    from damage.motion.intensity import summary

    measures = summary(read_record(parsed.record))
    if parsed.json:
        print(json.dumps(measures, indent=2))
        return
    for name, value in measures.items():
        if name != "sa_g":
            print(f"{name:12s}{value:10.4f}")
    for period, value in measures["sa_g"].items():
        print(f"sa_g({period} s){value:>{19 - len(period) - 5}.4f}")


def _add_plot(commands):
    command = _add_command(commands, "plot", _plot, "the pictures of a history, PNG and PDF")
    command.add_argument("history", type=Path, metavar="FILE.h5")
    command.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the pictures")


def _plot(parsed):
    from damage.draw.run import save_all
    from damage.history.reader import read_history

    try:
        for path in save_all(read_history(parsed.history), parsed.out):
            print(path)
    except OSError as error:
        raise InputError(f"cannot write to {parsed.out}: {error.strerror}; choose another --out") from error


def _add_compare(commands):
    command = _add_command(commands, "compare", _compare, "compare a history with another, or an ensemble")
    command.add_argument("first", type=Path, metavar="A.h5")
    command.add_argument("others", type=Path, nargs="+", metavar="B.h5", help="of several the median counts")
    command.add_argument("--json", action="store_true", help="as JSON")
    command.add_argument("--out", type=Path, metavar="DIR", help="folder for a picture of drift and joints")


def _compare(parsed):
    from damage.history.reader import read_history
    from damage.measure.compare import compare, describe

    first, others = read_history(parsed.first), [read_history(path) for path in parsed.others]
    result = compare(first, others)
    if parsed.out:
        from damage.draw.compare import compare_picture

        _save([("compare", compare_picture(first, others[0]))], parsed.out)
    print(json.dumps(result, indent=2) if parsed.json else describe(result))


def _add_figures(commands):
    command = _add_command(commands, "figures", _figures,
                           "figures 6 to 12 of the source paper and crack maps from the results of studies")
    command.add_argument("results", type=Path, metavar="RESULTS_DIR",
                         help="folder that holds the studies' folders, each with tables/points.csv")
    command.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the figures")


def _figures(parsed):
    from damage.studies.figures import make_figures
    from damage.studies.results import load_results

    made = 0
    try:
        for name, outcome in make_figures(load_results(parsed.results), parsed.out):
            if isinstance(outcome, str):
                print(f"not made: {name}: {outcome}")
                continue
            made += 1
            print(*outcome, sep="\n", flush=True)
    except OSError as error:
        raise InputError(f"cannot write to {parsed.out}: {error.strerror}; choose another --out") from error
    if made == 0:
        raise InputError(f"{parsed.results} allows no figure; expected results of the studies harmonic or ida")


def _add_paper(commands):
    command = _add_command(commands, "paper", _paper, "judge the paper's statements by the tables of studies")
    command.add_argument("results", type=Path, metavar="RESULTS_DIR", help="folder with studies below it")
    command.add_argument("--json", action="store_true", help="as JSON")
    command.add_argument("--markdown", type=Path, metavar="FILE", help="write the document, too")
    command.add_argument("--readme", type=Path, metavar="README.md", help="renew the results between its markers, too")


def _paper(parsed):
    from damage.paper.report import as_json, describe, update_readme, write_markdown
    from damage.paper.verdict import judge

    findings = judge(parsed.results)
    if parsed.markdown:
        write_markdown(findings, parsed.markdown)
    if parsed.readme:
        update_readme(findings, parsed.readme)
    print(json.dumps(as_json(findings), indent=2) if parsed.json else describe(findings))


def _add_cracks(commands):
    command = _add_command(commands, "cracks", _cracks,
                           "cracks, Psi and index of a history, of digitised cracks or of a DIC field")
    command.add_argument("source", type=Path, nargs="?", metavar="FILE", help="a history (.h5) or a crack file (CSV)")
    command.add_argument("--dic", type=Path, metavar="FIELD.csv", help="instead of FILE: a DIC displacement field")
    command.add_argument("--wall", type=Path, metavar="walls/NAME.py", help="the wall of a crack file or a field")
    command.add_argument("--export", type=Path, metavar="CRACKS.csv",
                         help="write the cracks of a history or a field as a crack file")
    command.add_argument("--at", metavar="MOMENT,...", help="of a history: max, end, times [s] (default max,end)")
    command.add_argument("--threshold-mm", type=float, default=0.1, help="of opening, slip and width (default 0.1)")
    command.add_argument("--drift-limit-pct", type=float, default=2.0, help="drift limit (default 2)")
    command.add_argument("--tolerance-mm", type=float,
                         help="how far from a joint a crack may be drawn (default: half a brick's height)")
    command.add_argument("--margin-mm", type=float,
                         help="of a field: how far inside a brick's edges points count (default 10)")
    command.add_argument("--out", type=Path, metavar="DIR", help="folder for a picture of each load level")
    command.add_argument("--json", action="store_true", help="as JSON")


def _cracks(parsed):
    from damage.laboratory import crack_report

    if (parsed.source is None) == (parsed.dic is None):
        raise InputError("expected one of FILE and --dic FIELD.csv; give a history, a crack file or a field")
    limits = {"threshold": parsed.threshold_mm * MILLIMETRE, "drift_limit": parsed.drift_limit_pct / 100}
    if parsed.dic:
        _only_with(parsed, "a DIC field", needs=("wall",), without=("at", "tolerance_mm"))
        margin = 10.0 if parsed.margin_mm is None else parsed.margin_mm
        figures, *drawn = crack_report.field_report(parsed.dic, parsed.wall, margin * MILLIMETRE, export=parsed.export,
                                                    **limits)
    elif crack_report.is_history(parsed.source):
        _only_with(parsed, "a history", without=("wall", "tolerance_mm", "margin_mm", "out"))
        moments = (parsed.at or "max,end").split(",")
        figures = crack_report.history_report(parsed.source, moments, export=parsed.export, **limits)
    else:
        _only_with(parsed, "a crack file", needs=("wall",), without=("at", "export", "margin_mm"))
        tolerance = None if parsed.tolerance_mm is None else parsed.tolerance_mm * MILLIMETRE
        figures, *drawn = crack_report.file_report(parsed.source, parsed.wall, tolerance=tolerance, **limits)
    if parsed.out:
        _save(_crack_pictures(*drawn, limits["threshold"]), parsed.out)
    print(json.dumps(figures, indent=2) if parsed.json else crack_report.describe(figures))


def _add_fragility(commands):
    command = _add_command(commands, "fragility", _fragility,
                           "probabilities of exceeding levels of damage, from a study with scattered strengths")
    command.add_argument("study", type=Path, metavar="STUDY_DIR", help="folder of a study, as results/fragility")
    command.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for table and pictures")
    command.add_argument("--intensity", default="pga_g", help="column of summary.csv: pga_g (default) or sa_0.2_s_g")
    command.add_argument("--replicates", type=int, default=500, metavar="N", help="bootstrap samples (default 500)")


def _fragility(parsed):
    from damage.measure.tables import write_table
    from damage.studies.fragility import INTENSITIES, fit_all, fragility_table, load_runs
    from damage.studies.fragility_picture import fragility_picture

    if parsed.intensity not in INTENSITIES:
        raise InputError(f"--intensity {parsed.intensity}: expected {' or '.join(INTENSITIES)}; mend it")
    if parsed.replicates < 0:
        raise InputError(f"--replicates {parsed.replicates}: expected zero or more; mend it")
    runs = load_runs(parsed.study)
    fits = fit_all(runs, parsed.intensity, parsed.replicates)
    table = fragility_table(fits, parsed.intensity)
    print(table.to_string(index=False, float_format="%.3f"))
    print(write_table(table, parsed.out / f"fragility_{parsed.intensity}.csv"))
    _save([(f"fragility_{wall}_{parsed.intensity}", fragility_picture(wall, runs[runs["wall"] == wall], ones,
                                                                      parsed.intensity))
           for wall, ones in fits.items()], parsed.out)


def _only_with(parsed, what, needs=(), without=()):
    """Refuse options that do not belong to `what`, and a missing one that does."""
    for name in needs:
        if getattr(parsed, name) is None:
            raise InputError(f"{what} needs --{name}; give it, as in --wall walls/solid.py")
    for name in without:
        if getattr(parsed, name) is not None:
            raise InputError(f"--{name.replace('_', '-')} does not belong to {what}; leave it out")


def _crack_pictures(mapped, patterns, layout, threshold):
    from damage.laboratory.crack_picture import crack_picture

    for pattern, cracks in zip(patterns, mapped):
        yield f"cracks_level_{pattern.level:g}", crack_picture(pattern, cracks, layout, threshold)


if __name__ == "__main__":
    sys.exit(main())
