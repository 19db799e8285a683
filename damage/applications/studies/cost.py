"""What runs of a study cost, in contact points times steps; nothing runs."""

from functools import cache

from damage.applications.studies.folder import ROOT
from damage.applications.studies.tasks import company_of
from damage.errors import InputError
from damage.house.coarser import in_units
from damage.house.house import load_wall_or_house
from damage.reference.session import BACKEND
from damage.run.prepare import plan_of
from damage.run.schedule import sample_steps, settlement_work, stages, zero_step
from damage.run.settings import SELECTIVE

LIVES = 8
"""Whose motions say how long one is."""
OVERHEAD = 500
"""Contact points that what a step takes besides counts for."""
SCALED = 4.0
"""Explicit steps that a step with scaled masses takes the time of."""
RUN = 6e7
"""Cost of a run before and after its steps, in contact points times steps that take as long."""
DRAWING = 7e8
"""Cost of the pictures of a run, in the same unit."""
TABLES = 2e8
"""Cost of the tables of a study, in the same unit."""


@cache
def cost_of(run):
    """Contact points times steps of a run of a StudyRun, 0 where that is not known."""
    try:
        contact_points, _, steps = size_of(run)
    except InputError:  # which the run itself will raise
        return 0.0
    return (contact_points + OVERHEAD) * steps


def size_of(run):
    """(Contact points of the wall, steps, explicit steps of a motion that take as long) of a run of
    a StudyRun; raises InputError.

    Motions of lives differ: the mean of the first LIVES.
    """
    lives = min(run.members, LIVES) if run.varied == "life" else 1
    settings = [run.settings(ROOT, number) for number in range(1, lives + 1)]
    layout, time_step, scaling = _built(run, settings[0])
    interval = sample_steps(time_step, scaling)
    schedules = [stages(setting, layout, time_step, interval) for setting in settings]
    steps = sum(schedule[-1].end_step for schedule in schedules) / lives
    more = settlement_work(layout.n_joints) - 1.0 if run.solver == "reference" else 0.0
    by = SCALED if scaling == SELECTIVE else 1.0
    return layout.n_joints, steps, by * (steps + more * zero_step(schedules[0]))


_BUILT = {}


def _built(run, settings):
    """(Layout, time step [s], mass scaling) of a run, the same of runs that can step together."""
    on_ground = settings.settlement is None
    key = run.wall, run.solver, company_of(run), settings.units, settings.mass_scaling, on_ground
    if key not in _BUILT:
        wall = in_units(load_wall_or_house(ROOT / run.wall), settings.units)
        joint = wall.masonry.joint
        plan = plan_of(BACKEND, wall, settings.for_joint(joint, BACKEND.softening_beta_s))
        _BUILT[key] = plan.layout, plan.time_step, plan.settings.mass_scaling
    return _BUILT[key]
