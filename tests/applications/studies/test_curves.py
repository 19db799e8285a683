"""Fragility curves for other tools: what the files say gives back the probabilities; OpenQuake
reads them (long)."""

import json
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from environments import environment, run_in
from numpy.testing import assert_allclose
from scipy.stats import lognorm
from test_fragility import GRADES, MODERATE, SLIGHT, graded, made, walls

from damage.applications.studies.curves import (
    NAMESPACE,
    coefficients,
    limit_state,
    write_curves,
    write_nrml,
)
from damage.applications.studies.fragility import fit_all
from damage.measure.tables import write_table

OPENQUAKE = "openquake.engine==3.26.2"
OPENQUAKE_NEEDS = (
    "numpy",
    "scipy",
    "pandas",
    "h5py",
    "toml",
    "decorator",
    "shapely",
    "psutil",
    "numba",
    "h3",
    # what reading a fragility model imports, and no more
    "alpha_shapes",
    "pyzmq",
    "fiona",
)


MILD = made(0.02, 0.15, 0.3)
GRAVE = made(0.05, 0.3, 0.5)
STEP = made(0.1, 0.4, 0.0, step=(0.35, 0.45))
STATES = f"{{{NAMESPACE}}}limitStates"


def written(tmp_path, kind, fits=(MILD, GRAVE), **more):
    path = write_nrml("solid", list(fits), tmp_path / f"{kind}.xml", kind, **more)
    return path, ElementTree.parse(path).getroot()[0]


def test_a_continuous_model_has_moments_of_the_intensity_itself(tmp_path):
    """The lognormal distribution of that mean and standard deviation has our median and
    dispersion."""
    _, model = written(tmp_path, "continuous")
    assert model.find(STATES).text.split() == ["max_DI_over_0p02", "max_DI_over_0p05"]
    for one, node in zip((MILD, GRAVE), model[2][1:]):
        mean = float(node.get("mean"))
        deviation = float(node.get("stddev"))
        assert_allclose(lognorm.stats(one.dispersion, scale=one.median), (mean, deviation**2))


def test_a_discrete_model_interpolates_to_the_curves(tmp_path):
    _, model = written(tmp_path, "discrete")
    x = np.array(model[2][0].text.split(), float)
    assert np.all(np.diff(x) > 0)
    between = np.geomspace(x[0], x[-1], 500)
    for one, node in zip((MILD, GRAVE), model[2][1:]):
        poes = np.array(node.text.split(), float)
        assert_allclose(poes, one.probability(x), atol=1e-9)
        assert_allclose(np.interp(between, x, poes), one.probability(between), atol=5e-3)


@pytest.mark.parametrize("kind", ["continuous", "discrete"])
def test_below_the_first_level_there_is_no_damage(tmp_path, kind):
    """Without the limit 10 000 events of 0.001 g did as much damage as 10 000 of 0.04 g."""
    imls = written(tmp_path, kind)[1][2][0]
    first = imls.get("minIML") or imls.text.split()[0]
    # four dispersions of 0.5 below 0.3 g
    assert imls.get("noDamageLimit") == first == "0.040600585"


def test_a_step_is_a_line_between_its_bounds_and_no_lognormal_curve(tmp_path):
    _, model = written(tmp_path, "discrete", (MILD, STEP))
    x, poes = (np.array(model[2][k].text.split(), float) for k in (0, 2))
    assert_allclose(np.interp((0.35, 0.40, 0.45), x, poes), (0, 0.5, 1), atol=1e-6)
    _, model = written(tmp_path, "continuous", (MILD, STEP))
    assert model.find(STATES).text == "max_DI_over_0p02"
    assert write_nrml("solid", [STEP], tmp_path / "none.xml", "continuous") is None
    row = coefficients({"w": [STEP]}).iloc[0]
    assert row["distribution"] == "step" and np.isnan([row["median"], row["dispersion"]]).all()
    assert (row["step_low"], row["step_high"]) == (0.35, 0.45)


