"""What the page of a claim asks for: front, address, photograph, survey, levels, runs; all in the
folder --out."""

import contextlib
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

from damage.applications.cracks.crack_file import OF_SURVEY, REQUIRED, read_cracks
from damage.applications.cracks.survey import read_survey
from damage.applications.groningen.app.photo import cleaned, homography, rectified, turns
from damage.applications.groningen.claim.make import STEPS, USUAL, USUAL_OPTIONS, size_of
from damage.applications.groningen.claim.sheet import NUMBERS, SHEET, outside_at_rest, set_aside
from damage.applications.groningen.claim.twins import write_twins
from damage.applications.groningen.exposure.exposure import strongest
from damage.applications.groningen.exposure.lives import draws_of
from damage.applications.report.words import LANGUAGES, all_words
from damage.applications.studies.definition import load_study
from damage.applications.studies.folder import ROOT, end_with_parent, environment, open_log
from damage.checks import check_choice, check_range, check_whole
from damage.errors import InputError, heard
from damage.files import write_bytes, write_text
from damage.measure.cracks import ENDS
from damage.motion.settlement import PROFILES, read_profile
from damage.wall.file import read_wall, shipped_walls
from damage.wall.geometry import joint_table, tributary_ends
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.new import as_toml

HOUSE = "house.toml"
PHOTO = "photo.jpg"
STRAIGHT = "straight.jpg"
SURVEY = "survey.csv"
LEVELS = "levels.csv"
LOG = "claim.log"
STEP_OF = {HOUSE: 2, PHOTO: 3, SURVEY: 4, LEVELS: 5}
"""{file: step of the page that makes it}."""
RESULTS = "claim"
"""Folder of the runs, below --out."""
SHOWN = {
    PHOTO: "image/jpeg",
    STRAIGHT: "image/jpeg",
    f"{RESULTS}/{SHEET}": "text/html; charset=utf-8",
    f"{RESULTS}/{NUMBERS}": "application/json",
    SURVEY: "text/csv; charset=utf-8",
}
"""{file that the page may show: its type}."""
MOST_TEXT = 200_000
MOST_LINES = 500
MOST_POINTS = 500
"""Characters of a text that is typed; cracks and areas of a survey; points of each."""
EVENTS = 8
"""Earthquakes that the page lists."""
POINT_ERROR_M = 0.02
"""How far a marked place may be from the corner of the outline that it stands for [m]."""
BRICKS = [1, 1]
SHARE = re.compile(r"^\d+ \w+ \d+ \w+, (\d+)[\d.,]* %", re.MULTILINE)
"""Pattern of the log that has how much is simulated."""
TAIL = 12  # lines of the log that the page shows


