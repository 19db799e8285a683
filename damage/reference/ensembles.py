"""Ensembles: walls with equal bricks advance together, whatever their motions, joints and time
steps.

Members of a batch advance until one has taken the steps that its run asked for; it is asked for the
next ones, and the others go on.  Results of a wall do not depend on the others.
"""

import numpy as np

from damage.mechanics.simd import WIDTH
from damage.mechanics.tables import HAS_FAILED
from damage.memory import cache_bytes
from damage.reference.lanes import advance_together
from damage.run.cooperative import WAITED

LEAST_LANES = 5
"""Least number of walls with rigid bricks in a batch.  A batch computes eight SIMD lanes, however
many are in use: fewer walls are faster one by one, since a single wall takes a quarter of the time
of a batch with AVX-512 and a fifth with AVX2.  Of walls with mass scaling of all joints three are
enough, of deformable bricks two: of one wall each body is moved by itself."""
OF_CACHE = 0.6
"""Share of its cache that a batch may take.  In two processes that share 32 MB, batches of walls of
6200 contact points, with up to 9 MB a step, take 0.8 of the time that the walls take one by one; of
12 300 contact points, with 12 to 15 MB, 1.8 of it."""


def move(asked, processes=1):
    """Advance solvers, as `damage.run.cooperative.run_each`, those with equal bricks in batches
    that the cache can hold; returns WAITED for those that have steps left.

    asked: (ReferenceSolver, *numbers of steps) of each; processes: that do so at once.
    """
    room = OF_CACHE * cache_bytes(processes)
    alike = {}
    failures = {}
    for wall, *steps in asked:
        alike.setdefault(wall.lanes.kind, {})[wall] = steps
    for walls in alike.values():
        for group in _one_by_one(walls) if exceeds(walls, room) else _chosen(walls):
            try:
                failures |= zip(group, advance_together(list(group.items())))
            except Exception as error:  # the failure of each wall of the batch
                failures |= dict.fromkeys(group, error)
    return [failures.get(wall, WAITED) for wall, *_ in asked]


def exceeds(walls, room):
    """Whether a step of a batch of these walls with rigid bricks goes through more memory than that
    [bytes]: bodies and interfaces of all, and contact points of the interfaces that have failed in
    any.  A wall by itself takes many steps before the next one does."""
    wall = next(iter(walls))
    tables = wall.lanes.tables

    def of_batch(*names):
        return WIDTH // tables.bench.shape[2] * sum(getattr(tables, name).nbytes for name in names)

    room -= of_batch("bodies", "inertia", "limits", "last")
    points = of_batch("strengths", "states")
    if points < room or wall.layout.strain is not None:
        return False
    failed = [wall.system.limits[:, HAS_FAILED] > 0 for wall in walls]
    return np.any(failed, axis=0).mean() * points > room


def _one_by_one(walls):
    return [{wall: steps} for wall, steps in walls.items()]


def _least(wall):
    """LEAST_LANES of walls alike."""
    if wall.layout.strain is not None:
        return 2
    return 3 if wall.mass and not wall.mass.matrix.alone else LEAST_LANES


def _chosen(walls):
    """Batches to advance now, a list of {wall: numbers of steps}.

    walls: {wall: numbers of steps that it asks for}, of walls that can be in one batch.
    """
    least = _least(next(iter(walls)))
    if len(walls) < least:
        return _one_by_one(walls)
    # Those that react to each sample, as on ground that settles, would make all others take few
    # steps at once, too: they go first, and together where they have equally many left.
    reacting = {}
    others = {}
    for wall, steps in walls.items():
        alike = reacting.setdefault(steps[0] - wall.taken, {}) if len(steps) == 1 else others
        alike[wall] = steps
    if few := [group for group in reacting.values() if len(group) < least]:
        return [{wall: steps} for group in few for wall, steps in group.items()]
    first, *more = [*reacting.values()] or [{}]
    return [first | others, *more]
