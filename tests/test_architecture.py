"""Import directions as ARCHITECTURE.md gives them, read from the source."""

import ast
import subprocess
import sys

import pytest
from conftest import REPOSITORY

# Layers of `damage`, lowest first: a module imports from its own layer's left or from lower ones.
LAYERS = [
    {"errors", "units", "paper_criteria"},
    {"parameters", "joint_law", "records", "csv_table"},
    {"layout", "loading", "intensity", "index"},
    {"study_grid"},
    {"synthetic", "modes", "kinematics", "wall_file", "options", "energy", "progress", "study", "watch"},
    {"history", "reference_kernel", "schedule"},
    {"reading", "reference"},
    {"summary", "pictures", "wall_picture", "tables", "cracks", "measures", "hysteresis", "reference_run"},
    {"crack_file", "crack_mapping"},
    {"dic", "crack_picture"},
    {"laboratory", "paper_evidence", "paper", "paper_report", "report", "crack_report", "compare", "modes_picture",
     "study_results"},
    {"compare_picture", "figure_parts", "study_tables", "fragility"},
    {"laboratory_pictures", "harmonic_figures", "ida_figures", "crack_maps", "fragility_picture",
     "sequence_figure"},
    {"study_figures"},
    {"session"},
    {"reference_session"},
    {"__main__", "__init__"},
]


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
    assert found, f"damage/{module}.py stands in no layer: give it a place in LAYERS and ARCHITECTURE.md"
    return found[0]


DAMAGE = sorted((REPOSITORY / "damage").glob("*.py"))


@pytest.mark.parametrize("path", DAMAGE, ids=lambda path: path.stem)
def test_damage_stands_alone_and_imports_downwards(path):
    for name in imported_modules(path):
        top, _, module = name.partition(".")
        assert top not in ("yade", "yade_scripts", "walls", "tests"), f"{path.name} imports {name}"
        if top == "damage" and module:
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
            "for module in pkgutil.iter_modules(damage.__path__):\n"
            "    module.name == '__main__' or importlib.import_module('damage.' + module.name)\n")
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