class Desk:
    """The work on one claim in a folder; every method takes what the page sent and returns what it
    shows, fit for JSON, or raises InputError."""

    def __init__(self, out):
        self.out = Path(out).resolve()
        try:
            self.out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"--out {out}: cannot make this folder ({error.strerror}); expected a folder, or a"
                " name that nothing has yet; choose another"
            ) from error
        self.job = None
        # whose thread lives as long as this program: a job ends with both
        self._starter = ThreadPoolExecutor(1)

    def path(self, name):
        """The path of a file or folder of the claim; InputError where a link leads out of it, or a
        pipe would keep who opens it waiting."""
        path = self.out / name
        if (
            path.is_symlink()
            or not path.resolve().is_relative_to(self.out)
            or (path.exists() and not path.is_file() and not path.is_dir())
        ):
            raise InputError(
                f"{name} is a link, a pipe or a device; expected a file of this claim; delete it"
            )
        return path

    # --- address and front ------------------------------------------------------------------------

    def address(self, latitude, longitude):
        """The earthquakes at an address."""
        for what, value in (("latitude", latitude), ("longitude", longitude)):
            check_range(what, value, -180, 180)
        exposure = draws_of({"latitude": latitude, "longitude": longitude}).exposure
        shaking = exposure.as_dict()
        return shaking | {"events": strongest(shaking, EVENTS)}

    def fronts(self):
        """{name: text} of the fronts that ship as data and have a name in words, to begin with."""
        return {
            name: path.read_text(encoding="utf-8")
            for name, path in sorted(shipped_walls().items())
            if f"front_{name}" in words()
        }

    def front(self, text):
        """The front that a text in TOML describes, that of the claim from now on: its size, bricks
        and joints, to be drawn, its text and table."""
        if not isinstance(text, str) or len(text) > MOST_TEXT:
            raise InputError(
                f"the front: expected up to {MOST_TEXT} characters of TOML; shorten it"
            )
        text = text.removeprefix("\ufeff")
        before = None
        with contextlib.suppress(InputError):  # there is none yet, or none that can be read
            before = _view(self.layout())
        layout = self._keep(HOUSE, "the front", text, _laid_out)
        if _view(layout) != before:  # the photograph was straightened to another front
            self.path(STRAIGHT).unlink(missing_ok=True)
        return _drawn(layout, text) | {"straight": self.path(STRAIGHT).exists()}

    def sketch(self, table):
        """The front of a table that was edited as a drawing, as of `front`."""
        if not isinstance(table, dict):
            raise InputError("the front: expected a table of its sizes; begin with another front")
        return self.front(as_toml(table))

    def size(self, latitude, longitude, units=BRICKS):
        """How large the claim would be: {"contact_points", "steps", "draws"}."""
        with TemporaryDirectory() as folder:
            place = {"latitude": latitude, "longitude": longitude}
            house = str(self._given(HOUSE, "the front"))
            options = USUAL_OPTIONS | {"units": _units(units)}
            study = write_twins(folder, house, place | USUAL, options, {}, STEPS[1])
            return size_of(load_study(study, "reference", ROOT)) | {"draws": STEPS[1]}

    def _keep(self, name, what, text, read):
        """What read(path) makes of a text, which is kept in a file of the claim if it is accepted;
        of another text than the one before the sheet is set aside."""
        if self.running:
            raise InputError(
                f"{what} cannot change while the computation runs; expected it before; stop it"
                " first"
            )
        path = self.path(name)
        trial = self.path(name.replace(".", ".new."))
        try:
            write_text(trial, text)
            content = read(trial)
            if not path.exists() or path.read_bytes() != trial.read_bytes():
                set_aside(self.path(RESULTS))
            os.replace(trial, path)
        except InputError as error:
            raise InputError(
                str(error).replace(str(trial), what).replace(trial.name, what)
            ) from error
        finally:
            trial.unlink(missing_ok=True)
        return content

    def layout(self):
        """The Layout of the front that was given; InputError before that."""
        return _laid_out(self._given(HOUSE, "the front"))

    def _given(self, name, what):
        path = self.path(name)
        if not path.exists():
            raise InputError(f"{what} is missing; expected it in step {STEP_OF[name]} of the page")
        return path

    # --- photograph -------------------------------------------------------------------------------

    def photograph(self, data):
        """Keep a photograph (bytes) without its metadata."""
        write_bytes(self.path(PHOTO), cleaned(data))
        self.path(STRAIGHT).unlink(missing_ok=True)
        return {"file": PHOTO}

    def straighten(self, pixels, places, openings):
        """Make the photograph a view of the front by four points, pixels and places x, z [m], and
        compare the openings there, two opposite corners of each in pixels, with the front's."""
        layout = self.layout()
        wall = layout.wall
        edges = _edges(wall)
        pixels, places = (_points("the four points", points, 4, 4) for points in (pixels, places))
        off = np.linalg.norm(places[:, np.newaxis] - edges, axis=2).min(axis=1)
        if (off > POINT_ERROR_M).any():
            x, z = places[off.argmax()]
            raise InputError(
                f"the four points: ({x:g}, {z:g}) m; expected corners of the front's outline:"
                f" {', '.join(f'({x:g}, {z:g})' for x, z in edges)}; the front may differ from the"
                " photograph"
            )
        if turns(pixels)[0] * turns(places)[0] > 0:  # y is down, z is up
            raise InputError(
                "the four points make a mirrored photograph; expected them in the order of their"
                " places, from the lower left corner; mark them again"
            )
        to_wall = homography(pixels, places)
        _compare_openings(
            layout.plan, [_points("an opening", opening, 2, 2) for opening in openings], to_wall
        )
        jpeg = self._given(PHOTO, "the photograph").read_bytes()
        write_bytes(
            self.path(STRAIGHT), rectified(jpeg, pixels, places, wall.length, wall.built_height)
        )
        return {"file": STRAIGHT}

    # --- survey, levels ---------------------------------------------------------------------------

    def survey(self, cracks, areas, limit_mm, error_mm):
        """Write the survey that was drawn and put it on the joints.

        cracks: [{"points": [[x, z], ...], "width_mm", "offset"}]; areas: [[x, z, x, z], ...]
        without a crack [m].
        """
        layout = self.layout()
        survey = self._keep(
            SURVEY,
            "the survey",
            _as_csv(cracks, areas, limit_mm, error_mm),
            lambda path: read_survey(path, layout),
        )
        return _surveyed(survey, layout)

    def levels(self, text):
        """Keep levels of a course, text in CSV; their profile."""
        if not isinstance(text, str) or len(text) > MOST_TEXT:
            raise InputError(f"levels: expected up to {MOST_TEXT} characters of CSV; shorten it")
        length = self.layout().wall.length

        def read(path):
            profile = read_profile(path)
            profile.check_length(length)
            return profile

        with heard() as notes:
            profile = self._keep(LEVELS, "the file of levels", text, read)
        return {
            "x_m": list(profile.x_m),
            "uz_m": list(profile.uz_m),
            "notes": list(map(str, notes)),
        }

    # --- runs -------------------------------------------------------------------------------------

    def start(
        self,
        latitude,
        longitude,
        settle,
        distortion,
        draws,
        language,
        units=BRICKS,
        shown=None,
    ):
        """Begin, or continue, the runs of the claim: `python3 -m damage claim` in a process of its
        own.

        shown: what the page shows now, {"front", "levels": texts, "survey": arguments of `survey`};
        None where nothing is to be compared with what was sent.
        """
        if self.running:
            raise InputError("the computation is running already; stop it first")
        set_aside(self.path(RESULTS))
        self._check_no_links()
        self.address(latitude, longitude)
        check_choice("language", language, LANGUAGES)
        words = [
            str(self._given(HOUSE, "the front")),
            "--at",
            repr(float(latitude)),
            repr(float(longitude)),
            "--cracks",
            str(self._given(SURVEY, "the survey")),
            "--language",
            language,
            "--out",
            str(self.path(RESULTS)),
            "--remake",
            "--units",
            *map(str, _units(units)),
            *self._settled(settle, distortion),
        ]
        if draws is not None:
            check_whole("draws", draws, 2, 10000)
            words += ["--draws", str(draws)]
        if shown is not None:
            self._check_sent(shown, settle)
        with open_log(self.path(LOG)) as log:
            self.job = self._starter.submit(
                subprocess.Popen,
                [sys.executable, "-m", "damage", "claim", *words],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env=environment(),
                preexec_fn=partial(end_with_parent, os.getpid()),
            ).result()
        return self.progress()

    def _check_no_links(self):
        """InputError where a link lies in the folder, which may have been sent: runs would write
        elsewhere through it."""
        for folder, folders, files in os.walk(self.out):
            for path in (Path(folder, name) for name in (*folders, *files)):
                self.path(path.relative_to(self.out))

    def _check_sent(self, shown, settle):
        """InputError where the page shows another front, survey or levels than it sent: they would
        not be in the run."""
        parts = [
            (HOUSE, "the front", shown["front"]),
            (SURVEY, "the survey that is drawn", _as_csv(**shown["survey"])),
        ]
        parts += [(LEVELS, "the table of levels", shown["levels"])] * (settle == "levels")
        for name, what, text in parts:
            if self.path(name).read_text(encoding="utf-8") != text:
                raise InputError(
                    f"{what} was changed since it was sent and would not be in the run; expected it"
                    " as it was sent; send it again in its step, or take the change back"
                )

    def _settled(self, settle, distortion):
        if settle == "levels":
            return ["--levels", str(self._given(LEVELS, "the file of levels"))]
        if settle is None:
            return []
        check_choice("settlement", settle, PROFILES)
        check_range("distortion", distortion, 1e-7, 0.02)
        return ["--settle", settle, "--distortion", repr(float(distortion))]

    @property
    def running(self):
        return self.job is not None and self.job.poll() is None

    def progress(self):
        """How far the runs are: the last lines of their log."""
        log = self.path(LOG)
        status = self.job and self.job.poll()
        text = log.read_text(encoding="utf-8", errors="replace") if log.exists() else ""
        lines = text.replace("\r", "\n").split("\n")
        shares = SHARE.findall(text)
        more = None
        with contextlib.suppress(OSError, ValueError):  # there is no sheet yet
            more = json.loads(self.path(f"{RESULTS}/{NUMBERS}").read_text())["more_draws"]
        return {
            "more": more,
            "share": float(shares[-1]) / 100 if shares else None,
            "running": self.running,
            "status": status,
            "lines": [line.replace(str(self.out) + os.sep, "") for line in lines if line.strip()][
                -TAIL:
            ],
            "sheet": f"{RESULTS}/{SHEET}" if self.path(f"{RESULTS}/{SHEET}").exists() else None,
        }

    def stop(self, patience_s=20.0):
        """Interrupt the runs, and kill their processes after so long [s]; they continue from there
        when they are started again."""
        if self.running:
            for name in (signal.SIGTERM, signal.SIGKILL):
                with contextlib.suppress(ProcessLookupError, subprocess.TimeoutExpired):
                    os.killpg(self.job.pid, name)
                    self.job.wait(patience_s)
        return self.progress()

    def state(self):
        """What there is already of the claim: after a restart the page continues with it."""
        house = self.path(HOUSE)
        survey = self.path(SURVEY)
        layout = self.layout() if house.exists() else None
        on_joints = None
        with contextlib.suppress(InputError):  # of another front
            if layout and survey.exists():
                on_joints = _surveyed(read_survey(survey, layout), layout)
        return {
            "folder": hashlib.sha256(str(self.out).encode()).hexdigest()[:16],
            "front": layout and _drawn(layout, house.read_text(encoding="utf-8")),
            "drawn": _redrawn(read_cracks(survey)[-1]) if survey.exists() else None,
            "survey": on_joints,
            "photo": self.path(PHOTO).exists(),
            "straight": self.path(STRAIGHT).exists(),
            "fronts": self.fronts(),
            **self.progress(),
        }


