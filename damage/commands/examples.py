"""What `python3 -m damage --help` lists, in which groups, and two examples of each command."""

GROUPS = {
    "first steps": ("demo", "new-wall", "help"),
    "a wall": ("materials", "draw", "modes", "wall-schema"),
    "ground motion": ("record", "exposure"),
    "one run": ("reference", "index", "check", "info", "plot", "animate", "report", "tables", "compare", "export",
                "cracks", "cycles", "laboratory"),
    "many runs": ("study", "study-tables", "study-schema", "fragility", "dictionary"),
    "lives at an address": ("life", "lives"),
}
"""Title -> names of commands, all in the order in which help lists them."""

EXAMPLES = {
    "demo": ("demo", "demo --out first --overwrite"),
    "new-wall": ("new-wall my_wall.py", "new-wall my_wall.py --from solid"),
    "materials": ("materials", "materials --json > materials.json"),
    "draw": ("draw symmetric", "draw my_wall.toml --top beam --out my_wall.svg"),
    "modes": ("modes symmetric", "modes my_wall.toml --bricks deformable --out pictures"),
    "wall-schema": ("wall-schema > wall.schema.json", "wall-schema | less"),
    "record": ("record BGAR_HGE", "record record.csv --window 17 27 --plot record.png"),
    "exposure": ("exposure --at 53.36 6.75", "exposure --rd 246000 597000 --vs30 180 --from 2012 --out exposure"),
    "index": ("index run.h5", "index run.h5 --threshold-mm 0.05 --slip accumulated --json"),
    "check": ("check run.h5", "check results/quick/runs/*.h5"),
    "info": ("info run.h5", "info run.h5 --json"),
    "plot": ("plot run.h5 --out pictures", "plot results/quick/runs/run.h5 --out pictures/run"),
    "animate": ("animate run.h5", "animate run.h5 --window 1 2 --magnify 200 --out run.mp4"),
    "report": ("report run.h5", 'report results/quick --title "Quick study" --author "A. Name" --out report.html'),
    "tables": ("tables run run.h5 --out run", "tables summary first.h5 second.h5 --out summary.csv"),
    "compare": ("compare reference.h5 yade.h5", "compare yade.h5 member_1.h5 member_2.h5 member_3.h5 --out pictures"),
    "export": ("export run.h5 --vtkhdf run.vtkhdf", "export results/quick --parquet tables"),
    "cracks": ("cracks run.h5 --at max,end --export cracks.csv --out pictures",
               "cracks cracks.csv --wall symmetric --tolerance-mm 20"),
    "cycles": ("cycles pushed.h5", "cycles pushed.h5 --json"),
    "laboratory": ("laboratory squat.h5 --out pictures", "laboratory comp2_1.h5 comp2_3.h5 --out pictures"),
    "study-tables": ("study-tables studies/quick.toml results/quick",
                     "study-tables my_study.toml results/my_study --solver reference -j 4"),
    "study-schema": ("study-schema > study.schema.json", "study-schema | less"),
    "fragility": ("fragility results/fragility --out curves",
                  'fragility results/fragility --intensity pga_g --state "moderate: max_psi > 2" --out curves'),
    "dictionary": ("dictionary --out tables", "dictionary --out docs/reference"),
    "life": ("life symmetric --at 53.36 6.75 --out results/life",
             "life my_wall.toml --at 53.36 6.75 --settle hogging --distortion 1/3000 --out results/settled"),
    "lives": ("lives results/life", "lives results/life --with other/lives.csv --markdown lives.md --out figures"),
}
"""Name of a command -> its examples, without what comes before it; `reference` and `study` have their own."""


def examples_of(name):
    """Lines of the examples of a command, for its help."""
    return [f"python3 -m damage {line}" for line in EXAMPLES.get(name, ())]
