"""Shipped walls in YADE, kicked while intact: static stage, periods, energy, and 100 000 steps; a
small wall is kicked in `test_yade_run.py`."""

import pytest
from conftest import BRIEFLY, REPOSITORY
from numpy.testing import assert_allclose

import damage
from damage.measure.energy import energy_error
from damage.measure.summary import summarise

pytestmark = [pytest.mark.yade, pytest.mark.long]

# Rest [s] of 3.3 periods: a sinusoid's is known from three.  What the settling stage leaves is not
# looked at here.
KICKED = [("symmetric", 0.66), ("solid", 0.21), ("asymmetric", 0.58), ("symmetric", 3.0)]


@pytest.fixture(scope="module", params=KICKED, ids=lambda values: "{}-{}".format(*values))
def free_vibration(request, yade_command, tmp_path_factory):
    wall, rest = request.param
    out = tmp_path_factory.mktemp("free") / f"{wall}.h5"
    yade_command(
        BRIEFLY,
        "SETTLE_S=0.02",
        REPOSITORY / f"walls/{wall}.py",
        "--free-vibration",
        "--rest",
        rest,
        "--out",
        out,
        "--no-pictures",
        status=0,
    )
    return damage.read_history(out)


class TestIntactWall:
    def test_static_stage_carries_the_weight_at_rest_and_unbroken(self, free_vibration):
        static = free_vibration.static
        assert_allclose(static["base_reaction_n"], static["weight_n"], rtol=1e-3)
        assert static["unbalanced_force"] < 1e-5
        assert static["broken_joints"] == 0 and len(free_vibration.events) == 0

    def test_period_agrees_with_the_eigenvalue(self, free_vibration):
        period = summarise(free_vibration)["period_s"]
        # The eigenvalue knows no P-delta, which softens the wall by about W / (k h) = 0.4 %.
        assert_allclose(period, free_vibration.parameters["eigen_period_s"], rtol=5e-3)

    def test_energy_of_the_kick_is_kept(self, free_vibration):
        assert energy_error(free_vibration.series) < 5e-3

    def test_joints_report_no_damage(self, free_vibration):
        assert (
            free_vibration.index().DI_open.max() == 0 and free_vibration.index().DI_slip.max() == 0
        )
        assert not free_vibration.at_limit.any()