def _surveyed(survey, layout):
    """What the page shows of a Survey: its numbers, and the joints of a Layout that it is put on,
    x, z of both ends [m]."""
    ends = tributary_ends(joint_table(layout))[survey.table["joint"]]
    joints = np.round(ends.reshape(-1, 4), 4).tolist()
    return survey.as_dict() | {"file": SURVEY, "joints": joints}


def _laid_out(path):
    return lay_out(read_wall(path), ModelOptions(supports="bricks"))


def _edges(wall):
    """Corners of a Wall's outline (n, 2) [m]: both of its base, then its top from the right end to
    the left."""
    length = wall.length
    height = wall.built_height
    top = wall.outline or ((0.0, height), (length, height))
    return np.array([(0.0, 0.0), (length, 0.0), *reversed(top)])


def _drawn(layout, text):
    """What the page draws of a Layout, fit for JSON [m]: size, corners to straighten by, outline,
    bricks (x, z, length, height), openings (left, lower, right, upper edge) and levels of floors as
    built; its text in TOML, and the table of that."""
    bodies = layout.bodies
    n = layout.n_below_caps
    wall = layout.wall
    bricks = np.column_stack([bodies.x, bodies.z, bodies.length, bodies.height])[:n]
    return {
        "text": text,
        "table": tomllib.loads(text),
        "name": wall.name,
        "length": wall.length,
        "height": wall.built_height,
        "corners": _edges(wall)[[0, 1, 2, -1]].tolist(),
        "bricks": np.round(bricks, 4).tolist(),
        "course": wall.brick.height,
        "brick": wall.brick.length,
        "outline": _edges(wall).tolist(),
        "openings": np.round(_openings(layout.plan), 4).tolist(),
        "floors": sorted({float(floor.above * wall.brick.height) for floor in layout.plan.floors}),
        "contact_points": layout.n_joints,
        "outside": {language: outside_at_rest(layout, language) for language in LANGUAGES},
    }


