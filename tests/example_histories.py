"""What examples in docstrings have, made by hand: `history` of a small wall with two open joints,
`pushed` and `cyclic` of one that is pushed once, and to and fro, `vibrating` of one in free
vibration, and `houses` of two walls that meet at a corner; a plugin of pytest, `-p
tests.example_histories`."""

import numpy as np
import pytest

from damage.house.house import Corner, House, Placed
from damage.house.layout import lay_out_house
from damage.units import MILLIMETRE
from damage.wall.parameters import Brick, Wall
from tests.small_history import CYCLIC, STAGES_21, make_history, small_layout


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
    layout = small_layout()
    time_s = np.arange(0.0, CYCLIC.length_s(layout.drift_height) + 0.01, 0.01)
    drift = CYCLIC.top_displacement(time_s, layout.drift_height) / layout.drift_height
    doctest_namespace["cyclic"] = make_history(
        folder / "cyclic.h5", stages=("motion",) * len(time_s), drift=drift, loading="cyclic"
    )
    doctest_namespace["vibrating"] = make_history(
        folder / "vibrating.h5",
        stages=("rest",) * 41,
        drift=0.001 * np.sin(2 * np.pi * np.arange(41) / 10),
        loading="free_vibration",
        eigen_period_s=0.1,
    )
    bricks = {"height": 0.4, "precompression": 0.0, "brick": Brick(0.4, 0.2, 0.2)}
    front = Wall("front", 1.2, **bricks)
    side = Wall("side", 1.2, base_course="half", **bricks)
    placed = Placed(front), Placed(side, (0.1, -0.1), 90)
    doctest_namespace["houses"] = make_history(
        folder / "house.h5",
        lay_out_house(House("small", placed, [Corner(("front", "side"), "toothed")])),
    )
