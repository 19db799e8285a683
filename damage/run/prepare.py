"""What is settled before a run begins: its plan, from wall and settings, and its history."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from damage.history.buffer import Buffer
from damage.history.writer import HistoryWriter, check_output
from damage.house.coarser import in_units
from damage.house.drawn import drawn, ranges
from damage.house.layout import lay_out_building
from damage.linear.modes import Modes, natural_modes
from damage.measure.evidence import evidence_for, outside
from damage.motion.intensity import applied_measures
from damage.provenance import file_origin, versions
from damage.run.banner import announce
from damage.run.checkpoint import Checkpoints, read_end, resumed, schemes_left
from damage.run.initial_state import read_state, without_bond
from damage.run.monitor import DROP
from damage.run.paths import free_name
from damage.run.report import check_pictures
from damage.run.schedule import check_size, check_top
from damage.run.scheme import schemes
from damage.run.settings import SELECTIVE, SOFTENING_BETA_S, RunSettings
from damage.wall.layout import Layout


@dataclass(frozen=True)
class Backend:
    """A solver as a session needs it.

    versions: {software: version} beside this software's own; code: the folder of the solver's
    modules; make(layout, time_step, settings): a damage.run.solver.Solver; check(settings, wall):
    raises InputError on what it cannot do; open_view: opens a live view and returns a function that
    refreshes it; None where there is none; softening_beta_s: stiffness-proportional damping of
    joints that soften [s];
    keeps_state: whether the history has the state at its end, from which another run continues; it
    is in a checkpoint otherwise;
    begins(run): called with the Run before its first step, returns what was changed by hand since
    the wall was built, in words; most: runs that step together at most.
    """

    name: str
    versions: dict
    make: Callable
    code: Path
    check: Callable = lambda settings, wall: None
    open_view: Callable | None = None
    softening_beta_s: float = SOFTENING_BETA_S
    keeps_state: bool = True
    begins: Callable = lambda run: ""
    most: int = 1


@dataclass(frozen=True)
class RunPlan:
    """A run as it will be, before anything is written.

    Attributes
    ----------
    backend : Backend
    settings : RunSettings
    layout : Layout
    modes : Modes
    time_step : float
        [s]
    repeats : tuple of (RunSettings, float)
        Of runs with these time steps [s] that follow until one is accepted (`damage.run.scheme`).
    so_far : dict
        Parameters of a resumed run that say how it was repeated.
    """

    backend: Backend
    settings: RunSettings
    layout: Layout
    modes: Modes
    time_step: float
    repeats: tuple[tuple[RunSettings, float], ...]
    so_far: dict

    @property
    def made_by(self):
        """{software: version}."""
        return versions(self.backend.code) | self.backend.versions

    @property
    def origin(self):
        """Origin as of `read_earlier`."""
        return self.backend.name, self.made_by["model"]

    def solver(self):
        """A new solver of the run."""
        return self.backend.make(self.layout, self.time_step, self.settings)

    def parameters_with(self, wall_file):
        """Parameters of its history."""
        loading = self.settings.loading
        wall = self.layout.wall
        period_s = float(self.modes.period_s[0])
        parameters = {
            "wall": wall.as_dict(),
            "wall_file": file_origin(wall_file),
            **self.settings.as_dict(),
            "time_step_s": self.time_step,
            **self.so_far,
            "critical_time_step_s": self.modes.critical_time_step_s,
            "eigen_period_s": period_s,
            "pier_stress_pa": self.layout.pier_stress,
            **applied_measures(loading.applied(), period_s, loading.applied_across()),
            **self.layout.house_parameters,
        }
        return parameters | {
            "outside_validity": "; ".join(outside(evidence_for(wall, parameters))) or None
        }

    def past(self):
        """`state` of a Prepared run."""
        if not self.settings.continued:
            return None
        if self.backend.keeps_state:
            return read_state(self.settings.continued, self.layout, self.origin, self.solver())
        return read_end(self.settings.continued, self.layout, self.origin, self.time_step)


@dataclass(frozen=True)
class Prepared(RunPlan):
    """A run that can begin: its history is there, without a sample.

    writer: keeps it; state: of the run that it continues, None without one; resumed: tables of the
    checkpoint from which it continues, None of a run that begins; checkpoints: what writes them;
    parameters: of the history; write(parameters=...): makes a history.
    """

    writer: Buffer
    state: dict | None
    resumed: dict | None
    checkpoints: Checkpoints
    parameters: dict
    write: Callable

    def repeated(self, reason):
        """The Prepared run that follows one that was not accepted, by a RunError; its history
        begins anew."""
        (settings, time_step), *others = [
            (scheme, step_s)
            for scheme, step_s in self.repeats
            if reason.code != DROP or scheme.mass_scaling != SELECTIVE
        ]
        parameters = (
            self.parameters
            | settings.as_dict()
            | {
                "time_step_s": time_step,
                "repeats": self.parameters["repeats"] + 1,
                "repeated_for": reason.code,
            }
        )
        how = "explicitly, " if settings.mass_scaling != SELECTIVE else ""
        print(f"{reason}: repeated {how}in steps of {time_step:.3g} s", flush=True)
        self.checkpoints.remove()
        self.writer.begin_again(partial(self.write, parameters=parameters))
        return replace(
            self,
            settings=settings,
            time_step=time_step,
            repeats=tuple(others),
            parameters=parameters,
            resumed=None,
        )


def prepare(backend, wall_file, make_wall, settings, write=HistoryWriter):
    """A Prepared run, of RunSettings and otherwise the arguments of `run_session`; what it will be
    is printed.

    write: makes what keeps the history, HistoryInMemory in place of HistoryWriter where there is to
    be no file.
    """
    plan, out = announced(backend, make_wall, settings)
    settings = plan.settings
    state = plan.past()
    parameters = plan.parameters_with(wall_file)
    write = partial(
        write,
        out,
        plan.layout,
        solver=backend.name,
        versions=plan.made_by,
        overwrite=settings.overwrite,
    )
    if settings.resumed:
        writer, tables = resumed(
            settings.resumed, plan.layout, parameters, plan.origin, scene=not backend.keeps_state
        )
    else:
        writer = write(parameters=parameters)
        tables = None
    checkpoints = Checkpoints(writer, settings.checkpoint_s, keeps_end=not backend.keeps_state)
    if not settings.resumed:
        checkpoints.remove()  # of the run that this one replaces
    print(f"history: {writer.sink.where}", flush=True)
    return Prepared(
        **vars(plan),
        writer=writer,
        state=state,
        resumed=tables,
        checkpoints=checkpoints,
        parameters=parameters,
        write=write,
    )


def announced(backend, make_wall, settings):
    """The RunPlan of a run, which is printed, and the path of its history; arguments and errors as
    of `prepare`."""
    wall = in_units(make_wall(), settings.units)
    wall.check_run(settings, backend.name)
    settings.check_plausible(wall)
    settings = settings.for_joint(wall.masonry.joint, backend.softening_beta_s)
    for plane_wall in wall.each_wall:
        backend.check(settings, plane_wall)
    out = settings.out or free_name(wall.masonry, settings, backend.name)
    if not settings.resumed:
        check_output(out, settings.overwrite)
        if settings.pictures:
            check_pictures(out, settings.overwrite)
    plan = plan_of(backend, wall, settings)
    announce(plan)
    return plan, out


def plan_of(backend, wall, settings):
    """The RunPlan of a run of settings that were checked; raises InputError."""
    wall = drawn(wall, ranges(settings.model.inputs), settings.model.strength_seed)
    layout = lay_out_building(wall, settings.model, scatter=settings.scatter, seed=settings.seed)
    if settings.joints_without_bond:
        layout = without_bond(layout, settings.joints_without_bond.joints(layout))
    if settings.settlement:
        settings.settlement.check_length(float(layout.ground.right.max()))
    modes = natural_modes(layout)
    settings = settings.for_period(float(modes.period_s[0]))
    options = schemes(settings, wall.masonry, modes)
    ((settings, time_step), *repeats), so_far = schemes_left(settings.resumed, options)
    check_size(settings, layout, time_step)
    check_top(settings, layout, time_step)
    return RunPlan(
        backend=backend,
        settings=settings,
        layout=layout,
        modes=modes,
        time_step=time_step,
        repeats=tuple(repeats),
        so_far=so_far,
    )