def _view(layout):
    """What a photograph is straightened by: corners of the outline and edges of openings [m]."""
    return _edges(layout.wall).tolist(), _openings(layout.plan).tolist()


def _openings(plan):
    """Openings of a Plan as built, (n, 4) of left, lower, right and upper edge [m]."""
    course = plan.wall.brick.height
    boxes = [
        (opening.left, course * opening.first, opening.right, course * opening.above)
        for opening in plan.openings
    ]
    return np.array(boxes, float).reshape(-1, 4)


def _compare_openings(plan, marked, to_wall):
    """InputError where openings that were marked in a photograph, two opposite corners in pixels
    each, lie more than a course from those of a Plan; to_wall: (3, 3) from pixels to the wall."""
    built = _openings(plan)
    course = plan.wall.brick.height
    if len(built) and not len(marked):
        raise InputError(
            "no opening of the photograph is marked; expected two opposite corners of one or more;"
            " mark them after the four points"
        )
    for pixels in marked:
        u, v, w = to_wall @ np.column_stack([pixels, np.ones(2)]).T
        x = np.sort(u / w)
        z = np.sort(v / w)
        apart = np.abs(built - [x[0], z[0], x[1], z[1]]).max(axis=1)
        if not (apart <= course).any():
            raise InputError(
                f"the opening from ({x[0]:.2f}, {z[0]:.2f}) to ({x[1]:.2f}, {z[1]:.2f}) m of the"
                " photograph lies more than a course from each of the front; expected openings"
                " where they are; correct the front, or mark its corners again"
            )


