"""The scene of a wall, open to scripts and to YADE's prompt: joints by place, stages, engines
beside its own."""

import io
import signal
import sys
from contextlib import redirect_stdout
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd
import yade
from yade import O

from damage.errors import InputError, RunError
from damage.history.in_memory import HistoryInMemory
from damage.history.reader import read_history
from damage.history.schema import JOINTS
from damage.history.writer import HistoryWriter, layout_tables
from damage.run.cooperative import to_its_end
from damage.run.prepare import prepare
from damage.run.run import Run
from damage.run.session import history_of
from damage.wall.kinds import KINDS
from yade_scripts.bonds import bonds_by_law

_OWN = (
    yade.ForceResetter,
    yade.Collider,
    yade.InteractionLoop,
    yade.TimeStepper,
    yade.NewtonIntegrator,
)
"""Engines that a wall has by itself, as every new scene of YADE's; the time step is the run's."""
OF_BONDS = "kn", "ks", "FnMax", "FsMax", "tanFrictionAngle"
_PROMPT = """{wall} {stage} the run, stage {run_stage}, {time:.3f} s.  At hand: {names}.
scene.joint_at(x, z), scene.force(joint), O.interactions, ...; exit ends the prompt{then}."""


class Scene:
    """A wall in YADE's scene.

    layout: damage.wall.layout.Layout; solver: yade_scripts.solver.YadeSolver, with `solver.model`
    (clumps, members, bonds: YADE's bodies and interactions in the layout's order); run:
    damage.run.run.Run, None before there is one; console: when YADE's prompt comes, "before" or
    "after" the run, or None.
    """

    current = None
    """The last one that was built: there is one scene, as there is one O."""

    def __init__(self, layout, solver, console=None):
        self.layout = layout
        self.solver = solver
        self.run = None
        self.console = console
        self._prepared = None
        self._settled = False
        self._finished = False
        self._left = Properties.read(solver)
        self._changed = []
        Scene.current = self

    def __repr__(self):
        return (
            f"<Scene {self.wall.name}: {len(self.layout.bodies)} bodies, {self.layout.n_joints}"
            " contact points>"
        )

    @property
    def wall(self):
        """damage.Wall."""
        return self.layout.wall

    @property
    def joints(self):
        """DataFrame, a row a contact point, as `history.joints`: bodies, place, length,
        stiffnesses, strengths."""
        columns = layout_tables(self.layout)
        table = pd.DataFrame({name: columns[f"joints/{name}"] for name in JOINTS})
        return table.assign(kind=np.array(KINDS)[table["kind"]])

    @property
    def history(self):
        """History of what was written so far."""
        return read_history(self.run.writer.path)

    def joint_at(self, x, z, kind=None):
        """Number of the contact point nearest to a place in the undeformed wall [m]; kind: one of
        KINDS, as "bed" and "head", or None for any."""
        joints = self.joints
        if kind is not None and kind not in set(joints["kind"]):
            raise InputError(
                f"joint_at(kind={kind!r}): expected one of"
                f" {', '.join(sorted(set(joints['kind'])))}; correct it"
            )
        away = np.hypot(joints["x_m"] - x, joints["z_m"] - z)
        return int((away if kind is None else away[joints["kind"] == kind]).idxmin())

    def interactions(self, joint):
        """YADE's interactions of a contact point now: the bond, or the dry contact that replaced
        it."""
        self._check_joint(joint)
        return [self.solver.model.bonds[joint]]

    def force(self, joint):
        """Normal force of a contact point, tension positive, and shear force, signed as its slip,
        both along the present joint [N]."""
        self._check_joint(joint)
        return self.solver.scene.force_of(joint)

    def _check_joint(self, joint):
        if not 0 <= joint < self.layout.n_joints:
            raise InputError(
                f"contact point {joint}: expected a row of scene.joints, 0 to"
                f" {self.layout.n_joints - 1}; scene.joint_at(x, z) finds one"
            )

    def settle(self):
        """Take the wall to rest under its weight and precompression, the static stage; returns this
        Scene."""
        prepared = self._asked("settle")
        self.changed_by_hand()
        self.run = Run(
            self.layout, prepared.settings, self.solver, prepared.writer, lambda run, time_s: True
        )
        with redirect_stdout(io.StringIO()):
            to_its_end(self.run.come_to_rest())
        self._settled = True
        self._left = Properties.read(self.solver)
        return self

    def finish(self):
        """The whole run that the options ask for, after `settle` what is left of it; returns its
        History."""
        prepared = self._asked("finish")
        self._finished = True
        backend = replace(prepared.backend, make=lambda *_: self.solver, begins=self._begins)
        with redirect_stdout(io.StringIO()):
            return history_of(replace(prepared, backend=backend), _AtRest(self._settled))

    def _begins(self, run):
        self.run = run
        return self.changed_by_hand()

    def changed_by_hand(self):
        """What scripts and people have changed of the wall that was built, in words, "" where
        nothing."""
        now = Properties.read(self.solver)
        by_law = bonds_by_law(self.layout)
        for name, number in now.changed_since(self._left, by_law).items():
            self._changed.append(f"{name} ({number})")
        self._left = now
        return ", ".join(self._changed)

    def _asked(self, what):
        if self._prepared is None or self._finished:
            raise RunError(
                f"scene.{what}(): expected a scene of open_scene that has not run; open it anew"
            )
        return self._prepared


