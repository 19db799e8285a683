"""Figures of five documents, drawn from docs/tables and, of contact points, from the layout of a
small wall.

    python3 -m paper document_figures [FOLDER]      # by default docs/pictures

writes thirty_years.png (docs/paper/thirty-years.md), settled_walls.png
(docs/paper/settled-walls.md), after_the_peak.png (docs/validation/after-the-peak.md),
shaken_walls.png (docs/validation/shaken-walls.md) and model_contact_points.png
(docs/model/model.md).
"""

import re
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle

from damage.draw.panels import add_heading, finish, grid, letter
from damage.draw.style import (
    BLACK,
    BLUE,
    BRICK_COLOUR,
    DARK,
    GREEN,
    LIGHT,
    MEDIUM,
    ORANGE,
    SKY,
    VERMILLION,
    save_picture,
    styled,
)
from damage.wall.file import load_wall
from damage.wall.kinds import BED, HEAD
from damage.wall.kinematics import ContactKinematics, rigid_displacement
from damage.wall.layout import lay_out
from damage.wall.parameters import Wall
from paper.bench import REPOSITORY, arguments, option
from paper.lives_walls import ADDRESSES, WALLS

TABLES = REPOSITORY / "docs" / "tables"
WIDTH = 150 / 25.4  # [inch], of a page of text

# --- thirty years ---------------------------------------------------------------------------------

GROUND = {
    "at rest": (BLUE, "o", "none", -0.18, "ground at rest before the first earthquake"),
    "settled": (ORANGE, "s", ORANGE, 0.18, "ground settled before it (hogging by 1/4000)"),
}


@styled
def thirty_years():
    """P(Psi >= 1) after the last earthquake by wall, joints and ground before: a panel for each
    address."""
    table = pd.read_csv(TABLES / "benchmarks" / "lives_walls.csv", dtype=str)
    lives = pd.read_csv(TABLES / "lives_walls" / "lives.csv", comment="#")
    figure, axes = grid(1, len(ADDRESSES), 2.1, WIDTH, sharey=True)
    for number, (ax, address) in enumerate(zip(axes.flat, ADDRESSES)):
        of = lives[lives["point"] == f"soft_lintel2_{address}"].drop_duplicates(["seed", "life"])
        letter(ax, number, f"{address.capitalize()}, {of['largest_mm_s'].median():.0f} mm/s")
        for ground, (colour, marker, face, shift, _) in GROUND.items():
            rows = table[table["ground before"] == ground].set_index("wall").loc[list(WALLS)]
            p, low, high = np.transpose(
                [interval(cell) for cell in rows[f"{address.capitalize()} [%]"]]
            )
            ax.errorbar(
                p,
                np.arange(len(p)) + shift,
                xerr=[p - low, high - p],
                ls="",
                marker=marker,
                ms=4,
                color=colour,
                mfc=face,
                elinewidth=1.0,
                capsize=2,
                clip_on=False,
            )
        for place in (1.5, 3.5):
            ax.axhline(place, color=LIGHT, lw=0.8)
        ax.set_xlim(0, 100)
        ax.set_ylim(len(WALLS) - 0.5, -0.5)
    names = [name.split(", ") for name in WALLS]
    axes[0, 0].set_yticks(range(len(WALLS)), labels=[f"{joints} joints" for _, joints in names])
    for place, (wall, _) in enumerate(names[::2]):
        _outline(axes[0, 0].inset_axes((-0.93, 0.72 - place / 3, 0.3, 0.24)), wall)
    axes[0, 1].set_xlabel("walls that end with visible cracks (Ψ ≥ 1) [%], 95 % interval")
    add_heading(
        figure,
        "Visible cracks after thirty years of earthquakes, 1991 to 2022, by wall and address",
        f"{len(of)} draws of motions and joint strengths a point; mm/s: largest peak ground"
        " velocity, median of the draws",
    )
    return finish(
        figure,
        [
            Line2D([], [], color=colour, marker=marker, mfc=face, ls="", ms=4, label=words)
            for colour, marker, face, _, words in GROUND.values()
        ],
    )


