"""What a run says of itself."""

from types import SimpleNamespace

import pytest

from damage.measure.warnings import energy_warnings, static_warnings


@pytest.mark.parametrize(("broken", "unbalanced", "words"), [
    (0, 1e-6, []), (3, 1e-6, ["3 contact points failed"]), (0, 2e-5, ["at rest"]),
    (0, float("nan"), []),  # interrupted before the static stage ended
    (1, 1.0, ["1 contact points failed", "at rest"]),
])
def test_an_odd_static_stage_is_reported(broken, unbalanced, words):
    history = SimpleNamespace(static={"broken_joints": broken, "unbalanced_force": unbalanced}, series=())
    warnings = static_warnings(history)
    assert len(warnings) == len(words)
    assert all(word in warning for word, warning in zip(words, warnings))


@pytest.mark.parametrize(("error", "count"), [(None, 0), (0.0099, 0), (0.011, 1), (1e15, 1), (float("nan"), 1)])
def test_an_energy_error_that_spoils_a_run_is_reported(error, count):
    assert len(energy_warnings(error)) == count
