"""The JSON Schema of study files: it is that of the definition, right studies pass it and wrong
ones do not."""

import json
import tomllib

import pytest
from conftest import REPOSITORY, refused_with, written

from damage.applications.studies.definition import load_study
from damage.applications.studies.schema import study_schema

jsonschema = pytest.importorskip("jsonschema")
SHIPPED = sorted((REPOSITORY / "studies").glob("*.toml"))
NAME, WALL = 'name = "n"\n', 'wall = "walls/solid.py"\n'
RUN = NAME + "[[runs]]\n" + WALL


@pytest.fixture(scope="module")
def validator():
    jsonschema.Draft7Validator.check_schema(study_schema())
    return jsonschema.Draft7Validator(study_schema())


def test_the_shipped_schema_is_the_generated_one():
    """python3 -m damage study-schema > studies/study.schema.json."""
    assert json.loads((REPOSITORY / "studies/study.schema.json").read_text()) == study_schema()


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_shipped_study_passes_and_names_it(validator, path):
    text = path.read_text()
    assert text.startswith("#:schema ./study.schema.json\n")
    validator.validate(tomllib.loads(text))


@pytest.mark.parametrize(
    "text",
    [
        RUN,
        RUN + 'options = ["--harmonic", 0.2, "0.05"]\n',
        RUN + 'options = { lintel = 2, harmonic = ["0.2", 0.05] }\n',
        RUN + "members = 3\nscatter = 0.01\n",
        RUN + 'id = "a-1"\nsolvers = ["yade"]\n',
        NAME + "[[grid]]\n" + WALL + 'members = "{m}"\noptions = { rest = "{r}" }\n'
        "vary = { m = [2], r = { from = 1, to = 2 } }\n",
        RUN
        + 'options = { record = ["a.csv", "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"],'
        " free-vibration = false }\n",
    ],
)
def test_what_the_software_takes_passes(validator, tmp_path, text):
    validator.validate(tomllib.loads(text))
    assert load_study(written(tmp_path / "s.toml", text), "both", REPOSITORY).of_both


@pytest.mark.parametrize(
    "text",
    [
        NAME,
        RUN.removeprefix(NAME),
        RUN.replace('"n"', '"a/b"'),
        RUN + 'what = "ever"\n',
        "why = 1\n" + RUN,
        NAME + "[[runs]]\nmembers = 3\n",
        NAME + 'pictures = "some"\n' + RUN.removeprefix(NAME),
        RUN + 'solvers = ["udec"]\n',
        RUN + "options = { harmonics = [0.2, 0.05] }\n",
        RUN + "options = { harmonic = [0.2] }\n",
        RUN + 'options = { harmonic = ["a", "b"] }\n',
        RUN + 'options = { top = "arch" }\n',
        RUN + 'options = { out = "a.h5" }\n',
        RUN + "options = { cells = 1.5 }\n",
        RUN + "members = 0\n",
        RUN + "members = 3\nsamples = 3\n",
        RUN + "scatter = 0.01\n",
        NAME + "[[grid]]\n" + WALL,
        NAME + "[[grid]]\n" + WALL + "vary = { r = [] }\n",
    ],
)
def test_what_the_software_refuses_fails(validator, tmp_path, text):
    assert not validator.is_valid(tomllib.loads(text))
    refused_with("", load_study, written(tmp_path / "s.toml", text), "both", REPOSITORY)
