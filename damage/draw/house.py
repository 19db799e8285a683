"""Pictures of a house that ran: its walls unfolded with the cracks of both faces, the house in
perspective, walls and corners over time.

Each function returns a matplotlib Figure; `save_all` writes those of a History, of a plane wall,
too.
"""

from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

from damage.draw import run, style
from damage.draw.panels import PAGE_WIDTH, from_zero, grid, letter
from damage.draw.wall import line_width, shape_at, visible, widest_line, widths
from damage.history.in_space import InSpace
from damage.history.info import origin
from damage.history.moments import (
    JOINT_STATES,
    check_samples,
    choose_sample,
    joint_states,
    nearest_snapshot,
)
from damage.house.placing import BOX, FACES
from damage.measure.house import corner_joints, corners_table, walls_table
from damage.wall.geometry import kinds_of_bodies
from damage.wall.kinds import TINY

COLOURS = style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.BLACK, style.ORANGE
LINES = [(colour, line) for line in ("-", "--", ":", "-.") for colour in COLOURS]
"""Colour and line of the walls, then of the corners, in their order."""
SIDES = np.array(
    [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [3, 2, 6, 7], [0, 3, 7, 4], [1, 2, 6, 5]]
)
"""Corners of the sides of a box, as of `damage.house.placing.BOX`."""
ABOVE_DEG = 24.0
"""Height of the eye above the horizon [deg]."""
BESIDE_DEG = 35.0
"""Angle of the eye from the normal of the first wall [deg]."""
AWAY = 3.5  # distance of the eye from the middle of the house, over the radius of the house
DARKEST = 0.8  # share of its colour that a side has which the light does not reach
BEFORE_M = 0.001  # cracks before the bricks beside them
VISIBLE_SHARE = 0.05  # largest drawn displacement over the height of the house


def moment_of(history, sample):
    """A sample as of `choose_sample`, the largest index of a wall there, and the nearest snapshot
    or None."""
    sample, damage = choose_sample(history, sample)
    return sample, damage, nearest_snapshot(history, history.time_s[sample])


class Cracks(NamedTuple):
    """Cracks to be drawn: ends (n, 2, 3) [m], codes of JOINT_STATES (n,), widths (n,) [m], and the
    bodies beside each (n, 2), -1 the ground."""

    ends: np.ndarray
    codes: np.ndarray
    width: np.ndarray
    bodies: np.ndarray


def cracks(space, sample, snapshot, magnify, joints):
    """Cracks of the failed contact points of an InSpace among these (n_joints,) bool, and their
    indices."""
    codes = joint_states(space.history, sample)
    chosen = np.flatnonzero(joints & (codes > JOINT_STATES.index("intact")))
    ends = space.ends(snapshot, magnify, chosen)
    width = widths(space.history, sample)[chosen]
    return Cracks(ends, codes[chosen], width, space.joint_bodies[chosen]), chosen


def corner_cracks(space, number, sample, snapshot, magnify):
    """Cracks of the joints between a wall, by its number, and others, seen from in front of the
    wall: one of each pair of bricks and kind, in the gravest state of its points."""
    history = space.history
    placing = history.placing
    pairs = [
        joints for walls, joints in corner_joints(history).items() if placing.names[number] in walls
    ]
    joints = np.concatenate([*pairs, np.zeros(0, int)])
    places = placing.in_wall(number, space.joint_ends[joints].mean(axis=1))
    keys = history.joints.iloc[joints][["first_body", "second_body", "kind"]]
    groups = keys.groupby(list(keys), observed=True).indices
    ends = np.zeros((len(groups), 2, 3))
    for line, ((*_, kind), rows) in zip(ends, groups.items()):
        axis = 2 if kind == "head" else 0
        line[:] = places[rows].mean(axis=0)
        line[:, axis] = places[rows, axis].min(), places[rows, axis].max()
    codes, width = (
        np.array([values[joints[rows]].max() for rows in groups.values()], values.dtype)
        for values in (joint_states(history, sample), widths(history, sample))
    )
    bodies = np.array([pair for *pair, _ in groups], int).reshape(-1, 2)
    ends = placing.in_house(np.full(len(ends), number), ends)
    ends = sum(space.moved(body, ends, snapshot, magnify) for body in bodies.T) / 2
    return Cracks(ends, codes, width, bodies)


