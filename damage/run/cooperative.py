"""Runs that step together: each yields the steps that its solver has to take; then the solvers take
them."""

import math

import numpy as np

WAITED = "waited"
"""Mark of steps that were not taken yet: they are to be asked for again."""


def run_each(asked):
    """Let solvers take steps, one after the other; returns for each None, or the error that ended
    it.

    asked: (solver, *numbers of steps) of each.
    """
    failures = [None] * len(asked)
    for number, (solver, *steps) in enumerate(asked):
        try:
            solver.run(*steps)
        except Exception as error:
            failures[number] = error
    return failures


@np.errstate(over="ignore", invalid="ignore")  # a run that blows up says so itself
def to_its_end(run):
    """Let a run, as of `as_they_end`, continue until it has ended; returns what it returned."""
    ((_, value),) = as_they_end([run])
    return value


def as_they_end(runs, move=run_each, most=math.inf):
    """Let runs continue, so many at once, the next where one has ended; yields (number, what it
    returned) of each.

    runs: generators of what `run_each` takes, as `damage.run.session.simulate`: what is to be taken
    before a run continues, at least the first number of steps; an error in it is raised there.
    Instead of a run None: there is none now, which ends all where none is under way.  move: as
    `run_each`, takes steps of those that are under way; or WAITED, where it leaves one for later.
    """
    # {(number, run): what it asks for}
    waiting = enumerate(runs)
    asked = {}
    while True:
        while len(asked) < most and (begun := next(waiting, (None, None)))[1] is not None:
            asked[begun] = None
            yield from _go_on(asked, begun, None)
        if not asked:
            return
        for run, failure in zip(list(asked), move(list(asked.values()))):
            if failure is not WAITED:
                yield from _go_on(asked, run, failure)


def _go_on(asked, key, failure):
    """Let the run of a key of `asked` continue up to what it asks for next; yields its end where it
    has come to it."""
    number, run = key
    try:
        asked[key] = next(run) if failure is None else run.throw(failure)
    except StopIteration as end:
        del asked[key]
        yield number, end.value
