"""What examples in docstrings have: `history` of a small wall with two open joints, and `pushed` of
one that is pushed, both made by hand; a plugin of pytest, `-p tests.example_histories`."""

import numpy as np
import pytest

from damage.units import MILLIMETRE
from tests.small_history import STAGES_21, make_history


@pytest.fixture(autouse=True, scope="session")
def examples(doctest_namespace, tmp_path_factory):
    folder = tmp_path_factory.mktemp("examples")
    doctest_namespace["history"] = make_history(
        folder / "run.h5",
        drift=0.001,
        opening={0: 0.2 * MILLIMETRE, 1: 0.4 * MILLIMETRE},
        slip={5: 0.2 * MILLIMETRE},
    )
    drift = np.linspace(0.0, 0.002, len(STAGES_21))
    doctest_namespace["pushed"] = make_history(
        folder / "pushed.h5",
        stages=("motion",) * len(STAGES_21),
        drift=drift,
        row={"base_shear_n": 1e4 * np.minimum(drift / 0.001, 1.0)},
        loading="pushover",
        opening={0: np.minimum(drift, 0.0005)},
    )
