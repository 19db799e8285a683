"""Import directions as ARCHITECTURE.md gives them, read from the source: folder order is import
order."""

import ast
import sys
from graphlib import CycleError, TopologicalSorter

import pytest
from conftest import REPOSITORY, run_command

# Rooms in the order of import: a room may import from those before it, not from one in its own line
# or after.
ROOMS = [
    (
        "damage.arguments",
        "damage.errors",
        "damage.units",
        "damage.files",
        "damage.checks",
        "damage.csv_table",
        "damage.draws",
        "damage.eigen",
        "damage.elementary",
        "damage.fields",
        "damage.memory",
        "damage.provenance",
        "damage.retired",
        "damage.rounded",
        "damage.start",
        "damage.toml_file",
        "damage.version",
    ),
    ("damage.index", "damage.wall", "damage.motion"),
    ("damage.house",),
    ("damage.linear",),
    ("damage.law",),
    ("damage.history",),
    ("damage.measure", "damage.mechanics"),
    ("damage.draw",),
    ("damage.run",),
    ("damage.reference",),
    ("damage.commands",),
    ("damage.applications.cracks",),
    ("damage.applications.studies",),
    ("damage.applications.report",),
    ("damage.applications.groningen",),
    ("damage.applications",),
    ("damage",),  # its __init__ and __main__
    ("yade_scripts",),
    ("walls",),
    ("verification",),
    ("paper",),
    ("scripts", "docs"),
    ("benchmarks", "examples"),
    ("tests",),
]
GROUND = ROOMS[0]  # small modules: they may import one another
CALLED = {("damage.run", "damage.reference.python"), ("damage.run", "damage.applications")}
"""Imports against the order: `damage.run` is also the function that users call, which runs the
reference solver with the options that applications add."""
RANK = {room: rank for rank, line in enumerate(ROOMS) for room in line}


def room_of(module):
    """The longest room that a dotted module lies in, or None."""
    parts = module.split(".")
    rooms = (".".join(parts[:n]) for n in range(len(parts), 0, -1))
    return next((room for room in rooms if room in RANK), None)


def read_modules():
    """{dotted module: dotted modules of this repository that it imports, anywhere in it, but for
    CALLED}."""
    paths = {
        path.relative_to(REPOSITORY)
        for top in {room.partition(".")[0] for room in RANK}
        for path in (REPOSITORY / top).rglob("*.py")
    }
    names = {".".join(path.with_suffix("").parts).removesuffix(".__init__"): path for path in paths}
    # Scripts of one folder import each other by their bare names.
    bare = {name.rpartition(".")[2]: name for name in names if name.startswith("tests.")}
    return {
        name: {one for one in _imports(name, names, bare) if (name, one) not in CALLED}
        for name in names
    }


def _source(name):
    path = REPOSITORY / name.replace(".", "/")
    return (path / "__init__.py" if path.is_dir() else path.with_suffix(".py")).read_text()


def _imports(module, known, bare):
    """Modules of this repository that a module imports, in its functions and by `import_module` of
    a constant, too."""
    for node in ast.walk(ast.parse(_source(module))):
        if isinstance(node, ast.Import):
            found = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: relative import; give the whole name"
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            found = [name if name in known else node.module for name in inner]
        elif (
            isinstance(node, ast.Call)
            and getattr(node.func, "attr", getattr(node.func, "id", "")) == "import_module"
        ):
            found = [one.value for one in node.args if isinstance(one, ast.Constant)]
        else:
            continue
        for name in found:
            if (name := bare.get(name, name)) in known:
                yield name


def faults(modules):
    """What breaks the order of ROOMS, or goes in a circle: a list of str."""
    found = [
        f"{name} is in no room: give its folder a place in ROOMS"
        for name in modules
        if not room_of(name)
    ]
    for name, imported in sorted(modules.items()):
        here = room_of(name)
        for other in sorted(imported):
            there = room_of(other)
            if (
                here != there
                and RANK[there] >= RANK[here]
                and not (here in GROUND and there in GROUND)
            ):
                found.append(f"{name} imports {other}, which comes after it")
    try:
        TopologicalSorter(modules).prepare()
    except CycleError as error:
        found.append("a circle: " + " -> ".join(error.args[1]))
    return found


def test_imports_follow_the_order_of_rooms_and_no_circle():
    assert faults(read_modules()) == []


def test_every_folder_with_python_has_its_room():
    done = run_command("git", "ls-files", "-co", "--exclude-standard", "*.py", check=True)
    folders = {line.split("/")[0] for line in done.stdout.split() if "/" in line}
    assert folders == {room.partition(".")[0] for room in RANK}


def test_damage_imports_without_yade():
    """In an interpreter where importing yade fails."""
    code = (
        "import sys; sys.modules['yade'] = None\n"
        "import damage, pkgutil, importlib\n"
        "for module in pkgutil.walk_packages(damage.__path__, 'damage.'):\n"
        "    module.name == 'damage.__main__' or importlib.import_module(module.name)\n"
    )
    run_command(sys.executable, "-c", code, status=0)


@pytest.mark.parametrize(
    "path", sorted((REPOSITORY / "walls").glob("*.py")), ids=lambda path: path.stem
)
def test_walls_are_thin(path):
    tree = ast.parse(path.read_text())
    imported = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert imported <= {"pathlib", "damage", "yade_scripts.run"}
    assert len(path.read_text().splitlines()) < 50
