"""Ensembles: walls with equal bricks and stiffnesses advance together, whatever their motions.

A wall stops where it takes a sample.  Walls that stop at the same step advance to it as members of
one batch; a wall that stops elsewhere advances by itself until the others can join it.  Results of
a wall do not depend on the others.
"""

from itertools import accumulate

from damage.reference.lanes import advance_together
from damage.run.cooperative import WAITED

LEAST_LANES = 5
"""Least number of walls with rigid bricks in a batch.  A batch computes eight SIMD lanes, however
many are in use: fewer walls are faster one by one, since a single wall takes a quarter of the time
of a batch with AVX-512 and a fifth with AVX2.  Of walls with deformable bricks two are enough."""


def move(asked):
    """Advance solvers, as `damage.run.cooperative.run_each`, those with equal bricks and
    stiffnesses in batches; returns WAITED for those that wait for others.

    asked: (ReferenceSolver, *numbers of steps) of each.
    """
    alike, failures = {}, {}
    for wall, *steps in asked:
        alike.setdefault(wall.lanes.kind, {})[wall] = steps
    for walls in alike.values():
        for group in _chosen(walls):
            try:
                failures |= zip(group, advance_together(list(group.items())))
            except Exception as error:  # the failure of each wall of the batch
                failures |= dict.fromkeys(group, error)
    return [failures.get(wall, WAITED) for wall, *_ in asked]


def _chosen(walls):
    """Batches to advance now, a list of {wall: numbers of steps}.

    walls: {wall: numbers of steps that it asks for}, of walls that can be in one batch.
    """
    least = LEAST_LANES if next(iter(walls)).layout.strain is None else 2
    if len(walls) < least:
        return [{wall: steps} for wall, steps in walls.items()]
    # Those that react to each sample, as on ground that settles, would make all others take single
    # samples, too.
    reacting = {wall: steps for wall, steps in walls.items() if len(steps) == 1}
    if 0 < len(reacting) < least:
        return [{wall: steps} for wall, steps in reacting.items()]
    # The walls with the earliest last stop come first, together with those that stop there, too;
    # the others wait.
    ends = {wall: list(accumulate(steps)) for wall, steps in walls.items()}
    stop = min(of_wall[-1] for of_wall in ends.values())
    group = {
        wall: walls[wall][: of_wall.index(stop) + 1]
        for wall, of_wall in ends.items()
        if stop in of_wall
    }
    if len(group) >= least:
        return [group]
    return [{wall: walls[wall][:1]} for wall in group]
