"""Import directions as ARCHITECTURE.md gives them, read from the source."""

import ast
import subprocess
import sys

import pytest
from conftest import REPOSITORY

# Layers of the modules in `damage` itself, lowest first: one imports from its own layer or from lower ones.
LAYERS = [
    {"errors", "units"},
    {"parameters", "joint_law", "records"},
    {"layout", "loading", "intensity", "index"},
    {"synthetic", "modes", "kinematics", "wall_file", "options", "energy", "progress", "watch"},
    {"history", "schedule"},
    {"reading"},
    {"summary", "pictures", "wall_picture", "tables", "cracks", "measures", "hysteresis"},
    {"report", "compare", "modes_picture", "figure_parts"},
    {"compare_picture"},
    {"session"},
]
# Folders of `damage`: each stands on the modules above alone, and none on another.
FOLDERS = {"reference", "laboratory", "studies", "paper"}


def imported_modules(path):
    """Top-level names and dotted names that a file imports, anywhere in it."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names.add(node.module)
    return names


def layer_of(module):
    found = [number for number, layer in enumerate(LAYERS) if module in layer]
    assert found, f"damage/{module}.py stands in no layer: give it a place in LAYERS"
    return found[0]


DAMAGE = sorted(path for path in (REPOSITORY / "damage").rglob("*.py") if path.stem not in ("__main__", "__init__"))


@pytest.mark.parametrize("path", DAMAGE, ids=lambda path: f"{path.parent.name}.{path.stem}")
def test_damage_stands_alone_and_imports_downwards(path):
    folder = path.parent.name
    assert folder == "damage" or folder in FOLDERS, f"{path} is in no known folder"
    for name in imported_modules(path):
        top, _, module = name.partition(".")
        assert top not in ("yade", "yade_scripts", "walls", "tests"), f"{path.name} imports {name}"
        if top != "damage" or not module:
            continue
        if (other := module.partition(".")[0]) in FOLDERS:
            assert other == folder, f"{path.name} imports {name}, from another folder"
        elif folder == "damage":
            assert layer_of(module) <= layer_of(path.stem), f"{path.name} imports {name} from above"


@pytest.mark.parametrize("path", sorted((REPOSITORY / "walls").glob("*.py")), ids=lambda path: path.stem)
def test_walls_import_only_the_package_and_the_runner(path):
    allowed = {"sys", "pathlib", "math", "damage", "yade_scripts.run"}
    assert imported_modules(path) <= allowed
    assert len(path.read_text().splitlines()) < 50


def test_damage_imports_without_yade():
    """In an interpreter where importing yade fails."""
    code = ("import sys; sys.modules['yade'] = None\n"
            "import damage, pkgutil, importlib\n"
            "for module in pkgutil.walk_packages(damage.__path__, 'damage.'):\n"
            "    module.name == 'damage.__main__' or importlib.import_module(module.name)\n")
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
