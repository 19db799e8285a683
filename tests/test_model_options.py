"""The default model stands once, in ModelOptions: command lines, names and tables follow from its fields."""


import pandas as pd
import pytest

from damage.measure.columns import read_table
from damage.measure.tables import write_table
from damage.motion.loading import Harmonic
from damage.run.options import free_name, parse_run
from damage.run.settings import RunSettings
from damage.wall.model_options import USUAL_MODEL, ModelOptions
from damage.wall.parameters import Wall
from paper.evidence import SHAPE
from paper.study_figures import choice


@pytest.mark.parametrize(("options", "name"), [
    ({}, "w_harmonic_0.2s_0.05g_yade.h5"),
    ({"lintel": "none", "contacts": "corners"}, "w_harmonic_0.2s_0.05g_yade_lintel-none_corners.h5"),
    ({"lintel": 2, "load": "piers"}, "w_harmonic_0.2s_0.05g_yade_lintel-2_load-piers.h5"),
    ({"top": "beam", "strength_cov": 0.3}, "w_harmonic_0.2s_0.05g_yade_top-beam_strength-0.3-0.h5"),
])
def test_a_free_name_tells_what_is_not_the_default(tmp_path, options, name):
    settings = RunSettings(Harmonic(0.2, 0.05), ModelOptions(**options))
    assert free_name(Wall("w", 1.0, 1.0), settings, "yade", tmp_path) == tmp_path / name
    (tmp_path / name.removesuffix(".h5")).mkdir()  # pictures, whose history is gone
    assert free_name(Wall("w", 1.0, 1.0), settings, "yade", tmp_path).name == name.replace(".h5", "_2.h5")


def test_figures_and_evidence_know_every_choice():
    assert {"cells", "contacts", "top", "load", "joints", "strength_cov", "fibres", "bricks", "brick_order", "plane",
            "brick_mass", "brick_damping", "brick_cells",
            "supports", "soil", "soil_shear", "footing", "soil_velocity"} == USUAL_MODEL.keys() & SHAPE.keys()
    assert choice({**USUAL_MODEL, "cycles": 3}) == "default"
    assert choice({**USUAL_MODEL, "strength_cov": 0.3}) == "strength_cov 0.3"


@pytest.mark.parametrize(("given", "kept"), [("elastic", "elastic"), ("none", "none"), (0, "none"), ("0", "none"),
                                            (2, "2"), ("2", "2"), ("02", "2"), ("concrete", "concrete")])
def test_a_lintel_is_a_word_wherever_it_stands(tmp_path, given, kept):
    assert ModelOptions(lintel=given).lintel == kept
    assert parse_run(["--lintel", str(given)], "test", "yade").model.lintel == kept
    write_table(pd.DataFrame({"lintel": [kept]}), tmp_path / "points.csv")
    assert list(read_table(tmp_path / "points.csv")["lintel"]) == [kept]
    assert choice({**USUAL_MODEL, "lintel": kept}) == ("default" if kept == "elastic" else f"lintel: {kept}")
