"""YADE as the Backend of a run."""

from pathlib import Path

import yade
from yade import O

from damage.errors import InputError
from damage.run.prepare import Backend
from yade_scripts.joint_tracker import check_law
from yade_scripts.opened import Scene, name_of, prompt
from yade_scripts.solver import YadeSolver
from yade_scripts.view import open_view


def backend_with(engines):
    """The Backend of YADE with these engines beside the wall's own."""
    versions = {"yade": yade.config.version}
    if engines:
        versions["yade_engines"] = ", ".join(map(name_of, engines))  # they may have moved the wall

    def make(layout, time_step, settings):
        solver = YadeSolver(layout, time_step)
        Scene(layout, solver, settings.console)
        # at the end of a step positions and forces are of the same time
        O.engines = [*O.engines, *engines]
        return solver

    def begins(run):
        scene = Scene.current
        scene.run = run
        if scene.console == "before":
            prompt(scene, "before", "; the run follows")
        return scene.changed_by_hand()

    return Backend(
        name="yade",
        versions=versions,
        make=make,
        code=Path(__file__).parent,
        check=_check,
        open_view=open_view,
        softening_beta_s=0.0,
        keeps_state=False,
        begins=begins,
    )


def _check(settings, wall):
    check_law(wall.joint)
    if settings.model.has_modes:
        raise InputError(
            "--bricks deformable: YADE moves rigid bodies, without strain modes; leave it out, or"
            " use the reference solver: python3 -m damage reference"
        )
    if settings.beta_s:
        raise InputError(
            f"--beta {settings.beta_s:g}: YADE's joint law has no viscous damping; leave it out, or"
            " use the reference solver: python3 -m damage reference"
        )
