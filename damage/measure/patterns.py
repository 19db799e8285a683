"""Do two runs crack in the same places?  The fractions skill score of their crack patterns.

Joint by joint correct runs differ: which of several neighbours breaks is a matter of rounding.  So shares are
compared: f and g, the cracked share of the joint length in windows that slide over the wall,

    FSS = 1 - sum (f - g)^2 / sum (f^2 + g^2),

1 for equal patterns and 0 for patterns without overlap (Roberts and Lean 2008, Monthly Weather Review 136, 78-97,
doi:10.1175/2007MWR2123.1).  Controls show what a score is worth: the second run's cracks shuffled among its
joints, and mirrored left to right.
"""

import numpy as np

from damage.index import THRESHOLD

WINDOW_M = 0.45
"""Side of the windows [m]: two bricks, six courses."""
STEP_M = 0.075
"""Between the middles of two windows [m]."""
SHUFFLES = 20
SIDES_MARGIN = 0.05
"""A mirror image that scores within so much of the pair: the score does not distinguish sides."""


def compare_patterns(first, second):
    """Scores of two Histories of one wall at the end of their motions, None where nothing has cracked in either:
    {"broken", "visible": {"fss", "shuffled", "mirrored": number, "tells_sides": bool}, "window_m"}.

    broken: joints whose bond has failed; visible: that opened or slipped by more than 0.1 mm, whatever they do then.
    slip: the criterion of both, `displacement` where both have offsets, and else `accumulated`.
    """
    slip = common_slip(first, second)
    return {**{what: _scores(first, second, what, slip) for what in ("broken", "visible")}, "window_m": WINDOW_M,
            "slip": slip}


def common_slip(*histories):
    """The criterion of slip by which Histories can be compared: `displacement` where all have offsets."""
    return "accumulated" if any(history.offset_m is None for history in histories) else "displacement"


def fractions_skill_score(f, g):
    """1 - sum (f - g)^2 / sum (f^2 + g^2), None where both are zero throughout.

    >>> fractions_skill_score(np.array([0.5, 0.5]), np.array([0.5, 0.0]))
    0.6666666666666667
    """
    size = float(np.sum(f**2) + np.sum(g**2))
    return 1.0 - float(np.sum((f - g) ** 2)) / size if size > 0 else None


def cracked(history, what, slip="displacement"):
    """Which joints are cracked at the end of the (last) motion, bool (n_joints,); what: "broken" or "visible"."""
    moving = np.flatnonzero(history.series["stage"] == "motion")
    end = int(moving[-1]) + 1 if len(moving) else len(history.series)
    if what == "broken":
        return history.broken[end - 1]
    slipped = np.abs(history.slip_by(slip)[:end]) > THRESHOLD
    return ((history.opening_m[:end] > THRESHOLD) | slipped).any(axis=0)


def fractions(history, flags, mirrored=False):
    """Share of the joint length with these flags in each window, (n_windows,); zero in windows without joints.

    mirrored: with left and right exchanged.
    """
    joints, extent = history.joints, (history.attributes["length_m"], history.attributes["height_m"])
    x, z, length = joints["x_m"].to_numpy(), joints["z_m"].to_numpy(), history.joint_length_m
    if mirrored:
        x = extent[0] - x
    across, up = map(_inside, (x, z), extent)
    in_all, in_cracks = (np.einsum("ap,bp,p->ab", across, up, weight, optimize=True) for weight in
                         (length, length * flags))
    return np.divide(in_cracks, in_all, out=np.zeros_like(in_all), where=in_all > 0).ravel()


def _inside(places, extent):
    """Which places lie in the windows along one axis, (n_windows, n_places) of 0 and 1."""
    middles = np.arange(STEP_M / 2, extent, STEP_M)
    return (np.abs(places - middles[:, None]) <= WINDOW_M / 2 + 1e-9).astype(float)


def _scores(first, second, what, slip):
    here, flags = fractions(first, cracked(first, what, slip)), cracked(second, what, slip)
    score = fractions_skill_score(here, fractions(second, flags))
    if score is None:
        return {"fss": None, "shuffled": None, "mirrored": None, "tells_sides": None}
    random = np.random.default_rng(0)
    shuffled = [fractions_skill_score(here, fractions(second, random.permutation(flags))) for _ in range(SHUFFLES)]
    mirrored = fractions_skill_score(here, fractions(second, flags, mirrored=True))
    return {"fss": score, "shuffled": float(np.mean(shuffled)), "mirrored": mirrored,
            "tells_sides": bool(mirrored < score - SIDES_MARGIN)}


def describe_patterns(result):
    """The result of `compare_patterns` as lines of text."""
    lines = []
    for what, words in (("broken", "broken joints"), ("visible", "joints that opened or slipped by 0.1 mm")):
        scores = result[what]
        if scores["fss"] is None:
            lines.append(f"pattern of {words} at the end of the motion: none in either run")
            continue
        sides = "" if scores["tells_sides"] else "; the score does not distinguish sides"
        lines.append(f"pattern of {words} at the end of the motion: FSS {scores['fss']:.2f} (controls: shuffled "
                     f"{scores['shuffled']:.2f}, mirrored {scores['mirrored']:.2f}{sides})")
    return lines
