"""Drawn cracks as paths along the joints of a wall: straight lines become the nearest stepped path.

The joints of a wall are a network: tributary lengths of contact points between the corners at which
they meet.  A polyline is simplified to straight parts.  Its path is the one of least

    sum over joints of length (1 + (distance from the part / brick's height)^2)
        + 10 (distance of its ends and corners)

by Dijkstra's algorithm, over a copy of the network for each part; what of a line is in an opening
or beside the wall has none.  Joints of the path that are farther from the line than a tolerance are
left out; what of the line has none within the tolerance is on no joint.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pandas as pd
import scipy  # sparse.csgraph where it is used: it starts slowly

from damage.applications.cracks.crack_mapping import in_chunks
from damage.checks import check_positive
from damage.elementary import hypot
from damage.measure.cracks import ends_of, points_along
from damage.units import MILLIMETRE
from damage.wall.geometry import joint_table, tributary_ends

SIMPLER = 15 * MILLIMETRE
"""Distance up to which a polyline may be simplified [m]: noise of drawing by hand, less than steps
of bricks."""
AROUND_M = 1.0
"""How far from a polyline its path is searched [m]."""
MOST_TOGETHER = 100
"""Stretches of a polyline whose path is searched at once: a longer one is several, for memory."""
_SAMPLE = 5 * MILLIMETRE  # pieces of lines whose distance from the path is worked out
_SAME = 1e-6  # [m], two corners closer than this are one
# cost of a metre between an end or a corner of the line and the corner of joints that stands for it
_END = 10.0


class CrackPaths(NamedTuple):
    """Drawn cracks on joints.

    table: DataFrame, a row each joint of each polyline's path: line (index), joint (index), stretch
    (index of the nearest), length_m; drawn_m, on_joints_m: length of all polylines, and of what has
    joints of its path within the tolerance; apart_m: largest distance of a joint of a path from its
    line.
    """

    table: pd.DataFrame
    drawn_m: float
    on_joints_m: float
    apart_m: float

    @property
    def share(self):
        """Share of the drawn length that is on joints [-]; 1 where nothing is drawn."""
        return self.on_joints_m / self.drawn_m if self.drawn_m else 1.0


def lines_of(ends):
    """Polylines (n, 2) [m] of stretches (n, 2, 2) [m] in their order, each of up to MOST_TOGETHER:
    a stretch continues where the one before ends."""
    goes_on = np.zeros(len(ends), bool)
    goes_on[1:] = np.all(ends[1:, 0] == ends[:-1, 1], axis=1)
    wholes = [part for part in np.split(ends, np.flatnonzero(~goes_on)[1:]) if len(part)]
    parts = [
        part
        for whole in wholes
        for part in np.split(whole, range(MOST_TOGETHER, len(whole), MOST_TOGETHER))
    ]
    return [np.vstack([part[:, 0], part[-1:, 1]]) for part in parts]


def crack_paths(stretches, layout, tolerance=None):
    """CrackPaths of the stretches of a CrackPattern, or of their ends (n, 2, 2) [m], on the joints
    of a Layout.

    tolerance [m]: how far from a line its joints may be, None for half a brick's length.
    """
    tolerance = layout.wall.brick.length / 2 if tolerance is None else tolerance
    check_positive("tolerance [m]", tolerance)
    places = (
        ends_of(stretches) if isinstance(stretches, pd.DataFrame) else np.asarray(stretches, float)
    )
    network = _Network(layout)
    first = 0
    tables = [pd.DataFrame(columns=["line", "joint", "stretch"], dtype=int)]
    on_joints = 0.0
    apart = 0.0
    for number, line in enumerate(lines_of(places)):
        drawn = np.stack([line[:-1], line[1:]], axis=1)
        paths = [network.path(piece) for piece in network.in_masonry(_simplified(line))]
        joint = np.concatenate([np.zeros(0, int), *paths])
        middle = network.ends[joint].mean(axis=1)
        distance = _distances(middle, drawn)
        near = distance.min(axis=1, initial=np.inf) <= tolerance
        joint = joint[near]
        distance = distance[near]
        on_joints += network.covered(drawn, joint, tolerance)
        apart = max(apart, distance.min(axis=1).max(initial=0.0))
        stretch = first + distance.argmin(axis=1)
        tables.append(pd.DataFrame({"line": number, "joint": joint, "stretch": stretch}))
        first += len(drawn)
    table = pd.concat(tables, ignore_index=True)
    table["length_m"] = network.length[table["joint"]]
    drawn_m = hypot(*(places[:, 1] - places[:, 0]).T).sum()
    return CrackPaths(
        table.drop_duplicates(["line", "joint"], ignore_index=True),
        drawn_m,
        on_joints,
        apart,
    )


def _simplified(line):
    """A polyline (n, 2) with fewer points: none that is left out is farther from it than SIMPLER
    (Douglas and Peucker 1973)."""
    away = _distances(line[1:-1], line[np.newaxis, [0, -1]])[:, 0]
    if away.max(initial=0.0) <= SIMPLER:
        return line[[0, -1]]
    middle = 1 + int(away.argmax())
    return np.vstack([_simplified(line[: middle + 1]), _simplified(line[middle:])[1:]])


def _distances(points, segments):
    """Distances (n_points, n_segments) [m] of points (n, 2) from segments (n, 2, 2)."""
    start = segments[:, 0]
    along = segments[:, 1] - segments[:, 0]
    away = points[:, np.newaxis] - start
    share = np.clip(
        (away * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-18), 0.0, 1.0
    )
    return np.linalg.norm(away - share[..., np.newaxis] * along, axis=2)


def _from_nearest(points, segments):
    """Distance (n_points,) [m] of points (n, 2) from the nearest of segments (k, 2, 2)."""
    return in_chunks(lambda part: _distances(part, segments).min(axis=1), points)


class _Network:
    """The joints of a Layout between the corners at which they meet.

    ends: (n_joints, 2, 2) [m]; length: (n_joints,) [m]; corners: (n_corners, 2) [m]; corner:
    (n_joints, 2) indices; joint_of: {(corner, corner): joint};
    height: of a brick [m]; low, high: (n, 2) [m], corners of all bodies with half of that around
    them, within which a place is in masonry.
    """

    def __init__(self, layout):
        n = layout.n_below_caps
        bodies = layout.bodies
        middle, size = (
            np.column_stack([getattr(bodies, name)[:n] for name in names])
            for names in (("x", "z"), ("length", "height"))
        )
        self.height = layout.wall.brick.height
        self.low = middle - size / 2 - self.height / 2
        self.high = middle + size / 2 + self.height / 2
        self.ends = np.sort(tributary_ends(joint_table(layout)), axis=1)
        self.length = layout.contacts.length[: layout.n_joints]
        places = self.ends.reshape(-1, 2)
        same = scipy.spatial.cKDTree(places).query_pairs(_SAME, output_type="ndarray")
        graph = scipy.sparse.coo_matrix((np.ones(len(same)), same.T), shape=(len(places),) * 2)
        corner = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
        self.corners = places[np.unique(corner, return_index=True)[1]]
        self.corner = corner.reshape(-1, 2)
        self.joint_of = {
            tuple(sorted(pair)): number for number, pair in enumerate(self.corner.tolist())
        }

    def _has(self, points):
        """Whether points (n, 2) lie in masonry."""

        def inside(points):
            near = (self.low <= points.max(axis=0)) & (self.high >= points.min(axis=0))
            low, high = (corners[near.all(axis=1)] for corners in (self.low, self.high))
            points = points[:, np.newaxis]
            return ((points >= low) & (points <= high)).all(axis=2).any(axis=1)

        return in_chunks(inside, points)

    def covered(self, drawn, joint, tolerance):
        """Length [m] of stretches (n, 2, 2) in masonry with one of these joints within the
        tolerance [m]."""
        covered = 0.0
        for start, end in drawn if len(joint) else ():
            length = hypot(*(end - start))
            n = max(1, int(np.ceil(length / _SAMPLE)))
            (middle,) = points_along(np.array([[start, end]]), n)
            near = _from_nearest(middle, self.ends[joint]) <= tolerance * (1 + 1e-9)
            covered += length * (near & self._has(middle)).mean()
        return covered

    def in_masonry(self, line):
        """The parts of a polyline (n, 2) [m] that lie in masonry, a list of polylines."""
        pieces = []
        goes_on = False
        for start, end in pairwise(line):
            n = max(1, int(np.ceil(hypot(*(end - start)) / _SAMPLE)))
            points = start + (end - start) * (np.arange(n + 1) / n)[:, np.newaxis]
            inside = self._has(points)
            edges = np.flatnonzero(np.diff(np.concatenate([[0], inside, [0]])))
            for first, last in edges.reshape(-1, 2):
                goes_on = goes_on and first == 0
                if goes_on:
                    pieces[-1].append(points[last - 1])
                elif last - first > 1:
                    pieces.append([points[first], points[last - 1]])
                goes_on = last == n + 1 and (goes_on or last - first > 1)
            goes_on = goes_on and bool(inside[-1])
        return [np.array(piece) for piece in pieces]

    def path(self, line):
        """The joints of the path of a polyline (n, 2) [m], in the order of the way."""
        parts = np.stack([line[:-1], line[1:]], axis=1)
        near = np.flatnonzero(_from_nearest(self.corners, parts) <= AROUND_M)
        if len(near) == 0:
            return np.zeros(0, int)
        local = np.full(len(self.corners), -1)
        local[near] = np.arange(len(near))
        joint = np.flatnonzero((local[self.corner] >= 0).all(axis=1))
        first, second = local[self.corner[joint]].T
        cost = self.length[joint, np.newaxis] * (
            1 + (_distances(self.ends[joint].mean(axis=1), parts) / self.height) ** 2
        )
        n = len(near)
        turn = _END * np.linalg.norm(self.corners[near][:, np.newaxis] - line, axis=2)
        # of the network there is a copy for each part, and an end and a corner cost on the way on
        nodes = np.arange(n)
        source = n * len(parts)
        copy = n * np.arange(len(parts))[:, np.newaxis]
        edges = [
            (first + copy, second + copy, cost.T),
            (second + copy, first + copy, cost.T),
            (nodes + copy[:-1], nodes + copy[1:], turn[:, 1:-1].T),
            (source, nodes, turn[:, 0]),
            (nodes + copy[-1], source + 1, turn[:, -1]),
        ]
        start, end, weight = (
            np.concatenate([np.broadcast_to(edge[k], np.shape(edge[2])).ravel() for edge in edges])
            for k in range(3)
        )
        graph = scipy.sparse.csr_matrix((weight + 1e-12, (start, end)), shape=(source + 2,) * 2)
        _, before = scipy.sparse.csgraph.dijkstra(graph, indices=source, return_predecessors=True)
        nodes = [source + 1]
        while before[nodes[-1]] >= 0:
            nodes.append(before[nodes[-1]])
        nodes = np.array(nodes[-2:0:-1], int)  # without the source and the end
        # steps along a joint, which stay at one part of the line
        inside = nodes[:-1] // n == nodes[1:] // n
        steps = near[np.column_stack([nodes[:-1], nodes[1:]])[inside] % n]
        return np.array([self.joint_of[tuple(sorted(step))] for step in steps.tolist()], int)
