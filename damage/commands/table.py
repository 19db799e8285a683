"""The table of commands, their groups and examples in the help, and what they share: arguments, how they print."""

import io
import sys

from damage.errors import one_line
from damage.files import json_text
from damage.run.options import WALLS_ARE_CODE, arg, file_arg, flag, group, number_from

COMMANDS = {}
"""Name -> (function of the parsed options, what it is for, functions that add an argument to its parser)."""


class Silence(io.StringIO):
    """A stream that discards its output."""


def command(purpose, *arguments, table=COMMANDS):
    """Make a function the command of its name, in this table."""
    def keep(function):
        table[function.__name__.strip("_").replace("_", "-")] = function, purpose, arguments
        return function
    return keep


def output(*arguments):
    """A function that adds these arguments to the group of what a command writes."""
    return group("output", *arguments)


def out(help_, metavar="DIR", required=True):
    """The option --out."""
    return output(file_arg("--out", metavar, help_, required=required))


WALL = file_arg("wall", "WALL", f"a wall file, or the name of a wall that ships. {WALLS_ARE_CODE}")
HISTORY = file_arg("history", "FILE.h5")
HISTORIES = file_arg("histories", "FILE.h5", nargs="+")
JSON = output(flag("--json", "as JSON"))
DAMAGE = "what counts as damage"
DRIFT_LIMIT = group(DAMAGE, arg("--drift-limit-pct", type=number_from(1e-6, 100), default=2.0, metavar="PCT",
                                help="drift limit (default 2)"))


def threshold(of):
    """The option --threshold-mm; of: what exceeds it."""
    return group(DAMAGE, arg("--threshold-mm", type=number_from(1e-6, 1000), default=0.1, metavar="MM",
                             help=f"of {of} (default 0.1)"))


PSI_FROM = group(DAMAGE, arg("--psi-from-mm", type=number_from(1e-6, 1000), default=0.02, metavar="MM",
                             help="width from which a crack counts in Psi (default 0.02; 0.1 is what an eye sees)"))


def show(asked, found, describe):
    """Print what a command found, as JSON where that was asked for; describe(found): text."""
    print(json_text(found, indent=2) if asked.json else "\n".join(map(one_line, describe(found).split("\n"))))


def save(figures, folder, made=""):
    """Write figures, pairs (name, Figure), with the command that made them; print their paths to stderr, because stdout
    may be JSON."""
    from damage.draw.style import save_figures

    for path in save_figures(figures, folder, made):
        if not isinstance(sys.stdout, Silence):
            print(f"picture: {path}", file=sys.stderr)


GROUPS = {
    "first steps": {
        "demo": ("", "--out first --overwrite"),
        "new-wall": ("my_wall.py", "my_wall.py --from solid"),
        "check-bits": ("", "harmonic softening", "--long"),
        "help": ()},
    "a wall": {
        "materials": ("", "--json > materials.json"),
        "draw": ("symmetric", "my_wall.toml --top beam --out my_wall.svg"),
        "modes": ("symmetric", "my_wall.toml --bricks deformable --out pictures"),
        "wall-schema": ("> wall.schema.json", "| less")},
    "ground motion": {
        "record": ("BGAR_HGE", "record.csv --window 17 27 --plot record.png"),
        "exposure": ("--at 53.36 6.75", "--rd 246000 597000 --vs30 180 --from 2012 --out exposure"),
        "catalogue": ("later.txt --out catalogue.csv", "newest.txt --catalogue catalogue.csv --out catalogue_2.csv")},
    "one run": {
        "reference": (),
        "index": ("run.h5", "run.h5 --threshold-mm 0.05 --slip accumulated --json"),
        "check": ("run.h5", "results/quick/runs/*.h5"),
        "info": ("run.h5", "run.h5 --json"),
        "plot": ("run.h5 --out pictures", "results/quick/runs/run.h5 --out pictures/run"),
        "stresses": ("run.h5 --joint 0.5,0.3", "run.h5 --at rest,1.25 --joint bed:0.1,0 --out stresses"),
        "animate": ("run.h5", "run.h5 --window 1 2 --magnify 200 --out run.mp4"),
        "report": ("run.h5", 'results/quick --title "Quick study" --author "A. Name" --out report.html'),
        "tables": ("run run.h5 --out run", "summary first.h5 second.h5 --out summary.csv"),
        "compare": ("reference.h5 yade.h5", "yade.h5 member_1.h5 member_2.h5 member_3.h5 --out pictures"),
        "export": ("run.h5 --vtkhdf run.vtkhdf", "symmetric --contacts corners --opensees symmetric.py"),
        "cracks": ("run.h5 --at max,end --export cracks.csv --out pictures",
                   "cracks.csv --wall symmetric --tolerance-mm 20"),
        "cycles": ("pushed.h5", "pushed.h5 --json"),
        "laboratory": ("squat.h5 --out pictures", "comp2_1.h5 comp2_3.h5 --out pictures")},
    "many runs": {
        "study": (),
        "study-tables": ("studies/quick.toml results/quick", "my_study.toml results/my_study --solver reference -j 4"),
        "study-schema": ("> study.schema.json", "| less"),
        "fragility": ("results/fragility --out curves",
                      'results/fragility --intensity pga_g --state "moderate: max_psi > 2" --out curves'),
        "dictionary": ("--out tables", "--out docs/reference")},
    "lives at an address": {
        "life": ("symmetric --at 53.36 6.75 --out results/life",
                 "my_wall.toml --at 53.36 6.75 --settle hogging --distortion 1/3000 --out results/settled"),
        "lives": ("results/life", "results/life --markdown lives.md --out figures"),
        "claim": ("my_house.toml --at 53.36 6.75 --cracks survey.csv --out results/claim",
                  "my_house.toml --at 53.36 6.75 --cracks survey.csv --settle hogging --distortion 1/1500 "
                  "--language nl --out results/claim"),
        "app": ("--out results/claim", "--out results/claim --port 8765 --no-browser")}}
"""Title -> {command: its examples, what follows the command's name}, all in the order in which help lists them;
`reference` and `study` have examples of their own."""


def examples_of(name):
    """Lines of the examples of a command, for its help."""
    return [f"python3 -m damage {name} {line}".rstrip() for names in GROUPS.values() for line in names.get(name, ())]