def magnification(space, snapshots):
    """Factor that makes the largest displacement in these snapshots visible, as
    `damage.draw.wall.magnification` does; space: InSpace."""
    largest = max(
        float(np.abs(space.corners(snapshot) - space.boxes).max()) for snapshot in snapshots
    )
    return visible(largest, float(space.boxes[..., 2].max()), VISIBLE_SHARE)


def _widest(history, span_m, page_pt):
    """`widest_line` of a house that spans so much on a page."""
    bricks = history.bodies["course"] >= 0
    return widest_line(history.bodies["height_m"][bricks].min(), span_m, page_pt)


# --- as one sees it ------------------------------------------------------------------------------


class Before:
    """The view from in front of a face of a wall, by its number and the sign of its y: places along
    the wall and upwards, without perspective."""

    def __init__(self, placing, number, sign):
        self.placing = placing
        self.number = number
        self.towards = self.light = sign * placing.axes[number, 1]

    def project(self, places):
        """Places (..., 3) [m] of the house on the face, (..., 2) [m]."""
        left = self.placing.left[self.number]
        return self.placing.in_wall(self.number, places)[..., [0, 2]] - [left, 0.0]

    def sees(self, places, normals):
        """Whether planes with normals (..., 3) show their fronts, (...,) bool."""
        return normals @ self.towards > 0

    def in_band(self, boxes):
        """Which boxes (n, 8, 3) [m] are in the wall, or reach into it, (n,) bool."""
        placing = self.placing
        wall = placing.walls[self.number].wall
        half = np.array([wall.length, wall.brick.thickness]) / 2
        middle = [placing.left[self.number] + half[0], 0.0]
        places = placing.in_wall(self.number, boxes)[..., :2] - middle
        reach = half - TINY
        return ((places.max(axis=1) > -reach) & (places.min(axis=1) < reach)).all(axis=1)


class Eye:
    """Perspective of a house from an azimuth in plan [deg]; middle [m] and radius [m] of what is
    seen."""

    def __init__(self, azimuth, middle, radius):
        turn, above = np.radians([azimuth, ABOVE_DEG])
        towards = [np.cos(above) * np.cos(turn), np.cos(above) * np.sin(turn), np.sin(above)]
        self.towards = np.array(towards)
        self.right = np.array([-np.sin(turn), np.cos(turn), 0.0])
        self.light = self.right / 2 + [0.0, 0.0, 0.9]
        self.middle = middle
        self.distance = AWAY * radius

    def project(self, places):
        """Places (..., 3) [m] on the picture, (..., 2) [m], in scale at the middle."""
        away = places - self.middle
        scale = self.distance / (self.distance - away @ self.towards)
        up = np.cross(self.towards, self.right)
        return np.stack([away @ self.right, away @ up], -1) * scale[..., None]

    def sees(self, places, normals):
        """Whether planes at places with normals (..., 3) show their fronts, (...,) bool."""
        place = self.middle + self.distance * self.towards
        return np.sum((place - places) * normals, axis=-1) > 0


def draw(collection, history, eye, corners, lines, widest_pt, shown=slice(None)):
    """Draw bodies, by their corners (n_bodies, 8, 3) [m], those that are shown, and Cracks into a
    PolyCollection, from back to front.

    Course by course upwards: as the eye is above all of them, a lower one hides nothing of a higher
    one; in a course from far to near.
    """
    ends, codes, width, joined = lines
    sides = corners[shown][:, SIDES]
    centre = corners.mean(axis=1)
    outwards = sides.mean(axis=2) - centre[shown, None]
    seen = eye.sees(sides.mean(axis=2), outwards)
    face = np.arange(len(corners))[shown][np.nonzero(seen)[0]]
    level = np.append(history.bodies["z_m"].round(3), -np.inf)
    near = np.append(centre @ eye.towards, -np.inf)
    normal = outwards[seen] / np.linalg.norm(outwards[seen], axis=1, keepdims=True)
    light = DARKEST + (1 - DARKEST) * np.clip(normal @ eye.light, 0, 1)
    kinds = kinds_of_bodies(history.bodies["course"])[face]
    paint = np.array([to_rgb(style.BODY_COLOURS[kind]) for kind in kinds]) * light[:, None]
    colours = np.array([to_rgb(run.JOINT_COLOURS[state]) for state in JOINT_STATES])[codes]
    order = np.lexsort(
        (
            np.append(near[face], near[joined].max(axis=1) + BEFORE_M),
            np.append(level[face], level[joined].max(axis=1)),
        )
    )
    places = [*eye.project(sides[seen]), *eye.project(ends)]
    collection.set_verts([places[k] for k in order])
    collection.set(
        facecolor=np.concatenate([paint, colours])[order],
        edgecolor=np.concatenate([np.full_like(paint, 0.5), colours])[order],
        linewidth=np.append(np.full(len(face), 0.15), line_width(width, widest_pt))[order],
    )


