"""The fast step against the plain one, which defines the model: the same bits, of every kind of wall and loading."""

import numpy as np
import pytest

from damage.motion.loading import Harmonic
from damage.reference.session import run_reference
from damage.reference.solver import ReferenceSolver
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.modes import natural_modes
from damage.wall.parameters import Brick, Joint, Opening, Wall

WEAK = {"tensile_strength": 3e4, "cohesion": 8e4}
SOFT = WEAK | {"mode_i_fracture_energy": 1.0, "mode_ii_fracture_energy": 10.0}
CRUSHING = {"compressive_strength": 5e5}
SPLITTING = {"tensile_strength": 1e5, "cohesion": 1.5e5}
ACTIONS = {
    "shaken": {}, "shaken vertically, too": {"vertical": 8.0}, "damped by mass": {"alpha": 5.0},
    "damped by stiffness": {"beta": 1e-6}, "local damping": {"local": 0.2}, "adaptive damping": {"adaptive": 1.0},
    "pushed": {"push": 0.5}, "pushed to and fro": {"push": 1.0, "to_and_fro": True, "adaptive": 1.0}}
KINDS = {
    "brittle": (WEAK, {}, {}), "softening": (SOFT, {}, {}), "parallel elements": (SOFT, {}, {"fibres": 4}),
    "crushing": (WEAK | CRUSHING, {}, {}), "splitting": (WEAK, SPLITTING, {}),
    "all of it": (SOFT | CRUSHING | {"compressive_fracture_energy": 10.0}, SPLITTING,
                  {"strength_cov": 0.3, "strength_seed": 2, "contacts": "corners"})}


def make(kind, fast, **more):
    """A small wall with an opening, at rest and still without its weight."""
    joint, brick, options = KINDS[kind]
    wall = Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses", joint=Joint(**joint),
                brick=Brick(**brick))
    layout = lay_out(wall, ModelOptions(**options))
    return ReferenceSolver(layout, 0.3 * natural_modes(layout).critical_time_step_s, fast=fast, **more)


def act(wall, push=0.0, to_and_fro=False, vertical=0.0, **damping):
    """Let a wall settle and be shaken, or pushed; yields what its samples hold."""
    wall.damp(local=0.7)
    wall.run(200)
    wall.damp(**damping)
    time_s = np.arange(600) * wall.time_step
    base = Harmonic(0.02, 2.0).base_acceleration(time_s) if not push else np.zeros((600, 2))
    base[:, 1] = vertical * np.cos(2 * np.pi * time_s / 0.03)
    wall.start(base)
    if push:
        wall.hold(wall.layout.pushed_bodies, rotation=to_and_fro)
    for sample in range(12):
        if push:
            wall.push(-push if to_and_fro and sample % 4 > 1 else push)
        wall.run(30, 20)
        yield wall.drain_events()
        yield from_instants(wall.instants())
    yield [table for table in wall.system if table is not wall.system.last]


def from_instants(instants):
    """All arrays of Instants."""
    contacts = instants.contacts
    return [*contacts.values(), *(value for value in instants if value is not contacts and value is not None)]


def as_bytes(parts):
    return [np.ascontiguousarray(part).tobytes() for part in parts if not isinstance(part, slice)]


@pytest.mark.parametrize("action", ACTIONS)
def test_brittle_walls_have_the_same_bits(action):
    compare("brittle", action)


@pytest.mark.parametrize("action", ["shaken", "damped by stiffness", "pushed to and fro"])
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "brittle"])
def test_other_walls_have_the_same_bits(kind, action):
    compare(kind, action)


def compare(kind, action):
    fast, plain = make(kind, fast=True), make(kind, fast=False)
    for number, (one, other) in enumerate(zip(act(fast, **ACTIONS[action]), act(plain, **ACTIONS[action]))):
        assert as_bytes(one) == as_bytes(other), number
    states = fast.system.states
    assert states["broken"].any() or states["kappa"].any() or "damping" in action
    if "crushing" in kind and "push" in action:
        assert (states["closure"] > 0).any()


def test_a_run_by_the_plain_step_has_the_same_history(tmp_path):
    from benchmarks.same_bits import differences

    wall = "from damage import Wall\n\n\ndef wall():\n    return Wall('small', 0.9, 0.45)\n"
    (tmp_path / "small.py").write_text(wall)
    for step in ("fast", "plain"):
        words = ["--harmonic", "0.05", "1.2", "--cycles", "2", "--rest", "0.05", "--no-pictures", "--step", step]
        assert run_reference([str(tmp_path / "small.py"), *words, "--out", str(tmp_path / f"{step}.h5")]) == 0
    assert differences(tmp_path / "fast.h5", tmp_path / "plain.h5") == []
