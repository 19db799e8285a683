"""What a study has to do: a task for each run, and for the pictures of the first run of each
point."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from damage.applications.cracks import at_rest
from damage.applications.studies.definition import StudyRun
from damage.applications.studies.folder import ROOT
from damage.run.checkpoint import checkpoint_path

CHANGED = -1
"""In place of an exit status: the run was not made, as its inputs changed since the study began."""
YADE = 200
"""For how many runs of the reference solver one in YADE counts."""


@dataclass(frozen=True)
class Task:
    """The run with this number of a point, or its pictures; keeps_history: whether its history
    stays; patterns: whether those at rest do (`damage.applications.cracks.at_rest`); tables:
    whether it has tables of its own; draws: whether it makes the pictures; alone: whether its
    process does nothing else meanwhile.

    Paths: history: where it is in the end; part: where it grows, as a file with the name of a
    history is a whole one; pattern: of its patterns at rest; pictures: their folder; log: what a
    process that does this prints.
    """

    folder: Path
    point: StudyRun
    number: int
    keeps_history: bool
    patterns: bool = False
    tables: bool = False
    draws: bool = False
    alone: bool = False

    @property
    def name(self):
        return self.point.name(self.number)

    @property
    def history(self):
        return self.folder / "runs" / f"{self.name}.h5"

    @property
    def part(self):
        return self.folder / "runs" / f"{self.name}.part.h5"

    @property
    def pattern(self):
        return self.folder / at_rest.FOLDER / f"{self.name}{at_rest.ENDING}"

    @property
    def pictures(self):
        return self.folder / "pictures" / self.name

    @property
    def log(self):
        name = f"{self.name}_pictures" if self.draws else self.name
        return self.folder / "logs" / f"{'reference' if self.steps else name}.log"

    @property
    def stands(self):
        """Whether it is a run that was interrupted, and can continue from there."""
        return self.steps and self.part.is_file() and checkpoint_path(self.part).is_file()

    @property
    def place(self):
        """Options of its run beside those of its point."""
        stands = self.stands
        place = {"resume" if stands else "out": str(self.part)}
        return place | {"overwrite": not stands, "pictures": False}

    def settings(self, prog):
        """RunSettings of its run, whose paths start from the working folder."""
        return self.point.settings(number=self.number, prog=prog, more=self.place)

    @property
    def steps(self):
        """Whether it is a run of the reference solver, up to eight of which share a process."""
        return not self.draws and self.point.solver == "reference"


@cache
def company_of(point):
    """Properties that runs share which step together from beginning to end, of all runs of a
    point; None of YADE's."""
    if point.solver != "reference":
        return None
    settings = point.settings(ROOT)
    return (
        point.wall,
        replace(settings.model, strength_seed=0),
        settings.time_step_s,
        settings.alpha_1_s,
        settings.beta_s,
    )


@cache
def batch_of(point):
    """Properties without which runs cannot be in one batch, as their bricks, or the masses that
    are scaled, differ; of all runs of a point."""
    return point.wall, point.settings(ROOT).settlement is None


def slices(runs, n):
    """Lists of the StudyRuns of n slices, of about as many runs each; neighbours, which are alike,
    stay together."""
    weights = np.array(
        [run.most_members * (1 if run.solver == "reference" else YADE) for run in runs], float
    )
    place = np.minimum((np.cumsum(weights) - weights / 2) * n / weights.sum(), n - 1).astype(int)
    return [[run for run, here in zip(runs, place) if here == k] for k in range(n)]


class Point:
    """A point on its way: records, {number: record} of its runs that are done, and which tasks were
    handed out."""

    def __init__(self, run, results, keep, pictures):
        """results: `damage.applications.studies.outdated.Results` of the folder; keep: as of
        `damage.applications.studies.batch.run`; pictures: whether those of its first run are
        made."""
        self.run = run
        self._folder = results.folder
        self._keep = keep
        self.pictures = pictures
        self._asked = set()
        self._drawing = False
        self.records = {
            number: record
            for number, record in results.records.of_point(run).items()
            if results.is_whole(self._task(number))
        }

    def _task(self, number):
        return Task(
            folder=self._folder,
            point=self.run,
            number=number,
            keeps_history=self._keep == "all" or number == 1,
            patterns=self._keep == "patterns",
            tables=self._keep == "all" and number == 1,
        )

    @property
    def _needed(self):
        """Numbers of the runs that the results so far ask for, a set."""
        return set(range(1, self.run.runs_needed(self.records) + 1))

    @property
    def done(self):
        """Whether all of its runs are done."""
        return self._needed <= self.records.keys()

    @property
    def is_drawn(self):
        """Whether the pictures of its first run are there."""
        return self._task(1).pictures.is_dir()

    def next_tasks(self):
        """The tasks that the results so far ask for and that were not handed out yet: runs, and the
        pictures of the first once it is done."""
        numbers = self._needed - self.records.keys() - self._asked
        self._asked |= numbers
        tasks = [self._task(number) for number in sorted(numbers)]
        if self.pictures and 1 in self.records and not (self._drawing or self.is_drawn):
            self._drawing = True
            tasks.append(replace(self._task(1), draws=True))
        return tasks
