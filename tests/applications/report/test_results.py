"""One list of results has the unit of each, or what it is of, alike on the screen and in a
report."""

import json
import re

import numpy as np
from small_history import make_history

from damage.applications.report.run_part import run_part
from damage.applications.report.tables import measures
from damage.measure.results import KEY, RESULTS, SCALES, lines_of, result_of
from damage.measure.summary import summarise

LABEL = 22
"""Characters of a label on the screen."""


def shaken(folder):
    """A history with a drift ratio of 0.317 % and a joint that opens."""
    ramp = np.linspace(0, 1, 21)
    return make_history(folder / "a.h5", drift=3.17e-3 * ramp, opening={2: 4.2e-3 * ramp})


def lines(text):
    """{label: rest of the line} of the results in a summary."""
    return {line[:LABEL].strip(): line[LABEL:] for line in text.splitlines()}


def test_every_number_has_its_unit_or_what_it_is_of():
    assert all(
        result.unit or result.remark for result in RESULTS.values() if result.label[:3] != "Psi"
    )


def test_the_drift_component_is_of_the_drift_limit_and_the_drift_ratio_of_the_height(
    tmp_path, output_of
):
    """0.00317 over a limit of 2 % is 0.159, over one of 1 % 0.317."""
    path = shaken(tmp_path).path
    found = lines(output_of("index", path))
    assert re.fullmatch(r" +0\.159 +0\.159  of a drift ratio of 2 %", found["DI_drift"])
    assert re.fullmatch(r" +0\.317 +0\.317  % of the height", found["drift ratio"])
    found = lines(output_of("index", path, "--drift-limit-pct", "1", "--threshold-mm", "0.2"))
    assert re.fullmatch(r" +0\.317 +0\.317  of a drift ratio of 1 %", found["DI_drift"])
    assert found["DI_open"].endswith("  of the joint length, opened by 0.2 mm")


def test_failures_have_the_number_of_contact_points_beside_them(tmp_path):
    summary = summarise(shaken(tmp_path)) | {"shear_breaks": 8, "contact_points": 38}
    found = lines("\n".join(lines_of(summary)))
    assert found["failed contact points"].strip().endswith("of 38: 0 in tension, 8 in shear")
    assert found["failed contact points"].split()[0] == "8"
    shares = summary["evidence"]["shear failures of brittle joints"]
    assert shares["unit"] == "% of failed contact points"


def test_the_screen_and_a_report_show_one_criterion_of_slip_and_tables_all(tmp_path, output_of):
    history = shaken(tmp_path)
    text = output_of("index", history.path, "--slip", "accumulated")
    assert text.count("DI_slip") == 1 and "by accumulated" in text and "shear limit" not in text
    rows = dict(measures([run_part(history, "A")]))["Index, drift"]
    names = {row["name"] for row in rows}
    assert "max_DI_slip" in names and not [name for name in names if "accumulated" in name]
    assert "max_accumulated" in json.loads(output_of("index", history.path, "--json"))


def test_a_report_has_the_labels_numbers_and_units_of_the_screen(tmp_path, output_of):
    """And the sentence that says which scale answers which question."""
    history = shaken(tmp_path)
    screen = output_of("index", history.path)
    part = run_part(history, "A")
    assert part["scales"] == SCALES and SCALES in screen
    for (label, _, shown, unit, more), column in zip(part["key"], KEY):
        line = lines(screen)[label.removeprefix("residual ")]
        assert label == result_of(column).label and shown in line.split()
        assert unit in line and more.split(";")[0] in line