def _units(units):
    """Bricks and courses of a unit from the page, a list."""
    if not isinstance(units, list) or len(units) != 2:
        raise InputError(f"units = {units!r}: expected two whole numbers, 1 to 20; correct it")
    for value in units:
        check_whole("units", value, 1, 20)
    return units


def _redrawn(pattern):
    """Cracks and areas of a CrackPattern that the page wrote, as it draws them."""
    seen = {1.0: "yes", 0.0: "no"}
    parts = pattern.stretches.assign(seen=pattern.offset)
    cracks = []
    for _, line in parts.groupby("line"):
        ends = line[list(ENDS)].to_numpy(float)
        cracks.append(
            {
                "label": str(line["crack"].iloc[0]),
                "points": [*ends[:, :2].tolist(), ends[-1, 2:].tolist()],
                "width_mm": round(1e3 * float(line["width_m"].iloc[0]), 6),
                "offset": seen.get(line["seen"].iloc[0], "unknown"),
            }
        )
    return {
        "cracks": cracks,
        "areas": pattern.clear.tolist(),
        "limit_mm": round(1e3 * pattern.detection_limit_m, 6),
        "error_mm": round(1e3 * pattern.width_error_m, 6),
    }


def _points(what, points, least, most):
    """An array (n, 2) of points from the page; InputError for anything else."""
    if not isinstance(points, list) or not least <= len(points) <= most:
        raise InputError(f"{what}: expected {least} to {most} points; mark them again")
    for point in points:
        if not isinstance(point, list) or len(point) != 2:
            raise InputError(f"{what}: expected two numbers a point; mark them again")
        for value in point:
            check_range(what, value, -1e5, 1e5)
    return np.array(points, float)


def _as_csv(cracks, areas, limit_mm, error_mm):
    """The text of a crack file of what was drawn."""
    check_range("detection limit [mm]", limit_mm, 0.001, 100)
    check_range("error of widths [mm]", error_mm, 0, 100)
    if (
        not isinstance(cracks, list)
        or not isinstance(areas, list)
        or not 1 <= len(cracks) + len(areas) <= MOST_LINES
    ):
        raise InputError(
            f"the survey: expected 1 to {MOST_LINES} cracks and areas; draw one, or take some out"
        )
    accuracy = {"detection_limit_mm": float(limit_mm), "width_error_mm": float(error_mm)}
    rows = []
    for number, crack in enumerate(cracks, start=1):
        points = _points(
            f"crack {number}",
            crack.get("points") if isinstance(crack, dict) else None,
            2,
            MOST_POINTS,
        )
        check_range(f"width of crack {number} [mm]", crack.get("width_mm"), 0.001, 1000)
        check_choice(f"offset of crack {number}", crack.get("offset"), ("yes", "no", "unknown"))
        sizes = {"width_mm": float(crack["width_mm"]), "offset": crack["offset"]}
        last = len(points)
        rows += [
            {
                "crack": crack.get("label") or number,
                "point": k,
                "x_m": x,
                "z_m": z,
                **(sizes if k < last else {}),
            }
            for k, (x, z) in enumerate(points, start=1)
        ]
    for number, area in enumerate(areas, start=1):
        corners = np.sort(_points(f"area {number}", area, 2, 2), axis=0)
        rows += [
            {"crack": f"area{number}", "point": k, "x_m": x, "z_m": z, "mode": "none"}
            for k, (x, z) in enumerate(corners, start=1)
        ]
    # a line that begins with a label like #1 would be a comment
    first = sorted(REQUIRED, key="crack".__eq__)
    table = pd.DataFrame(rows, columns=[*first, "width_mm", "mode", *OF_SURVEY])
    table = table.round({"x_m": 4, "z_m": 4}).assign(**accuracy)
    return table.to_csv(index=False, lineterminator="\n")


def words():
    """{key: {language: text}} of the page, with those that it shares with the sheet."""
    shared = "one_percent", "catalogue_ends", *(f"profile_{profile}" for profile in PROFILES)
    return all_words("app") | {key: all_words()[key] for key in shared}