def _outline(ax, name):
    """Draw a wall that ships, with its name: a pictogram."""
    wall = load_wall(REPOSITORY / "walls" / f"{name}.py")
    ax.add_patch(Rectangle((0, 0), wall.length, wall.height, fc=MEDIUM, ec=DARK, lw=0.6))
    for opening in wall.openings:
        ax.add_patch(
            Rectangle(
                (opening.left, opening.sill),
                opening.width,
                opening.height,
                fc="white",
                ec=DARK,
                lw=0.6,
            )
        )
    ax.set(xlim=(-0.1, wall.length + 0.1), ylim=(-0.1, wall.height + 0.1), aspect="equal")
    ax.set_title(name, fontsize=6.5, pad=1.5)
    ax.set_axis_off()


def interval(text):
    """Probability and its bounds, of a cell of lives_walls.csv.

    >>> interval("20 (14 to 27)")
    [20.0, 14.0, 27.0]
    """
    return [float(number) for number in re.fullmatch(r"(\S+) \((\S+) to (\S+)\)", text).groups()]


# --- settled walls --------------------------------------------------------------------------------

CLASSES = {
    "undisturbed": (BLACK, "D", "at rest"),
    "invisible": (BLUE, "o", "hogged by 1/5000"),
    "about 0.5": (GREEN, "^", "hogged by about 1/4000"),
    "about 1": (ORANGE, "s", "hogged by 1/3700 to 1/2400"),
}
"""{class of docs/tables/cracks_before.csv: colour, marker, words}"""
BINS = 0.6, 0.7, 0.75, 0.85, 0.9, 0.95, 1.0, 1.25
"""Ends of the bins of Psi before the earthquake in which shares are counted."""
LEAST_PSI = 1.0
"""Least Psi of cracks that are visible."""
NOTHING_AT = {"undisturbed": -0.05, "invisible": 0.05}
"""Places, beside each other, of walls without a crack before: their Psi is zero."""
PUBLISHED_PSI = {"undisturbed": 0.0, "about 0.5": 0.5}
"""Psi of the walls whose share has been published."""


@styled
def settled_walls():
    """Psi after an earthquake of 10 mm/s over Psi before, of every run, and the share with visible
    cracks."""
    runs = pd.read_csv(TABLES / "cracks_before.csv")
    figure, axes = grid(1, 2, 2.2, WIDTH, sharex=True, width_ratios=(1.35, 1))
    left, right = axes.flat
    left.axhline(LEAST_PSI, color=VERMILLION, lw=0.8, ls="--")
    left.text(0.2, LEAST_PSI + 0.03, "visible cracks: Ψ ≥ 1", color=VERMILLION, fontsize=6.5)
    left.plot([0, 1.25], [0, 1.25], color=DARK, lw=0.8)
    left.text(
        0.45,
        0.42,
        "the earthquake adds nothing",
        color=DARK,
        fontsize=6.5,
        rotation=45,
        va="top",
        rotation_mode="anchor",
        transform_rotates_text=True,
    )
    spread = np.random.default_rng(1)
    for name, (colour, marker, _) in CLASSES.items():
        rows = runs[runs["class"] == name]
        before = (
            rows["psi_0"]
            if name not in NOTHING_AT
            else NOTHING_AT[name] + spread.uniform(-0.04, 0.04, len(rows))
        )
        left.plot(
            before,
            rows["psi_end"],
            ls="",
            marker=marker,
            ms=1.8,
            color=colour,
            mew=0,
            alpha=0.6,
            clip_on=False,
        )
    _shares(right, runs)
    titles = "Ψ of every run, from 0 spread sideways", "share of runs with visible cracks after it"
    for number, (ax, text) in enumerate(zip(axes.flat, titles)):
        letter(ax, number, text)
        ax.set_xlim(-0.12, 1.25)
        ax.set_xlabel("Ψ before the earthquake [-]")
    left.set_ylabel("Ψ after the earthquake [-]")
    left.set_ylim(0, 1.35)
    add_heading(
        figure,
        "What an earthquake of 10 mm/s adds to the cracks of a settled wall",
        f"{len(runs)} runs of the symmetric wall with softening joints; Ψ before: left by"
        " settlement of the ground",
    )
    handles = [
        Line2D([], [], color=colour, marker=marker, ls="", ms=3.5, label=f"ground {words}")
        for colour, marker, words in CLASSES.values()
    ]
    handles += [
        Line2D([], [], color=DARK, marker="_", mew=1.5, ms=8, ls="", label="share of these runs"),
        Line2D(
            [], [], color=VERMILLION, marker="x", ls="", ms=4, label="published share, other walls"
        ),
    ]
    return finish(figure, handles, 3)


