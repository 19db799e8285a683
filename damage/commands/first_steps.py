"""Commands of the first steps: a demonstration, a wall file to change."""

from pathlib import Path

from damage.commands.table import arg, command, file_arg
from damage.start import missing_library


@command("a first run, in half a minute: the façade that ships under a harmonic motion, with pictures and a report",
         file_arg("--out", "DIR", "where everything goes (default demo)", default=Path("demo")),
         arg("--overwrite", action="store_true", help="replace what a demo before has left there"))
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


@command("write a wall file to change: a copy of a wall that ships, under the name of the file; FILE.toml is data and "
         "never executed",
         file_arg("file", "FILE.py|FILE.toml"),
         arg("--from", dest="source", metavar="NAME", default="symmetric", help="the wall that is copied (default "
              "symmetric); an unknown one lists all"))
def _new_wall(asked):
    from damage.wall.new import new_wall

    path = new_wall(asked.file, asked.source)
    print(f"{path}: change its numbers, then: python3 -m damage reference {path} --harmonic 0.2 0.05")