def test_coefficients_are_those_of_the_curves():
    fits = fit_all(walls(40, seed=4), "pga_g", replicates=0)
    table = coefficients(fits)
    assert set(table.loc[table.measure == "max_crack_width_mm", "level_unit"]) == {"mm"}
    row = table[(table.measure == "max_DI") & (table.level == 0.05)].iloc[0]
    x = np.array([0.1, 0.2])
    (fit,) = (one for one in fits["w"] if (one.measure, one.level) == ("max_DI", 0.05))
    assert_allclose(lognorm.cdf(x, row["dispersion"], scale=row["median"]), fit.probability(x))


def test_curves_of_one_model_do_not_cross(tmp_path):
    """OpenQuake takes the difference of two states: it was negative from 0.75 g on."""
    runs = graded(SLIGHT, MODERATE)
    fits = fit_all(runs, "pga_g", 0, GRADES)
    paths = {path.name: path for path in write_curves(runs, fits, tmp_path)}
    stem = "fragility_w_max_psi_pga_g"
    model = ElementTree.parse(paths[f"{stem}_discrete.xml"]).getroot()[0]
    slight, moderate = (np.array(node.text.split(), float) for node in model[2][1:])
    assert (slight >= moderate).all() and "One dispersion" in model[0].text
    model = ElementTree.parse(paths[f"{stem}_continuous.xml"]).getroot()[0]
    variations = [float(node.get("stddev")) / float(node.get("mean")) for node in model[2][1:]]
    assert_allclose(variations, np.sqrt(np.expm1(0.72109038**2)), rtol=1e-5)
    table = pd.read_csv(paths["fragility_coefficients.csv"])
    assert_allclose(table["common_median"], [0.34013799, 0.48378855], rtol=1e-5)
    assert_allclose(table["common_dispersion"], 0.72109038, rtol=1e-5)
    assert table["dispersion"].between(0.4, 0.9).all() and table["dispersion"].nunique() == 2


def test_the_command_exports_and_names_a_missing_period(tmp_path, output_of, error_of):
    runs = walls(20, seed=5).assign(sa_eigen_period_g=0.1)
    write_table(runs, tmp_path / "study/tables/summary.csv")
    folders = "--out", tmp_path / "out", "--export", tmp_path / "curves"
    words = ["fragility", tmp_path / "study", "--replicates", 0, *folders]
    assert "--export by sa_eigen_period_g: " in error_of(*words)
    assert not (tmp_path / "out").exists()
    output_of(*words, "--intensity", "pga_g")
    for name in (
        "w_max_DI_pga_g_continuous.xml",
        "w_max_DI_pga_g_discrete.xml",
        "coefficients.csv",
    ):
        assert (tmp_path / f"curves/fragility_{name}").is_file()


# --- OpenQuake's own reading ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def openquake_python():
    with environment(OPENQUAKE, needs=OPENQUAKE_NEEDS) as python:
        yield python


@pytest.mark.long
@pytest.mark.parametrize("kind", ["continuous", "discrete"])
@pytest.mark.parametrize("intensity", ["pgv_m_s", "sa_eigen_period_g"])
def test_openquake_works_out_the_same_probabilities(openquake_python, tmp_path, kind, intensity):
    fits = [made(0.02, 0.15, 0.3, intensity), made(0.05, 0.3, 0.5, intensity)]
    path, model = written(tmp_path, kind, fits, eigen_period_s=0.2003)
    factor = 100 if intensity == "pgv_m_s" else 1
    levels = model[2][0]
    x = (
        np.array(levels.text.split(), float)[1:]
        if kind == "discrete"
        else np.geomspace(float(levels.get("minIML")), float(levels.get("maxIML")), 50)[1:]
    )
    below = float(levels.get("noDamageLimit")) * np.array([0.001, 0.5, 0.999])
    x = np.concatenate([below, x])
    found = json.loads(
        run_in(openquake_python, "read_nrml.py", path, ",".join(map(repr, map(float, x))))
    )
    assert (found["imt"], found["id"]) == (levels.get("imt"), "solid")
    for fit in fits:
        probabilities = np.array(found["states"][limit_state(fit)])
        assert not probabilities[:3].any()
        # Nine digits are written of a discrete curve.
        assert_allclose(probabilities[3:], fit.probability(x[3:] / factor), atol=1e-8)