def _shares(ax, runs):
    """Share of runs with visible cracks after the earthquake: by class where none was before, else
    by bins of Psi."""
    visible = 100.0 * (runs["psi_end"] >= LEAST_PSI)
    spans = [
        (runs["class"] == name, place - 0.04, place + 0.04) for name, place in NOTHING_AT.items()
    ]
    spans += [
        ((runs["psi_0"] >= low) & (runs["psi_0"] < high), low, high)
        for low, high in zip(BINS, BINS[1:])
    ]
    for which, low, high in spans:
        ax.plot(
            [low, high],
            [visible[which].mean()] * 2,
            color=DARK,
            lw=2.2,
            zorder=3,
            solid_capstyle="butt",
            clip_on=False,
        )
    published = pd.read_csv(TABLES / "benchmarks" / "settled_psi.csv").set_index("class of Ψ₀")[
        "published [%]"
    ]
    ax.plot(
        list(PUBLISHED_PSI.values()),
        published[list(PUBLISHED_PSI)],
        ls="",
        marker="x",
        color=VERMILLION,
        ms=4.5,
        mew=1.2,
    )
    ax.set_ylim(0, 100)
    ax.set_ylabel("runs with Ψ ≥ 1 [%]")


# --- after the peak -------------------------------------------------------------------------------

FORCES = {"xscale": "log", "xlim": (0.6, 1.8), "xticks": (0.75, 1, 1.5)}
DRIFTS = {"xscale": "log", "xlim": (0.11, 8), "xticks": (0.25, 1, 4)}
COMPARED = {
    "peak [kN]": ("peak force", FORCES),
    "bilinear [kN]": ("bilinear force", FORCES),
    "ultimate drift [%]": ("ultimate drift", DRIFTS),
}
LOADED = {
    "pushed": (BLUE, "o", "none", -0.14, "pushed, two draws of the joints' strengths"),
    "cycles": (ORANGE, "s", ORANGE, 0.14, "cycles, one draw"),
}


