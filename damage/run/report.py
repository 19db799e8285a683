"""Output of a finished run beside its history: a printed summary, tables and pictures."""

from shlex import quote

from damage.errors import InputError, one_line, warn
from damage.measure.cycles import shocks_table
from damage.measure.evidence import describe as describe_evidence
from damage.measure.house import describe as describe_together
from damage.measure.house import house_summary
from damage.measure.results import EVENTS, lines_of, table_of
from damage.measure.summary import summarise
from damage.measure.warnings import warnings_of
from damage.run.options import SUMMARY
from damage.run.paths import pictures_folder


def report(history, pictures=True):
    """Print the summary of a History; write its pictures beside it.

    The history is complete by then: whatever fails here is reported and loses nothing.
    """
    if len(history.series) == 0:
        warn(*warnings_of(history.parts[0]))
        print(f"{history.status}: no sample was written")
        return
    print(describe(summary_of(history)))
    if history.kind == "wall" and history.series["shock"].iloc[-1] > 1:
        print(*describe_events(shocks_table(history)), sep="\n")
    if pictures:
        _draw(history)
    print(
        f"history: {history.path}\nnext, one HTML file:\n"
        f"  python3 -m damage report {quote(str(history.path))}"
    )


def _draw(history):
    folder = pictures_folder(history.path)
    try:
        from damage.draw.house import save_all

        print(f"pictures: {len(save_all(history, folder))} files in {folder}")
    except Exception as error:
        warn(
            f"the history is whole, its pictures failed ({one_line(error)}); "
            f"try: python3 -m damage plot {history.path} --out {folder}"
        )


def summary_of(history, *limits):
    """Summary of a run, a plain dictionary with what applications add: of a house `house_summary`,
    else `summarise`, whose further arguments limits are; prints its warnings."""
    walls = {}
    for part in history.parts:
        added = {name: measure(part) for name, (measure, _) in SUMMARY.items()}
        known = {name: value for name, value in added.items() if value is not None}
        walls[part.wall] = summarise(part, *limits) | known
    warn(*dict.fromkeys(text for summary in walls.values() for text in summary["warnings"]))
    return house_summary(history, walls) if history.kind == "house" else walls[history.wall]


def check_pictures(path, overwrite=False):
    """Raise InputError where pictures of a new run with the history `path` would go among what is
    there already."""
    folder = pictures_folder(path)
    if not overwrite and folder.is_dir() and next(folder.iterdir(), None) is not None:
        raise InputError(
            f"{folder} is not empty, and the pictures of {path.name} would go there: give another"
            " --out, --no-pictures, or --overwrite to replace what has their names"
        )


def describe(summary):
    """The summary of a run as lines for people, of a house what all walls have together, then
    each."""
    if "walls" in summary:
        return "\n\n".join([describe_together(summary), *map(describe, summary["walls"].values())])
    collapsed = summary["collapsed_at_s"]
    lines = [
        f"{summary['wall']} / {summary['motion']} / {summary['solver']}: {summary['status']}"
        + ("" if collapsed is None else f", collapsed at {collapsed:.2f} s"),
        *lines_of(summary),
        describe_evidence(summary["evidence"]),
    ]
    for name, (_, more) in SUMMARY.items():
        lines += more(summary[name]) if name in summary else []
    return "\n".join(lines)


def describe_events(table):
    """The events of a `shocks_table` as lines for people."""
    rows = {f"{row['shock']}: {row['motion']}": row for row in table.to_dict("records")}
    return table_of(rows, EVENTS)
