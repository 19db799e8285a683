"""Commands about histories, and the tests and cracks that they are compared with."""

from damage.arguments import arg, group
from damage.commands.table import (
    DAMAGE,
    DRIFT_LIMIT,
    HISTORIES,
    HISTORY,
    JSON,
    PSI_FROM,
    STYLE,
    all_tables,
    command,
    out,
    save,
    show,
    threshold,
)
from damage.errors import InputError
from damage.history.info import DAMAGED, WHOLE, check, describe_check, info, origin
from damage.history.info import describe as describe_info
from damage.history.reader import read_history
from damage.index import SLIP_CRITERIA
from damage.units import MILLIMETRE


@command(
    "the damage index and key numbers of a history",
    HISTORY,
    JSON,
    threshold("opening and slip"),
    DRIFT_LIMIT,
    group(
        DAMAGE,
        arg(
            "--slip",
            "when a joint counts as slipped (default displacement)",
            choices=SLIP_CRITERIA,
            default="displacement",
        ),
    ),
    PSI_FROM,
    examples=("run.h5", "run.h5 --threshold-mm 0.05 --slip accumulated --json"),
)
def _index(asked):
    from damage.run.report import describe, summary_of

    summary = summary_of(
        read_history(asked.history),
        asked.threshold_mm * MILLIMETRE,
        asked.drift_limit_pct / 100,
        asked.slip,
        asked.psi_from_mm * MILLIMETRE,
    )
    show(asked, summary, describe)


@command(
    "whether histories are complete, ended early, still open or damaged; exit status 2 where one is"
    " damaged, 1 where one has no end",
    HISTORIES,
    JSON,
    examples=("run.h5", "results/quick/runs/*.h5"),
)
def _check(asked):
    checked = [check(path) for path in asked.histories]
    show(asked, checked, describe_check)
    worths = {file["worth"] for file in checked}
    return 2 if DAMAGED in worths else int(not worths <= {WHOLE})


@command(
    "what made a history: software, command, inputs, every parameter",
    HISTORY,
    JSON,
    examples=("run.h5", "run.h5 --json"),
)
def _info(asked):
    show(asked, info(read_history(asked.history)), describe_info)


@command(
    "the pictures of a history, PNG and PDF",
    HISTORY,
    out("folder for the pictures"),
    STYLE,
    examples=("run.h5 --out pictures", "results/quick/runs/run.h5 --out figures --style paper"),
)
def _plot(asked):
    from damage.draw.house import save_all

    print(*save_all(read_history(asked.history), asked.out), sep="\n")


@command(
    "stresses of the joints of a run with --stresses: at moments, thrust in piers and arches",
    HISTORY,
    JSON,
    arg(
        "--at",
        "rest, max, end, times [s] (default rest,max,end)",
        "MOMENT,...",
        default="rest,max,end",
    ),
    out("folder for tables and pictures", required=False),
    STYLE,
    examples=("run.h5", "run.h5 --at rest,1.25 --out stresses"),
)
def _stresses(asked):
    from damage.measure.joint_stress import describe, stress_report

    history = read_history(asked.history)
    moments = list(dict.fromkeys(asked.at.split(",")))
    report = stress_report(history, moments)
    if asked.out:
        from damage.draw.run import contact_force_picture
        from damage.measure.tables import write_stresses

        write_stresses(history, asked.out, moments)
        save(
            [
                (f"contact_forces_{moment}", contact_force_picture(history, moment))
                for moment in moments
            ],
            asked.out,
            origin(history),
        )
    show(asked, report, describe)


@command(
    "tables of histories as CSV: of one run over time, or one row per run",
    arg("what", choices=("run", "summary")),
    HISTORIES,
    out("STEM of STEM_index.csv and so on, or the summary's file", "STEM|FILE.csv"),
    examples=("run run.h5 --out run", "summary first.h5 second.h5 --out summary.csv"),
)
def _tables(asked):
    from damage.measure.tables import summary_table, write_run_tables, write_table

    if asked.what == "summary":
        write_table(summary_table(asked.histories), asked.out)
        return
    if len(asked.histories) > 1:
        raise InputError(
            f"tables run of {len(asked.histories)} histories: expected one, as all would have the"
            " names of --out; give each its own command, or tables summary"
        )
    write_run_tables(read_history(asked.histories[0]), asked.out)


@command(
    "the data dictionary: every column of every table, as dictionary.csv",
    out("folder for it"),
    examples=("--out tables", "--out docs/reference"),
)
def _dictionary(asked):
    from damage.measure.dictionary import write_dictionary

    print(write_dictionary(all_tables(), asked.out))