@styled
def after_the_peak():
    """Force and ultimate drift of the prediction over those of the test, by wall: a panel for each
    quantity."""
    rows = predicted()
    walls = rows.drop_duplicates("wall")
    names = (
        walls["wall"].str.removeprefix("ABRAMS_") + ", " + walls["mode"].str.replace(" and ", " + ")
    )
    figure, axes = grid(1, len(COMPARED), 2.6, WIDTH, sharey=True)
    for number, (ax, (column, (words, scale))) in enumerate(zip(axes.flat, COMPARED.items())):
        letter(ax, number, words)
        ax.axvspan(1 / 1.15, 1.15, color=LIGHT, lw=0)
        ax.axvline(1.0, color=DARK, lw=0.8)
        for how, (colour, marker, face, shift, _) in LOADED.items():
            of = rows[rows["how"] == how]
            place = of["wall"].map(dict(zip(walls["wall"], range(len(walls))))) + shift
            ends = of[column].str.startswith("over ")
            ratio = of[column].str.removeprefix("over ").astype(float) / of[
                f"test ({column})"
            ].astype(float)
            for which, sign in ((~ends, marker), (ends, ">")):
                ax.plot(
                    ratio[which], place[which], ls="", marker=sign, ms=4, color=colour, mfc=face
                )
        for place in np.flatnonzero(np.diff(walls["group"])):
            ax.axhline(place + 0.5, color=LIGHT, lw=0.8)
        ax.set(**scale, xticklabels=map(str, scale["xticks"]), ylim=(len(walls) - 0.5, -0.5))
        ax.minorticks_off()
    axes[0, 0].set_yticks(range(len(walls)), labels=names)
    axes[0, 1].set_xlabel("prediction over test [-]; grey: within 15 %")
    add_heading(
        figure,
        "Prediction over test for twelve walls, each with its failure in the test",
        "above: EUCENTRE's walls, first the four known when options were chosen; below: other"
        " laboratories'",
    )
    handles = [
        Line2D([], [], color=colour, marker=marker, mfc=face, ls="", ms=4, label=words)
        for colour, marker, face, _, words in LOADED.values()
    ]
    return finish(
        figure,
        [
            *handles,
            Line2D(
                [],
                [],
                color=DARK,
                marker=">",
                mfc="none",
                ls="",
                ms=4,
                label="pushed, force still over 0.8 of the peak",
            ),
        ],
        2,
    )


def predicted():
    """Rows of the tables of the prediction: wall, how it was loaded, mode in the test, its group,
    COMPARED of both."""
    tables = []
    for group, name in enumerate(("", "_cycles", "_unseen", "_elsewhere")):
        table = pd.read_csv(TABLES / "benchmarks" / f"after_peak{name}.csv", dtype=str)
        table = table[table["law"] != "rule"].rename(
            columns={"test": f"test ({next(iter(COMPARED))})"}
        )
        cycled = name == "_cycles" or table["law"].eq("cycles")
        tables.append(
            table.assign(
                group=max(0, group - 1),
                how=np.where(cycled, "cycles", "pushed"),
                mode=table["test (failure (on stairs))"],
            )
        )
    return pd.concat(tables)


# --- contact points -------------------------------------------------------------------------------

MOTION = {"a": (0.0, 0.0, 0.0), "b": (0.03, 0.05, np.radians(12.0))}
"""Displacement x, z [m] and rotation of two bricks in the second panel, larger than any real
one."""


@styled
def model_contact_points():
    """Contact points of three bricks of two courses; opening and shear displacement of one of
    them."""
    layout, bricks, point = two_courses()
    figure, axes = grid(1, 2, 1.6, WIDTH, width_ratios=(0.47, 0.395))
    _bricks_at_rest(axes[0, 0], layout.bodies, layout.contacts, bricks, point)
    _bricks_moved(axes[0, 1], layout, {name: bricks[name] for name in MOTION}, point)
    for number, (ax, text) in enumerate(
        zip(
            axes.flat,
            ("at rest: contact points of bricks a, b, c", "b moved: displacements of one point"),
        )
    ):
        ax.set(aspect="equal", ylim=(-0.005, 0.24), xlim=((-0.005, 0.465), (-0.005, 0.39))[number])
        ax.set_axis_off()
        letter(ax, number, text)
    return figure


def two_courses():
    """Layout of a wall of two courses, {name: whole brick}, and the first contact point of a and b,
    which lies on a."""
    layout = lay_out(Wall("two_courses", length=0.45, height=0.15, precompression=0.0))
    bodies, contacts = layout.bodies, layout.contacts
    whole = np.isclose(bodies.length, bodies.length.max()) & (bodies.course >= 0)
    bricks = dict(zip("acb", np.flatnonzero(whole)))  # course by course, from left to right
    return (
        layout,
        bricks,
        np.flatnonzero((contacts.first == bricks["a"]) & (contacts.second == bricks["b"]))[0],
    )