def legend_of(history, sample, widest_pt):
    """Handles of the states and widths of cracks, and of the kinds of bodies, of a house."""
    shape = replace(
        shape_at(history.parts[0], sample, 0.0, magnify=0.0),
        elastic=np.zeros(1, bool),
        kinds=kinds_of_bodies(history.bodies["course"]),
        crack_width_m=widths(history, sample),
        widest_pt=widest_pt,
    )
    return [handle for handle in run.joint_handles(shape) if handle.get_label() != "intact"]


def _title(history, sample, damage):
    moment = f"{history.time_s[sample]:.3f} s, largest DI of a wall {damage:.3f}"
    return [*style.title_of(history), moment]


@style.styled
def elevation_picture(history, sample="max", magnify=None):
    """Figure of the walls of a house side by side, above with the cracks of their faces outside,
    below inside, each face seen from in front of it; joints to other walls in both.

    sample: "max" (of the largest index of a wall), "end" or an index into the series; magnify:
    factor on displacements and rotations, None for one that makes them visible.
    """
    space = InSpace(history)
    placing = history.placing
    house = history.house
    sample, damage, snapshot = moment_of(history, sample)
    magnify = magnification(space, [snapshot]) if magnify is None else magnify
    span = np.array([sum(placing.length + 0.3), space.boxes[..., 2].max()])
    scale = min((PAGE_WIDTH - 0.6) / span[0], 3.5 / span[1])  # [inch/m]
    widest_pt = _widest(history, span, 72 * scale * span)
    figure, axes = grid(2, len(placing.names), 1.0, sharey=True, width_ratios=placing.length)
    figure.set_size_inches(PAGE_WIDTH, 2 * scale * span[1] + 0.85)
    corners = space.corners(snapshot, magnify)
    for row, face in zip(axes, FACES):
        for number, (ax, sign) in enumerate(zip(row, placing.sign_of(face))):
            eye = Before(placing, number, sign)
            on_face = (house.joint_wall == number) & (np.sign(house.joint_y_m) == sign)
            lines, _ = cracks(space, sample, snapshot, magnify, on_face)
            more = corner_cracks(space, number, sample, snapshot, magnify)
            lines = Cracks(*(np.concatenate(both) for both in zip(lines, more)))
            drawn = ax.add_collection(PolyCollection([]))
            shown = eye.in_band(space.boxes)
            draw(drawn, history, eye, corners, lines, widest_pt=widest_pt, shown=shown)
            run.show_all(ax, eye.project(corners[history.house.body_wall == number]))
            if sign > 0:
                ax.invert_xaxis()
            if number:
                ax.set_ylabel("")
            ax.set_title(f"{placing.names[number]}, {face}", loc="left", fontsize="medium")
    title = [*_title(history, sample, damage), "each face is seen from in front of it"]
    handles = [*legend_of(history, sample, widest_pt), run.magnified(snapshot, magnify)]
    return style.finish_in_scale(figure, title, handles, columns=6)


