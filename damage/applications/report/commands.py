"""Commands that report a run, or write it for other programs; the first run with its report."""

from pathlib import Path

from damage.arguments import arg, file_arg, flag, group, number_from
from damage.commands.table import HISTORY, command, out, output
from damage.history.reader import read_history


@command(
    "a first run, in half a minute: the façade that ships under a harmonic motion, with pictures"
    " and a report",
    file_arg("--out", "DIR", "where everything goes (default demo)", default=Path("demo")),
    flag("--overwrite", "replace what a demo before has left there"),
    examples=("", "--out first --overwrite"),
)
def _demo(asked):
    from damage.applications.report.report import write_report
    from damage.reference.session import run_reference

    history = asked.out / "symmetric.h5"
    words = ["symmetric", "--harmonic", "0.2", "0.05", "--rest", "1", "--out"]
    status = run_reference([*words, str(history), *["--overwrite"] * asked.overwrite])
    if status:
        return status
    print(f"report: {write_report([history])}")
    print("next: python3 -m damage new-wall my_wall.toml, and its first lines say how to run it")
    return 0


@command(
    "the moving wall and its cracks as GIF or WebP, as MP4 where ffmpeg is there",
    HISTORY,
    out(
        "the film (default: beside the history, .gif)",
        "FILE.gif|FILE.webp|FILE.mp4",
        required=False,
    ),
    arg(
        "--window",
        "part of the run (default: all of it, or of a long one what is around its maximum DI)",
        ("T0_S", "T1_S"),
        float,
        nargs=2,
    ),
    arg(
        "--magnify",
        "on displacements (default: what makes them visible)",
        "FACTOR",
        number_from(0, 1e6),
    ),
    examples=("run.h5", "run.h5 --window 1 2 --magnify 200 --out run.mp4"),
)
def _animate(asked):
    from damage.applications.report.animation import write_film

    print(
        write_film(
            read_history(asked.history),
            asked.out or asked.history.with_suffix(".gif"),
            asked.window,
            asked.magnify,
        )
    )


@command(
    "a history for ParaView",
    HISTORY,
    output(
        file_arg(
            "--vtkhdf",
            "FILE.vtkhdf",
            "one file with all samples, for ParaView 5.12 or newer",
            required=True,
        )
    ),
    examples=("run.h5 --vtkhdf run.vtkhdf", "house.h5 --vtkhdf house.vtkhdf"),
)
def _export(asked):
    from damage.applications.report.vtkhdf import write_vtkhdf

    print(write_vtkhdf(read_history(asked.history), asked.vtkhdf))


@command(
    "one HTML file to send: a run, runs side by side, or a study, for any browser, without a"
    " network",
    file_arg(
        "paths", "PATH", "a history (.h5), up to six of them, or the folder of studies", nargs="+"
    ),
    out(
        "the file (default: beside the first PATH, of its name, or report.html in a folder)",
        "FILE.html",
        required=False,
    ),
    group(
        "words",
        arg("--title", "of the report (default: what ran)", "WORDS"),
        arg("--author", "who wrote it, below the title", "NAME"),
        arg(
            "--text",
            "what it begins with, as what was asked and what follows; blank "
            "lines separate paragraphs",
            "WORDS",
        ),
        arg(
            "--language",
            "of each run's summary (default en); the technical part is English",
            choices=("en", "nl"),
            default="en",
        ),
    ),
    examples=("run.h5", 'results/quick --title "Quick study" --author "A. Name" --out report.html'),
)
def _report(asked):
    from damage.applications.report.report import Heading, write_report

    print(
        write_report(
            asked.paths, asked.out, Heading(asked.title, asked.author, asked.text, asked.language)
        )
    )