def _bricks(ax, bodies, bricks, motions):
    """Draw bricks, {name: body}, with their centres, after motions {name: (x, z, rotation)} of
    those that move."""
    for name, body in bricks.items():
        half = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [
            bodies.length[body] / 2,
            bodies.height[body] / 2,
        ]
        moved = np.transpose(rigid_displacement(*motions.get(name, (0.0, 0.0, 0.0)), *half.T))
        corners = half + moved + [bodies.x[body], bodies.z[body]]
        ax.add_patch(Polygon(corners, fc=BRICK_COLOUR, ec=MEDIUM, lw=0.8))
        ax.plot(*corners.mean(axis=0), marker="+", color=BLACK, ms=6, mew=1)
        ax.annotate(
            name,
            corners.mean(axis=0),
            (0, -9),
            textcoords="offset points",
            ha="center",
            style="italic",
        )
    ax.autoscale_view()


def _arrow(ax, start, end, colour, text, shift):
    """An arrow between two points [m], and a text beside its middle; shift in points."""
    ax.annotate(
        "",
        end,
        start,
        arrowprops={
            "arrowstyle": "-|>",
            "color": colour,
            "lw": 1.0,
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 7,
        },
    )
    ax.annotate(
        text,
        np.mean([start, end], axis=0),
        shift,
        textcoords="offset points",
        color=colour,
        ha="center",
        va="center",
    )


def _bricks_at_rest(ax, bodies, contacts, bricks, point):
    """First panel: all contact points, one with its tributary length and its arms, and the normals
    of both joints."""
    _bricks(ax, bodies, bricks, {})
    inside = (
        np.isin(contacts.kind, (BED, HEAD))
        & np.isin(contacts.first, list(bricks.values()))
        & np.isin(contacts.second, list(bricks.values()))
    )
    place, half = np.array([contacts.x[point], contacts.z[point]]), contacts.length[point] / 2
    ax.plot(
        place[0] + np.array([-half, half]),
        [place[1]] * 2,
        color=SKY,
        lw=4,
        solid_capstyle="butt",
        zorder=3,
    )
    ax.annotate(
        "tributary length", place, (-13, 12), textcoords="offset points", color=BLUE, ha="right"
    )
    for name, shift in (("a", (-6, 4)), ("b", (0, 7))):
        body = bricks[name]
        _arrow(ax, (bodies.x[body], bodies.z[body]), place, BLUE, f"$r_{name}$", shift)
    ax.plot(
        contacts.x[inside],
        contacts.z[inside],
        ls="",
        marker="o",
        ms=4,
        mfc="white",
        color=BLACK,
        zorder=5,
    )
    for kind, along, text, shift in (
        (BED, (0.0, 0.035), "bed joint", (24, 6)),
        (HEAD, (0.035, 0.0), "head joint", (24, 8)),
    ):
        last = np.flatnonzero(inside & (contacts.kind == kind))[-1]
        start = np.array([contacts.x[last], contacts.z[last]])
        _arrow(ax, start, start + along, VERMILLION, f"{text}: $n$", shift)


def _bricks_moved(ax, layout, bricks, point):
    """Second panel: the contact point of each of two bricks, and its opening and shear displacement
    between them."""
    _bricks(ax, layout.bodies, bricks, MOTION)
    centres, ends, shear, opening = places_of(layout, bricks, point)
    for along in (shear, opening):  # the joint's axes
        axis = along / np.linalg.norm(along)
        ax.plot(
            *np.transpose([ends["a"] - 0.02 * axis, ends["a"] + 0.085 * axis]),
            color=MEDIUM,
            lw=0.7,
            ls="--",
        )
    for name, shift in (("a", (-6, 4)), ("b", (0, 7))):
        _arrow(ax, centres[name], ends[name], BLUE, f"$r_{name}$", shift)
    _arrow(ax, ends["a"], ends["a"] + shear, VERMILLION, "$u_s$", (2, -6))
    _arrow(ax, ends["a"] + shear, ends["a"] + shear + opening, VERMILLION, "$u_n$", (8, 0))
    for of in ends.values():
        ax.plot(*of, ls="", marker="o", ms=4, mfc="white", color=BLACK, zorder=5)


