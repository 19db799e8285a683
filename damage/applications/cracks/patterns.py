"""Agreement of the crack patterns of two runs: the fractions skill score (FSS).

Two correct runs differ joint by joint, since rounding decides which of several neighbours fails.
The score therefore compares f and g, the cracked shares of the joint length of both runs in windows
that slide over the wall:

    FSS = 1 - sum (f - g)^2 / sum (f^2 + g^2),

It is 1 for equal patterns and 0 for patterns without overlap (Roberts and Lean 2008, Monthly
Weather Review 136, 78-97, doi:10.1175/2007MWR2123.1).  Two controls give its significance: the
score with the cracks of the second run permuted at random among its joints, and with its pattern
mirrored left to right.
"""

from typing import NamedTuple

import numpy as np

from damage.history.reader import History
from damage.index import THRESHOLD

WINDOW_M = 0.45
"""Side of the windows [m]: two bricks, six courses."""
STEP_M = 0.075
"""Distance between the centres of neighbouring windows [m]."""
SHUFFLES = 20
"""Random permutations of which the control is the mean."""
SIDES_MARGIN = 0.05
"""Margin [-] by which a score must exceed that of the mirrored pattern to distinguish left from
right."""


def compare_patterns(first: History, second: History) -> dict:
    """Fractions skill scores of two Histories of one wall at the end of their motions, a plain
    dictionary.

    broken: scores of the failed contact points; visible: of those that ever opened or slipped by
    more than 0.1 mm. Each is {"fss", "shuffled", "mirrored": scores [-], "tells_sides": whether the
    score distinguishes left from right}, all None where nothing has cracked in either run.
    window_m: side of the windows [m].

    >>> sorted(compare_patterns(history, history))
    ['broken', 'slip', 'visible', 'window_m']
    """
    places = places_of(first)
    others = places_of(second)
    return {
        **{
            what: places.scores(cracked(first, what), cracked(second, what), others)
            for what in ("broken", "visible")
        },
        "window_m": WINDOW_M,
        "slip": "displacement",
    }


def fractions_skill_score(f: np.ndarray, g: np.ndarray) -> float | None:
    """Fractions skill score 1 - sum (f - g)^2 / sum (f^2 + g^2) [-]; None where both are zero
    everywhere.

    f, g: (n_windows,) cracked shares of the joint length.

    >>> fractions_skill_score(np.array([0.5, 0.5]), np.array([0.5, 0.0]))
    0.6666666666666667
    """
    size = float(np.sum(f**2) + np.sum(g**2))
    return 1.0 - float(np.sum((f - g) ** 2)) / size if size > 0 else None


def cracked(history: History, what: str) -> np.ndarray:
    """Whether contact points are cracked at the end of the (last) motion, (n_joints,) bool.

    what: "broken" (failed), or "visible" (ever opened or slipped by more than 0.1 mm).

    >>> cracked(history, "opened").sum().item()
    3
    """
    moving = np.flatnonzero(history.series["stage"] == "motion")
    end = int(moving[-1]) + 1 if len(moving) else len(history.series)
    if what == "broken":
        return history.broken[end - 1]
    slipped = np.abs(history.offset_m[:end]) > THRESHOLD
    return ((history.opening_m[:end] > THRESHOLD) | slipped).any(axis=0)


def places_of(history: History) -> "Places":
    """The Places of the joints of a History."""
    joints = history.joints
    return Places(
        joints["x_m"].to_numpy(),
        joints["z_m"].to_numpy(),
        history.joint_length_m,
        (history.attributes["length_m"], history.attributes["height_m"]),
    )


class Places(NamedTuple):
    """Joints of a wall in windows: x, z, length (n_joints,) [m]; extent: length and height of the
    wall [m]."""

    x: np.ndarray
    z: np.ndarray
    length: np.ndarray
    extent: tuple[float, float]

    @property
    def mirrored(self) -> "Places":
        """The Places with left and right exchanged."""
        return self._replace(x=self.extent[0] - self.x)

    def sums(self, values: np.ndarray) -> np.ndarray:
        """Sums (k, n_windows) over each window of values (k, n_joints)."""
        across, up = map(_inside, (self.x, self.z), self.extent)
        sums = [
            np.einsum("ap,bp,p->ab", across, up, value, optimize=True).ravel() for value in values
        ]
        return np.array(sums)

    def fractions(self, flags: np.ndarray) -> np.ndarray:
        """Share of the joint length that is flagged in each window, (n_windows,) [-]; zero in
        windows without joints; flags: (n_joints,) bool."""
        in_all, in_cracks = self.sums(np.array([self.length, self.length * flags]))
        return np.divide(in_cracks, in_all, out=np.zeros_like(in_all), where=in_all > 0)

    def scores(self, first: np.ndarray, second: np.ndarray, others: "Places | None" = None) -> dict:
        """Fractions skill score of the flagged joints (n_joints,) of two patterns with its
        controls, as of `compare_patterns`; others: the Places of the second pattern, where they are
        not these."""
        here = self.fractions(first)
        others = others or self
        score = fractions_skill_score(here, others.fractions(second))
        if score is None:
            return {"fss": None, "shuffled": None, "mirrored": None, "tells_sides": None}
        random = np.random.default_rng(0)
        shuffled = [
            fractions_skill_score(here, others.fractions(random.permutation(second)))
            for _ in range(SHUFFLES)
        ]
        mirrored = fractions_skill_score(here, others.mirrored.fractions(second))
        return {
            "fss": score,
            "shuffled": float(np.mean(np.array(shuffled, float))),
            "mirrored": mirrored,
            "tells_sides": bool(mirrored < score - SIDES_MARGIN),
        }


def _inside(places, extent):
    """Whether places [m] lie in windows along one axis, (n_windows, n_places) of 0 and 1; extent:
    of the wall [m]."""
    middles = np.arange(STEP_M / 2, extent, STEP_M)
    return (np.abs(places - middles[:, None]) <= WINDOW_M / 2 + 1e-9).astype(float)


def describe_patterns(result: dict) -> list[str]:
    """The result of `compare_patterns` as text, a list of lines."""
    return [
        f"pattern of {joints} at the end of the motion: {in_words(result[what])}"
        for what, joints in (
            ("broken", "failed joints"),
            ("visible", "joints that opened or slipped by 0.1 mm"),
        )
    ]


def in_words(scores: dict) -> str:
    """Scores of `Places.scores` as text."""
    if scores["fss"] is None:
        return "none in either run"
    sides = "" if scores["tells_sides"] else "; the score does not distinguish sides"
    return (
        f"FSS {scores['fss']:.2f} (controls: shuffled {scores['shuffled']:.2f}, mirrored "
        f"{scores['mirrored']:.2f}{sides})"
    )
