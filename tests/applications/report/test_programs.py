"""Walls for OpenSees: what is written is read back and compared with the layout; OpenSeesPy runs it
(long)."""

import json
import math
import sys
import types
from itertools import pairwise

import numpy as np
import pytest
from conftest import one_line_error
from environments import environment, run_in
from numpy.testing import assert_allclose

import damage
from damage.applications.report.opensees import write_opensees
from damage.errors import RunWarning
from damage.law.joint_law import ContactState, LawParameters, advance, material_of
from damage.law.modes import natural_modes, static_displacement
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Opening, Wall

DOOR = Wall("door", 1.35, 0.9, [Opening(0.45, 0.45, 0.6)], lintel="courses")
SCATTERED = ModelOptions(contacts="corners", strength_cov=0.3, strength_seed=4)


class Recorder(types.ModuleType):
    """In the place of openseespy.opensees: keeps every command, (name, arguments)."""

    def __init__(self):
        super().__init__("openseespy.opensees")
        self.commands = []

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *arguments: self.commands.append((name, arguments))

    def all_of(self, name):
        return [arguments for command, arguments in self.commands if command == name]


def script_of(layout, tmp_path, monkeypatch):
    """Names of the script of a layout, after build(), and the Recorder that it spoke to."""
    ops = Recorder()
    package = types.ModuleType("openseespy")
    package.opensees = ops
    monkeypatch.setitem(sys.modules, "openseespy", package)
    monkeypatch.setitem(sys.modules, "openseespy.opensees", ops)
    names = {"__name__": "model"}
    exec(write_opensees(layout, tmp_path / "wall.py").read_text(encoding="utf-8"), names)
    names["build"]()
    return names, ops


@pytest.mark.parametrize(
    ("wall", "options"),
    [
        (DOOR, SCATTERED),
        (DOOR, ModelOptions(top="uniform", supports="bricks")),
        (DOOR, ModelOptions(bricks="deformable", brick_cells=4, soil="1e8")),
        (
            Wall("split", 0.9, 0.6, brick=Brick(tensile_strength=1e6)),
            ModelOptions(lintel="concrete"),
        ),
    ],
)
def test_opensees_has_the_mass_the_joints_and_their_sums(wall, options, tmp_path, monkeypatch):
    layout = lay_out(wall, options)
    names, ops = script_of(layout, tmp_path, monkeypatch)
    contacts, joints = layout.contacts, np.array([one[5:] for one in names["JOINTS"]])
    assert_allclose(sum(one[1] for one in ops.all_of("mass")), layout.total_mass, rtol=1e-13)
    assert len(ops.all_of("element")) == len(contacts) == len(names["INTACT"])
    sums = joints[:, 2:].sum(axis=0)
    for found, name in zip(
        sums, ("normal_stiffness", "shear_stiffness", "tensile_strength", "cohesion")
    ):
        assert_allclose(found, np.sum(getattr(contacts, name) * contacts.area), rtol=1e-13)
    breakable = np.isfinite(joints[:, 5])
    assert_allclose(
        joints[breakable, 5].sum(), np.sum((contacts.cohesion * contacts.area)[~contacts.elastic])
    )
    assert_allclose(names["FRICTION"], math.tan(wall.joint.friction_angle), rtol=1e-15)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--bricks", "deformable"), "with deformable bricks"),
        (("--soil", "1e8", "--soil-velocity", "150"), "radiation damping"),
    ],
)
def test_what_opensees_cannot_have_is_refused(words, said, tmp_path, error_of):
    assert said in error_of("export", "symmetric", *words, "--opensees", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_walls_that_soften_are_refused_and_others_written(tmp_path, output_of):
    soft = Joint(mode_i_fracture_energy=10.0, mode_ii_fracture_energy=100.0)
    assert "soften" in one_line_error(
        write_opensees, lay_out(Wall("soft", 0.9, 0.45, joint=soft)), tmp_path / "out"
    )
    assert output_of("export", "squat", "--opensees", tmp_path / "squat.py").split() == [
        str(tmp_path / "squat.py")
    ]


@pytest.mark.long
def test_openseespy_settles_slides_rocks_and_shakes_as_this_project_does(tmp_path):
    """In OpenSeesPy itself: settlement and period of a wall, and the wall shaken; a brick along a
    path that breaks, slides, reverses, opens and closes, against the joint law; a pier that is
    pushed over, against statics."""
    door, pier = lay_out(DOOR), lay_out(Wall("pier", 0.45, 0.3))
    brick = lay_out(Wall("brick", 0.225, 0.075, precompression=0.0))
    scripts = [
        str(write_opensees(layout, tmp_path / f"{layout.wall.name}.py"))
        for layout in (door, brick, pier)
    ]
    path, forces = path_of_a_brick(brick)
    (tmp_path / "path.json").write_text(json.dumps(path), encoding="utf-8")
    with environment("openseespy", "openseespylinux") as python:
        rest, along, shaken, pushed = (
            json.loads(run_in(python, "run_opensees.py", *words))
            for words in (
                ("weight", scripts[0]),
                ("path", scripts[1], str(tmp_path / "path.json")),
                ("shake", scripts[0], "0.06", "0.1", "3", "2e-4", "1100"),
                ("push", scripts[2], str(len(pier.bodies)), "2e-6", "300"),
            )
        )
    settled = -static_displacement(door)[door.drift_bodies, 1].mean()
    assert_allclose(
        [rest["settlement_m"], rest["period_s"]],
        [settled, natural_modes(door).period_s[0]],
        rtol=1e-6,
    )
    assert_allclose(along["forces_n"], forces, atol=1e-8 * np.abs(forces).max())
    assert pushed["found"] and pushed["failed"] > 4
    # the last contact point at the base
    outermost = pier.contacts.x[pier.contacts.first < 0].max() - 0.225
    height = pier.bodies.z[-1]
    # on the ground
    assert_allclose(pushed["shear_n"][-1], -pushed["weight_n"] * outermost / height, rtol=1e-3)
    with pytest.warns(RunWarning, match="elastic"):
        history = damage.run(DOOR, harmonic=(0.06, 0.1), cycles=3, rest=0.05)
    assert_allclose(
        np.abs(shaken["top_m"]).max(), history.moving["top_displacement_m"].abs().max(), rtol=0.02
    )
    assert_allclose(shaken["failed"], history.broken[-1].sum(), rtol=0.2)


def path_of_a_brick(layout):
    """Places (x, z) [m] of the only brick, 40 a leg, and its forces on the ground by the joint law
    (n, 2) [N]."""
    contacts, joint = layout.contacts, layout.wall.joint
    kn, ks = contacts.normal_stiffness[0], contacts.shear_stiffness[0]
    down, along = 0.3e6 / kn, 0.6e6 / ks
    legs = [
        (0, 0),
        (0, -1),
        (1, -1),
        (2, -2),
        (2, -0.5),
        (-1, -0.5),
        (-1, 0.5),
        (0, 0.5),
        (0, -1),
        (0.1, -1),
        (3, -1),
    ]
    path = [
        ((a[0] + (b[0] - a[0]) * k / 40) * along, (a[1] + (b[1] - a[1]) * k / 40) * down)
        for a, b in pairwise(legs)
        for k in range(1, 41)
    ]
    law = LawParameters(kn, ks, joint.tensile_strength, joint.cohesion, material_of(joint))
    state, forces, before = ContactState(), [], 0.0
    for x, z in path:
        state, _ = advance(z, x - before, state, law)
        forces.append((state.shear_stress, state.normal_stress))
        before = x
    return path, np.array(forces) * contacts.area.sum()