def places_of(layout, bricks, point):
    """Of a contact point of a bed joint after MOTION: {brick: its centre}, {brick: the point's
    place in it}, and the vectors of shear displacement and opening of `ContactKinematics`, each
    (2,) [m]."""
    bodies, contacts = layout.bodies, layout.contacts
    motion, centres, ends = np.zeros((len(bodies), 3)), {}, {}
    for name, body in bricks.items():
        motion[body] = MOTION[name]
        arm = np.array([contacts.x[point] - bodies.x[body], contacts.z[point] - bodies.z[body]])
        centres[name] = np.array([bodies.x[body], bodies.z[body]]) + MOTION[name][:2]
        ends[name] = centres[name] + arm + rigid_displacement(0.0, 0.0, MOTION[name][2], *arm)
    (opening,), (shear,) = ContactKinematics(layout).displacements(motion, [point])
    mean = np.mean([of[2] for of in MOTION.values()])
    return (
        centres,
        ends,
        shear * np.array([np.cos(mean), np.sin(mean)]),
        opening * np.array([-np.sin(mean), np.cos(mean)]),
    )


# --- shaken walls ---------------------------------------------------------------------------------


@styled
def shaken_walls():
    """Peaks of the wall US-1 by run with both bearings, and the force that clay spandrels keep by
    repetition."""
    runs = pd.read_csv(TABLES / "benchmarks" / "us1_heights.csv")
    figure, axes = grid(1, 2, 2.2, WIDTH, width_ratios=(1.35, 1))
    left, right = axes.flat
    letter(left, 0, "US-1, largest displacement at 2.06 m [mm]")
    for name, marker, color, face in (
        ("tested", "o", ORANGE, ORANGE),
        ("first", "x", SKY, SKY),
        ("later", "s", BLUE, "none"),
    ):
        peak = runs[f"{name}_peak_mm_2060"]
        left.plot(runs["run"], peak, ls="", marker=marker, ms=3.5, mfc=face, color=color)
    left.set(yscale="log", xlabel="run", ylim=(0.1, 60))
    letter(right, 1, "clay spandrels, force over the first")
    forces = pd.read_csv(TABLES / "benchmarks" / "repeated_spandrels.csv")
    steps = {50: (SKY, "o"), 100: (BLUE, "s"), 150: (GREEN, "^")}
    for (_, step), one in forces[forces["material"] == "clay"].groupby(["draw", "amplitude_um"]):
        right.plot(
            one["repetition"], one["force_n"] / one["force_n"].iloc[0], color=steps[step][0], lw=0.9
        )
    right.axhspan(0.79, 0.85, color=ORANGE, alpha=0.25, lw=0)
    right.set(xlabel="repetition", ylim=(0, 1.05), xlim=(1, 30))
    add_heading(
        figure, "A shaken wall and spandrels that were loaded again and again, beside tests"
    )
    return finish(
        figure,
        [
            Line2D(
                [],
                [],
                color=ORANGE,
                marker="o",
                ls="",
                ms=4,
                label="test (spandrels: mean of three steps)",
            ),
            Line2D([], [], color=SKY, marker="x", ms=4, ls="", label="first bearing"),
            Line2D([], [], color=BLUE, marker="s", mfc="none", ms=4, ls="", label="later bearing"),
            *(
                Line2D([], [], color=colour, label=f"{step} µm")
                for step, (colour, _) in steps.items()
            ),
        ],
        2,
    )


# --- all ------------------------------------------------------------------------------------------

FIGURES = thirty_years, settled_walls, after_the_peak, shaken_walls, model_contact_points


def main():
    folder = arguments(
        __doc__, option("folder", nargs="?", type=Path, default=REPOSITORY / "docs" / "pictures")
    ).folder
    for draw in FIGURES:
        print(save_picture(draw(), folder / f"{draw.__name__}.png", "paper/document_figures.py"))