class Properties(NamedTuple):
    """What a run takes from YADE's bonds and clumps: steps so far; {name: (n_contacts,)} of bonds,
    NaN of those that failed; masses of clumps (n_bodies,) [kg]."""

    step: int
    of_bonds: dict
    masses: np.ndarray

    @classmethod
    def read(cls, solver):
        """The Properties of the wall of a YadeSolver now."""
        model = solver.model
        of_bonds = {
            name: np.array([getattr(physics, name, np.nan) for physics in model.physics], float)
            for name in OF_BONDS
        }
        masses = np.array([O.bodies[clump].state.mass for clump in model.clumps])
        return cls(O.iter, of_bonds, masses)

    def changed_since(self, before, by_law):
        """{name: how many bonds or bricks} that differ from earlier Properties, but for what steps
        since then may have changed; by_law: as of `bonds_by_law`."""
        stepped = self.step != before.step
        counts = {}
        for name, values in self.of_bonds.items():
            earlier = before.of_bonds[name]
            differ = (values != earlier) & ~np.isnan(values) & ~np.isnan(earlier)
            if stepped:
                differ[: len(by_law)] &= ~by_law
            counts[f"{name} of bonds"] = differ
        counts["masses of bricks"] = self.masses != before.masses
        return {name: int(differ.sum()) for name, differ in counts.items() if differ.any()}


class _AtRest:
    """Says, in place of damage.reference.rest_cache.Rest, whether a wall is at rest already."""

    def __init__(self, is_at_rest):
        self._is_at_rest = is_at_rest

    def recall(self, solver):
        return () if self._is_at_rest else None

    def keep(self, solver, looks):
        """The scene itself is what is kept."""


def open_scene(backend, settings, wall_file, wall):
    """The Scene of a damage.Wall as these settings build it, weightless and intact; arguments: as
    of `prepare`."""
    with redirect_stdout(io.StringIO()):
        prepared = prepare(
            backend,
            wall_file,
            lambda: wall,
            settings,
            HistoryInMemory if settings.out is None else HistoryWriter,
        )
        backend.make(prepared.layout, prepared.time_step, prepared.settings)
    scene = Scene.current
    scene._prepared = prepared
    return scene


def engines_beside(more):
    """Engines that a script put into O.engines or gives, to be kept behind the wall's own.

    Raises InputError for one that the wall's own replaces, and for bodies, which its scene does not
    keep.
    """
    if len(O.bodies) > 0:
        raise InputError(
            f"the scene has {len(O.bodies)} bodies already: expected none, as a wall makes its own"
            " scene; open it first (yade_scripts.open_scene), then add bodies"
        )
    present = list(O.engines)
    given = list(more)
    engines = [engine for engine in present if not isinstance(engine, _OWN)]
    for engine in (
        *(engine for engine in present if isinstance(engine, _OWN) and not _is_as_new(engine)),
        *(entry for entry in given if isinstance(entry, _OWN)),
    ):
        raise InputError(
            f"the engine {name_of(engine)}: the wall's own replaces it, with the time step, gravity"
            " and damping of the run; expected engines beside those; leave it out, or as YADE's"
            " new scene has it"
        )
    for engine in (*engines, *given):
        if not isinstance(engine, yade.Engine):
            raise InputError(
                f"engines: {engine!r}; expected engines of YADE, like PyRunner(command='f()', "
                "virtPeriod=0.01); correct it"
            )
    return [*engines, *given]


def _is_as_new(engine):
    """Whether an engine is one of those of a new scene, with its values."""
    new = type(engine)().dict()
    plain = [
        name
        for name, value in new.items()
        if name not in ("label", "timeStepUpdateInterval", "functors")
        and not isinstance(value, (list, yade.Serializable))
    ]
    return any(engine is usual for usual in yade.utils.defaultEngines) and all(
        str(engine.dict()[name]) == str(new[name]) for name in plain
    )


def name_of(engine):
    """An engine in words: its class, and its command or label."""
    more = getattr(engine, "command", "") or engine.label
    return type(engine).__name__ + (f"({more})" if more else "")


def prompt(scene, stage, then="", **more):
    """YADE's prompt, with what is in YADE's own and the parts of a Scene; stage: "before" or
    "after" the run; then: what follows; more: {name: value} beside these."""
    from IPython.terminal.embed import InteractiveShellEmbed  # noqa: T100

    names = {"O": O, "scene": scene, "wall": scene.wall, "run": scene.run, **more}
    main = sys.modules["__main__"]  # where YADE's own prompt is
    vars(main).update(names)
    shell = InteractiveShellEmbed()  # noqa: T100, as YADE has set it up
    shell.banner1 = (
        _PROMPT.format(
            wall=scene.wall.name,
            stage=stage,
            run_stage=scene.run.stage,
            time=scene.run.time,
            names=", ".join(names),
            then=then,
        )
        + "\n"
    )
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # of the run it would end it
    try:
        with redirect_stdout(sys.__stdout__):
            shell(module=main, local_ns=vars(main))
    finally:
        signal.signal(signal.SIGINT, before)