class Perspective:
    """Axes with a house in perspective: `show` draws a moment from an azimuth [deg]."""

    def __init__(self, ax, history):
        self.space = InSpace(history)
        placing = history.placing
        low = self.space.boxes.min(axis=(0, 1))
        high = self.space.boxes.max(axis=(0, 1))
        self.middle = (low + high) / 2
        self.half = (high - low) / 2
        self.radius = float(np.linalg.norm(self.half))
        outside = placing.sign_of("outside")[0] * placing.axes[0, 1]
        self.azimuth = float(np.degrees(np.arctan2(outside[1], outside[0]))) + BESIDE_DEG
        page_pt = 72 * style.COLUMN_WIDTH
        self.widest_pt = _widest(history, (2 * self.radius,) * 2, (page_pt,) * 2)
        self.ground, self.drawn = (ax.add_collection(PolyCollection([])) for _ in range(2))
        self.ground.set(facecolor=style.GROUND_COLOUR, edgecolor="none")
        self.ax = ax
        ax.set(aspect="equal")
        ax.axis("off")

    def show(self, sample, snapshot, magnify, azimuth):
        """Draw a sample and snapshot, with displacements by a factor."""
        history = self.space.history
        house = self.space.history.house
        eye = Eye(azimuth, self.middle, self.radius)
        on_face = (house.joint_wall >= 0) & (np.abs(house.joint_y_m) > TINY)
        lines, joints = cracks(self.space, sample, snapshot, magnify, on_face)
        normals = history.placing.axes[house.joint_wall[joints], 1]
        normals = normals * np.sign(house.joint_y_m[joints, None])
        seen = eye.sees(lines.ends.mean(axis=1), normals)
        lines = Cracks(*(values[seen] for values in lines))
        corners = self.space.corners(snapshot, magnify)
        draw(self.drawn, history, eye, corners, lines, widest_pt=self.widest_pt)
        ground = self._around(0.12)[[0, 1, 5, 4]] * [1.0, 1.0, 0.0]
        self.ground.set_verts([eye.project(ground)])

    def _around(self, share):
        """Corners of a box with a margin, as of BOX, (8, 3) [m]."""
        return self.middle + BOX * (self.half + share * self.radius)

    def fit(self, azimuths):
        """Set the limits of the axes to what is seen from these azimuths [deg]; returns height over
        width."""
        around = self._around(0.15)
        seen = [Eye(azimuth, self.middle, self.radius).project(around) for azimuth in azimuths]
        low = np.min(seen, axis=(0, 1))
        high = np.max(seen, axis=(0, 1))
        self.ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        return (high[1] - low[1]) / (high[0] - low[0])


@style.styled
def space_picture(history):
    """Return a Figure of a house in perspective at its largest index, deformed and exaggerated,
    with the cracks of the faces that are seen."""
    sample, damage, snapshot = moment_of(history, "max")
    figure, ax = style.new_figure(1.0)
    seen = Perspective(ax, history)
    magnify = magnification(seen.space, [snapshot])
    seen.show(sample, snapshot, magnify, seen.azimuth)
    ratio = seen.fit([seen.azimuth])
    figure.set_size_inches(style.COLUMN_WIDTH, min(style.COLUMN_WIDTH * ratio, 4.5))
    handles = [*legend_of(history, sample, seen.widest_pt), run.magnified(snapshot, magnify)]
    return style.finish_in_scale(figure, _title(history, sample, damage), handles)


# --- over time -----------------------------------------------------------------------------------


@style.styled
def walls_picture(history):
    """Figure over time: damage index, drift along and across each wall, opening of the corners."""
    check_samples(history)
    walls = walls_table(history)
    corners = corners_table(history)
    panels = [
        (walls, "wall", "DI", 1.0, "DI [-]", "damage index"),
        (walls, "wall", "drift_ratio", 100.0, "drift [%]", "drift along the wall"),
        (walls, "wall", "drift_across_ratio", 100.0, "drift [%]", "drift across the wall"),
        (corners, "corner", "opening_m", 1e3, "opening [mm]", "corners, widest opening"),
    ][: 3 + (len(corners) > 0)]
    figure, axes = style.new_figure(1.15 * len(panels), rows=len(panels), sharex=True)
    lines = dict(zip([*walls["wall"].unique(), *corners["corner"].unique()], LINES))
    for number, (ax, (table, key, name, factor, label, heading)) in enumerate(zip(axes, panels)):
        for title, rows in table.groupby(key, sort=False):
            colour, line = lines[title]
            ax.plot(rows["time_s"], factor * rows[name], color=colour, ls=line, label=title)
        ax.set_ylabel(label)
        letter(ax, number, heading)
    for ax in axes[::3]:
        from_zero(ax)
    handles = [line for ax in axes[::3] for line in ax.get_lines()]
    return run.finish_over_time(figure, history, axes, handles)


# --- files ---------------------------------------------------------------------------------------

PICTURES = {
    "elevation_max": elevation_picture,
    "elevation_end": partial(elevation_picture, sample="end"),
    "space_max": space_picture,
    "walls": walls_picture,
    "energy": run.energy_picture,
}
"""{file name without suffix: function that draws it} of a house."""


def save_all(history, folder):
    """Write all pictures of a History as PNG and PDF into `folder`, created where missing, those of
    a house or of a wall; returns their paths."""
    pictures = PICTURES if history.kind == "house" else run.pictures_of(history)
    return style.save_figures(
        ((name, draw(history)) for name, draw in pictures.items()), folder, origin(history)
    )
