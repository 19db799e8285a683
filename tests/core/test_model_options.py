"""The default model stands once, in ModelOptions: command lines, names and tables follow from its
fields."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from conftest import parsed, refused_with

from damage import Wall
from damage.applications.studies.read import read_table
from damage.measure.tables import write_table
from damage.motion.loading import Harmonic
from damage.run.options import parse_run, settings_of, words_of
from damage.run.paths import free_name
from damage.run.settings import RunSettings
from damage.wall.model_options import USUAL_MODEL, ModelOptions
from paper.study_figures import choice


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({}, "w_harmonic_0.2s_0.05g_yade.h5"),
        (
            {"lintel": "none", "contacts": "corners"},
            "w_harmonic_0.2s_0.05g_yade_lintel-none_corners.h5",
        ),
        ({"lintel": 2, "load": "piers"}, "w_harmonic_0.2s_0.05g_yade_lintel-2_load-piers.h5"),
        (
            {"top": "beam", "strength_cov": 0.3},
            "w_harmonic_0.2s_0.05g_yade_top-beam_strength-0.3-0.h5",
        ),
    ],
)
def test_a_free_name_tells_what_is_not_the_default(tmp_path, options, name):
    settings = RunSettings(Harmonic(0.2, 0.05), ModelOptions(**options))
    assert free_name(Wall("w", 1.0, 1.0), settings, "yade", tmp_path) == tmp_path / name
    (tmp_path / name.removesuffix(".h5")).mkdir()  # pictures, whose history is gone
    assert free_name(Wall("w", 1.0, 1.0), settings, "yade", tmp_path).name == name.replace(
        ".h5", "_2.h5"
    )


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("elastic", "elastic"),
        ("none", "none"),
        (0, "none"),
        ("0", "none"),
        (2, "2"),
        ("2", "2"),
        ("02", "2"),
        ("concrete", "concrete"),
    ],
)
def test_a_lintel_is_a_word_wherever_it_stands(tmp_path, given, kept):
    assert ModelOptions(lintel=given).lintel == kept
    assert parsed(f"--lintel {given}", "yade").model.lintel == kept
    write_table(pd.DataFrame({"lintel": [kept]}), tmp_path / "points.csv")
    assert list(read_table(tmp_path / "points.csv")["lintel"]) == [kept]
    assert choice({**USUAL_MODEL, "lintel": kept}) == (
        "default" if kept == "elastic" else f"lintel: {kept}"
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            {"harmonic": (0.2, 0.05), "cycles": 2, "rest": np.float64(1)},
            "--harmonic 0.2 0.05 --cycles 2 --rest 1.0",
        ),
        ({"harmonic": [1, "0.05"], "sequence": (1, 0.5)}, "--harmonic 1 0.05 --sequence 1.0,0.5"),
        (
            {"cyclic": "0.1,0.2", "top-rotation": 0, "stresses": True, "pictures": False},
            "--cyclic 0.1,0.2 --top-rotation 0 --stresses --no-pictures",
        ),
        (
            {
                "settle": "tilt",
                "distortion": "1/200",
                "beta": None,
                "quiet": False,
            },
            "--settle tilt --distortion 0.005",
        ),
    ],
)
def test_a_command_line_is_one_way_to_give_options(options, words):
    given = settings_of(options, "", "reference")
    assert replace(given, command="") == replace(parsed(words), command="")
    assert parse_run(words_of(options), "", "reference") == given


@pytest.mark.parametrize(
    ("options", "words", "said"),
    [
        ({"harmonic": 0.2}, "--harmonic 0.2", "argument --harmonic: expected 2 arguments"),
        ({"rest": "x"}, "--rest x", "argument --rest: invalid float value: 'x'"),
        ({"cycles": "2.5"}, "--cycles 2.5", "argument --cycles: invalid int value: '2.5'"),
        ({"top": "flat"}, "--top flat", "argument --top: invalid choice: 'flat'"),
        (
            {"cyclic": "1,x"},
            "--cyclic 1,x",
            "argument --cyclic: 1,x: expected numbers with commas between",
        ),
        ({"scale": 2}, "--scale 2", "--scale belongs to --record"),
    ],
)
def test_a_wrong_option_is_refused_alike_however_it_is_given(options, words, said):
    refused_with(said, settings_of, options, "", "reference")
    refused_with(said, parsed, words)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"cycles": 2.5}, "argument --cycles: invalid int value: '2.5'"),
        ({"rest": True}, "invalid float value: 'True'"),
        ({"quiet": 1}, "quiet = 1: expected True or False"),
        ({"harmonc": 1}, "did you mean harmonic"),
    ],
)
def test_a_value_that_no_command_line_can_have_is_refused(options, said):
    refused_with(said, settings_of, options, "", "reference")
