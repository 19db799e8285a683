"""The scene that scripts and YADE's prompt work on: what is refused, and forces against statics.

The guide for YADE users, with engines, the prompt, O.save and O.load, is followed in
test_guides.py.
"""

import json
import math

import pytest
from conftest import REPOSITORY, written
from numpy.testing import assert_allclose

pytestmark = pytest.mark.yade

SCRIPT = f"""
import json, sys
sys.path.insert(0, {str(REPOSITORY)!r})
from yade import *
from damage.run import settings
settings.SETTLE_S = 0.05  # before others take it; nothing here asks of it
from damage import Wall, warnings_of
from damage.errors import InputError, RunError
from yade_scripts import current_scene, open_scene
from yade_scripts.leaving import run_and_leave

WALL = Wall("panel", 0.675, 0.3, precompression=0.3e6)


def said(function, *arguments, **named):
    try:
        function(*arguments, **named)
    except (InputError, RunError) as error:
        return str(error)


def refusals():
    own, found = list(O.engines), {{}}
    found["given"] = said(open_scene, WALL, engines=[NewtonIntegrator()])
    found["no engine"] = said(open_scene, WALL, engines=["write()"])
    own[-1].damping = 0.4
    found["changed"] = said(open_scene, WALL)
    own[-1].damping = 0.2
    O.engines = [*own, GlobalStiffnessTimeStepper(label="second")]
    found["appended"] = said(open_scene, WALL)
    O.engines = own
    found["option"] = said(open_scene, WALL, harmonix=1)
    found["bodies"] = O.bodies.append(utils.sphere((0, 0, 0), 1)) or said(open_scene, WALL)
    O.bodies.clear()
    return found


def opened():
    counted = []
    globals()["count"] = lambda: counted.append(O.iter)
    O.engines += [PyRunner(command="count()", iterPeriod=1)]
    scene = open_scene(WALL, harmonic=(0.05, 0.1), cycles=1, rest=0)
    assert scene is current_scene() and counted == []
    O.step()
    forces = [abs(force) for joint in scene.joints.index for force in scene.force(joint)]
    found = {{"weightless": max(forces)}}
    scene.settle()
    steps = O.iter
    O.run(10, True)
    joints = scene.joints
    ground = joints.index[joints["first_body"] < 0]
    found |= {{"steps": [O.iter - steps, len(counted) - steps + 1],
              "weight": scene.layout.total_mass * 9.81,
              "ground": [sum(forces) for forces in zip(*(scene.force(joint) for joint in ground))],
              "near": joints.loc[scene.joint_at(0.3, 0.15, "head"), ["x_m", "z_m"]].tolist(),
              "kind": said(scene.joint_at, 0, 0, "base"), "far": said(scene.force, 1000)}}
    history = scene.finish()
    found |= {{"samples": len(history.series), "status": history.status,
              "again": said(scene.finish), "codes": codes(history)}}
    O.reset()
    return found | {{"replaced": said(scene.solver.advance, 1)}}


def slippery():  # half of the friction, set for each bond of a wall that is pushed until it slides
    low = Wall("low", 0.45, 0.15, precompression=0.3e6)
    scene = open_scene(low, pushover=0.12, boundary="fixed")
    for bond in scene.solver.model.physics:
        bond.tanFrictionAngle *= 0.5
    history = scene.finish()
    return {{"shear": float(history.series["base_shear_n"].iloc[-20:].mean()),
            "load": scene.layout.total_mass * 9.81, "changed": changed(history),
            "bonds": len(scene.solver.model.bonds)}}


def weakened():  # before and after the static stage
    found = []
    for out in (None, sys.argv[0] + ".h5"):
        O.reset()
        scene = open_scene(WALL, harmonic=(0.05, 0.1), cycles=1, rest=0, out=out)
        scene.interactions(0)[0].phys.FnMax = 0
        scene.settle()
        O.bodies[scene.solver.model.clumps[1]].state.mass *= 2
        history = scene.finish()
        found += [changed(history), codes(history)]
    return found


def changed(history):
    return history.parameters.get("changed_by_hand")


def codes(history):
    return [one.code for one in warnings_of(history)]


run_and_leave(lambda: print(json.dumps([refusals(), opened(), slippery(), weakened()])))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory, yade_command):
    path = written(tmp_path_factory.mktemp("scene") / "scene.py", SCRIPT)
    done = yade_command(path, status=0)
    return json.loads(done.stdout.splitlines()[-1])


def test_engines_and_bodies_that_would_vanish_are_refused_by_name(found):
    refused, *_ = found
    for case, engine in (
        ("given", "NewtonIntegrator"),
        ("changed", "NewtonIntegrator(newton)"),
        ("appended", "GlobalStiffnessTimeStepper(second)"),
    ):
        assert refused[case].startswith(f"the engine {engine}: the wall's own replaces it"), case
    assert "expected engines of YADE" in refused["no engine"]
    assert "did you mean harmonic?" in refused["option"]
    assert refused["bodies"].startswith("the scene has 1 bodies already: expected none")


def test_an_open_scene_is_weightless_then_carries_its_weight(found):
    _, scene, *_ = found
    assert scene["weightless"] < 1e-6 * scene["weight"]
    assert_allclose(scene["ground"], [-scene["weight"], 0.0], atol=1e-6 * scene["weight"])
    assert scene["steps"] == [10, 10]
    assert_allclose(scene["near"], [0.3375, 0.1125], atol=0.04)
    assert (
        "expected one of bed, head" in scene["kind"]
        and "expected a row of scene.joints" in scene["far"]
    )


def test_a_scene_finishes_its_run_once_and_not_in_another_scene(found):
    _, scene, *_ = found
    assert scene["status"] == "complete" and scene["samples"] > 30
    assert "open it anew" in scene["again"] and "the wall's scene was replaced" in scene["replaced"]


def test_friction_that_a_script_sets_for_bonds_stays_when_they_fail(found):
    slid = found[2]
    assert_allclose(slid["shear"], 0.5 * math.tan(math.radians(32)) * slid["load"], rtol=5e-3)


def test_a_scene_that_was_changed_by_hand_says_so(found):
    """Not one that steps alone moved on."""
    _, scene, slid, weakened = found
    assert "changed_by_hand" not in scene["codes"]
    assert slid["changed"] == f"tanFrictionAngle of bonds ({slid['bonds']})"
    in_memory = weakened[:2]
    in_a_file = weakened[2:]
    assert in_memory == in_a_file
    said, codes = in_memory
    assert said == "FnMax of bonds (1), masses of bricks (1)" and "changed_by_hand" in codes
