"""Ground that settles and soil in YADE and in the reference solver: the same cracks, reactions and energies."""

import numpy as np
import pytest
from conftest import REPOSITORY, SHORT
from numpy.testing import assert_allclose

import damage
from damage.measure.cracks import psi_history
from damage.measure.energy import energy_error_of
from damage.measure.ground import ground_measures
from damage.measure.patterns import compare_patterns

pytestmark = [pytest.mark.yade, pytest.mark.long]

SMALL = '''
import sys
sys.path.insert(0, {repository!r})
from damage import Joint, Opening, Wall

def wall():
    return Wall("small", 1.125, 0.6, [Opening(0.3375, 0.45, 0.3, 0.15)], joint=Joint({joint}))

if __name__ == "__main__":
    from yade_scripts.run import main
    main(wall)
'''
SOFT = "mode_i_fracture_energy=12.4, mode_ii_fracture_energy=124.0"


def both(folder, yade_command, damage_command, joint, *words):
    """Histories of a run in YADE and in the reference solver."""
    path = folder / "small.py"
    path.write_text(SMALL.format(repository=str(REPOSITORY), joint=joint))
    solvers = {"yade": lambda *more: yade_command(*SHORT, *more),
               "reference": lambda *more: damage_command("reference", *more)}
    for name, run in solvers.items():
        done = run(path, *words, "--no-pictures", "--out", folder / f"{name}.h5")
        assert done.returncode == 0, done.stdout + done.stderr
    return tuple(damage.read_history(folder / f"{name}.h5") for name in solvers)


def test_a_wall_with_softening_joints_settles_and_is_shaken_alike(tmp_path, yade_command, damage_command):
    """The reference solver's members have all the same cracks; reactions differ by 16 parallel elements in YADE."""
    histories = both(tmp_path, yade_command, damage_command, SOFT, "--settle", "hogging", "--distortion", "1/300",
                     "--lintel", 2, "--harmonic", 0.06, 0.2, "--rest", 0.1)
    found = [ground_measures(history) for history in histories]
    for name, tolerance in (("settled_crack_width_mm", 0.02), ("settled_psi", 0.02)):
        assert_allclose(found[0][name], found[1][name], rtol=tolerance)
    patterns = compare_patterns(*histories)
    assert patterns["broken"]["fss"] > 0.95 and patterns["visible"]["fss"] > 0.95
    last = [np.flatnonzero(history.series["stage"] == "settlement")[-1] for history in histories]
    yade, reference = (-history.support_force[at][:, 1].astype(float) for history, at in zip(histories, last))
    assert_allclose(yade, reference, atol=0.03 * reference.sum())
    assert max(map(energy_error_of, histories)) < 1e-3


def test_a_wall_on_soil_is_shaken_alike(tmp_path, yade_command, damage_command):
    histories = both(tmp_path, yade_command, damage_command, "", "--harmonic", 0.1, 0.15, "--rest", 0.3, "--soil", 5e7)
    yade, reference = (history.index()["DI"].max() for history in histories)
    assert_allclose(yade, reference, atol=0.01)
    assert_allclose(*(history.series["drift_ratio"].abs().max() for history in histories), rtol=0.03)
    assert_allclose(*(psi_history(history)["psi"].max() for history in histories), atol=0.15)
    assert max(map(energy_error_of, histories)) < 1e-3
