"""Commands about cracks and laboratories: pushed walls, digitised cracks, surveys beside runs."""

from damage.arguments import WALLS_ARE_CODE, arg, file_arg, group, number_from
from damage.commands.table import (
    DRIFT_LIMIT,
    JSON,
    PSI_FROM,
    STYLE,
    command,
    out,
    output,
    save,
    show,
    tables,
    threshold,
)
from damage.errors import InputError
from damage.history.info import origin
from damage.history.reader import read_history
from damage.provenance import MEASURES, MODEL, shown_path
from damage.units import MILLIMETRE
from damage.wall.layout import lay_out


def _csv_and_others(paths):
    """The CSV files of paths, and the others, which are histories."""
    csv = [path for path in paths if path.suffix.lower() == ".csv"]
    return csv, [path for path in paths if path not in csv]


@command(
    "cycles, envelope, failure mode and figures of a pushed wall; of several draws of its strengths"
    " median and quantiles; of a test its loops",
    file_arg(
        "files", "FILE", "histories (.h5); loops of a test (.csv), with a run or alone", nargs="+"
    ),
    JSON,
    arg(
        "--to",
        "drift to which the force is averaged "
        "(default: ultimate drift of the test that the wall models, else of the run)",
        "DRIFT_PCT",
        number_from(1e-4, 100),
    ),
    examples=("pushed.h5", "pushed.h5 test.csv --json"),
)
def _cycles(asked):
    from damage.applications.cracks import pushed
    from damage.applications.cracks.loops import read_loops

    tests, runs = _csv_and_others(asked.files)
    to = asked.to and asked.to / 100
    if tests and len(runs) > 1:
        raise InputError(
            f"cycles with {tests[0]}: expected one history beside it, got {len(runs)}; leave out"
            " the others"
        )
    loops = [loop for path in tests for loop in read_loops(path)]
    histories = map(read_history, runs)
    if not runs:
        show(asked, loops, pushed.describe_loops)
    elif len(runs) == 1:
        show(asked, pushed.pushed_report(*histories, to, loops), pushed.describe)
    else:
        show(asked, pushed.draws_report(list(histories), to), pushed.describe_draws)


@command(
    "joint stiffnesses, cohesion and friction from tests of couplets and triplets",
    file_arg("tests", "TEST.csv|RUN.h5", "rows of tests, or pushed walls of one course", nargs="+"),
    JSON,
    output(file_arg("--csv", "FILE.csv", "the rows of all of them, as one file of tests")),
    examples=("triplets.csv couplets.csv", "triplet_*.h5 --csv tests.csv"),
)
def _calibrate(asked):
    from damage.applications.cracks import calibrate
    from damage.applications.cracks.calibrate import read_tests, rows_of

    rows = calibrate.joined(
        [
            rows_of(read_history(path)) if path.suffix == ".h5" else read_tests(path)
            for path in asked.tests
        ]
    )
    if asked.csv:
        rows.to_csv(asked.csv, index=False)
    show(asked, calibrate.calibrated(rows), calibrate.describe)


@command(
    "cracks, Psi and index of a history, of digitised cracks or of a DIC field",
    file_arg("source", "FILE", "a history (.h5) or a crack file (CSV)", nargs="?"),
    group("a history", arg("--at", "max, end, times [s] (default max,end)", "MOMENT,...")),
    group(
        "a crack file or a DIC field",
        file_arg("--dic", "FIELD.csv", "instead of FILE: a DIC displacement field"),
        file_arg(
            "--wall", "walls/NAME.py", f"the wall of a crack file or a field. {WALLS_ARE_CODE}"
        ),
        arg(
            "--tolerance-mm",
            "of a crack file: how far from "
            "a joint a crack may be drawn (default: half a brick's height)",
            "MM",
            number_from(1e-3, 1000),
        ),
        arg(
            "--margin-mm",
            "of a field: how far inside a brick's edges points count (default 10)",
            "MM",
            number_from(0, 1000),
        ),
    ),
    threshold("opening, slip and width"),
    PSI_FROM,
    DRIFT_LIMIT,
    output(
        file_arg(
            "--export", "CRACKS.csv", "write the cracks of a history or a field as a crack file"
        )
    ),
    out("folder for a picture of each load level, or moment", required=False),
    STYLE,
    JSON,
    examples=(
        "run.h5 --at max,end --export cracks.csv --out pictures",
        "cracks.csv --wall symmetric --tolerance-mm 20",
    ),
)
def _cracks(asked):
    from damage.applications.cracks.crack_report import crack_report, describe

    report, drawn = crack_report(asked)
    if asked.out:
        from damage.applications.cracks.crack_picture import crack_pictures

        save(
            crack_pictures(*drawn, asked.threshold_mm * MILLIMETRE),
            asked.out,
            f"cracks of {shown_path(asked.source or asked.dic)}",
        )
    show(asked, report, describe)


@command(
    "compare a history with another, an ensemble, or the survey of a real wall",
    file_arg("first", "A.h5"),
    file_arg(
        "others",
        "B.h5|SURVEY.csv",
        "of several histories the median counts; a crack file is compared with "
        "the end of each history",
        nargs="+",
    ),
    JSON,
    out("folder for a picture of drift and joints", required=False),
    STYLE,
    examples=("reference.h5 yade.h5", "yade.h5 member_1.h5 member_2.h5 member_3.h5 --out pictures"),
)
def _compare(asked):
    from damage.applications.cracks.compare import compare, describe

    surveys, runs = _csv_and_others([asked.first, *asked.others])
    if surveys:
        _compare_survey(asked, surveys, runs)
        return
    first = read_history(asked.first)
    others = [read_history(path) for path in asked.others]
    result = compare(first, others)
    if asked.out:
        from damage.applications.cracks.compare_picture import compare_picture

        save(
            [("compare", compare_picture(first, others[0]))],
            asked.out,
            "\n".join(map(origin, (first, others[0]))),
        )
    show(asked, result, describe)


def _compare_survey(asked, surveys, runs):
    from damage.applications.cracks.survey import beside, describe_beside, read_survey

    if len(surveys) > 1 or not runs or asked.out:
        raise InputError(
            f"compare with {surveys[0]}: expected one survey, histories beside it, and no --out; "
            "correct it"
        )
    comparisons = []
    for history in map(read_history, runs):
        history.check_one_layer()
        layout = lay_out(history.masonry_wall, history.model)
        if len(history.joints) != layout.n_joints:
            raise InputError(
                f"compare of {history.path} with a survey: expected a wall of all its bricks, those"
                " in toothed corners are of the other wall; give a wall by itself"
            )
        survey = read_survey(surveys[0], layout)
        opening = history.opening_m[-1]
        offset = history.offset_m[-1]
        comparisons.append({"run": str(history.path)} | beside(survey, opening, offset, layout))
    show(
        asked,
        comparisons,
        lambda comparisons: "\n".join(
            line
            for comparison in comparisons
            for line in (comparison["run"], *describe_beside(comparison))
        ),
    )


# of --cracked
MODEL += [f"applications/cracks/{name}.py" for name in ("crack_file", "crack_paths", "survey")]
MEASURES.append("applications/cracks/at_rest.py")  # patterns at rest


@tables
def _tables():
    from damage.applications.cracks import calibrate, crack_file
    from damage.applications.cracks.loops import LOOP, LOOP_FILE

    return {
        "crack files": crack_file.COLUMNS,
        "loops of a test": LOOP_FILE,
        "damage cycles": LOOP,
        "tests of joints": calibrate.COLUMNS,
    }
