"""What the page of a claim asks for: front, address, photograph, survey, levels, runs; all in the
folder --out."""

import contextlib
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from damage.applications.cracks.crack_file import OF_SURVEY, REQUIRED, read_cracks
from damage.applications.cracks.survey import read_survey
from damage.applications.groningen.app.photo import cleaned, rectified
from damage.applications.groningen.claim.sheet import NUMBERS, SHEET, set_aside
from damage.applications.groningen.exposure.exposure import strongest
from damage.applications.groningen.exposure.lives import draws_of
from damage.applications.report.words import LANGUAGES, all_words
from damage.applications.studies.folder import end_with_parent, environment, open_log
from damage.checks import check_choice, check_range, check_whole
from damage.errors import InputError, heard
from damage.files import write_text
from damage.measure.cracks import ENDS
from damage.motion.settlement import PROFILES, read_profile
from damage.wall.file import read_wall, shipped_walls
from damage.wall.geometry import joint_table, tributary_ends
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions

HOUSE, PHOTO, STRAIGHT, SURVEY, LEVELS, LOG = (
    "house.toml",
    "photo.jpg",
    "straight.jpg",
    "survey.csv",
    "levels.csv",
    "claim.log",
)
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
MOST_TEXT, MOST_LINES, MOST_POINTS = 200_000, 500, 500
"""Characters of a text that is typed; cracks and areas of a survey; points of each."""
EVENTS = 8
"""Earthquakes that the page lists."""
POINT_ERROR_M = 0.02
"""How far a marked place may be from the corner of the outline that it stands for [m]."""
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
        found = exposure.as_dict()
        return found | {"events": strongest(found, EVENTS)}

    def fronts(self):
        """{name: text} of the fronts that ship as data, to begin with."""
        return {
            name: path.read_text(encoding="utf-8")
            for name, path in sorted(shipped_walls().items())
            if path.suffix == ".toml"
        }

    def front(self, text):
        """The front that a text in TOML describes: its size, bricks and joints, to be drawn."""
        if not isinstance(text, str) or len(text) > MOST_TEXT:
            raise InputError(
                f"the front: expected up to {MOST_TEXT} characters of TOML; shorten it"
            )
        return _drawn(self._keep(HOUSE, "the front", text, _laid_out))

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
            found = read(trial)
            if not path.exists() or path.read_bytes() != trial.read_bytes():
                set_aside(self.path(RESULTS))
            os.replace(trial, path)
        except InputError as error:
            raise InputError(
                str(error).replace(str(trial), what).replace(trial.name, what)
            ) from error
        finally:
            trial.unlink(missing_ok=True)
        return found

    def layout(self):
        """The Layout of the front that was given; InputError before that."""
        return _laid_out(self._given(HOUSE, "the front"))

    def _given(self, name, what):
        path = self.path(name)
        if not path.exists():
            raise InputError(f"{what} is missing; expected it before this step; give it first")
        return path

    # --- photograph -------------------------------------------------------------------------------

    def photograph(self, data):
        """Keep a photograph (bytes) without its metadata."""
        self.path(PHOTO).write_bytes(cleaned(data))
        self.path(STRAIGHT).unlink(missing_ok=True)
        return {"file": PHOTO}

    def straighten(self, pixels, places):
        """Make the photograph a view of the front by four points, pixels and places x, z [m]."""
        wall = self.layout().wall
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
        jpeg = self._given(PHOTO, "the photograph").read_bytes()
        self.path(STRAIGHT).write_bytes(
            rectified(jpeg, pixels, places, wall.length, wall.built_height)
        )
        return {"file": STRAIGHT}

    # --- survey, levels ---------------------------------------------------------------------------

    def survey(self, cracks, areas, limit_mm, error_mm):
        """Write the survey that was drawn and put it on the joints.

        cracks: [{"points": [[x, z], ...], "width_mm", "offset"}]; areas: [[x, z, x, z], ...]
        without a crack [m].
        """
        layout = self.layout()
        found = self._keep(
            SURVEY,
            "the survey",
            _as_csv(cracks, areas, limit_mm, error_mm),
            lambda path: read_survey(path, layout),
        )
        ends = tributary_ends(joint_table(layout))[found.table["joint"]]
        return found.as_dict() | {
            "file": SURVEY,
            "joints": np.round(ends.reshape(-1, 4), 4).tolist(),
        }

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

    def start(self, latitude, longitude, settle, distortion, draws, language, shown=None):
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
                    " as it was sent; send it by its button, or take the change back"
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
        log, status = self.path(LOG), self.job and self.job.poll()
        text = log.read_text(encoding="utf-8", errors="replace") if log.exists() else ""
        lines = text.replace("\r", "\n").split("\n")
        return {
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
        house, survey = self.path(HOUSE), self.path(SURVEY)
        return {
            "house": house.read_text(encoding="utf-8") if house.exists() else None,
            "front": _drawn(self.layout()) if house.exists() else None,
            "drawn": _redrawn(read_cracks(survey)[-1]) if survey.exists() else None,
            "photo": self.path(PHOTO).exists(),
            "straight": self.path(STRAIGHT).exists(),
            "fronts": self.fronts(),
            **self.progress(),
        }


def _laid_out(path):
    return lay_out(read_wall(path), ModelOptions(supports="bricks"))


def _edges(wall):
    """Corners of a Wall's outline (n, 2) [m]: both of its base, then its top from the right end to
    the left."""
    length, height = wall.length, wall.built_height
    top = wall.outline or ((0.0, height), (length, height))
    return np.array([(0.0, 0.0), (length, 0.0), *reversed(top)])


def _drawn(layout):
    """Size, bricks (x, z, length, height) and joints (both ends) of a Layout, fit for JSON [m]."""
    bodies, n, wall = layout.bodies, layout.n_below_caps, layout.wall
    bricks = np.column_stack([bodies.x, bodies.z, bodies.length, bodies.height])[:n]
    return {
        "name": wall.name,
        "length": wall.length,
        "height": wall.built_height,
        "corners": _edges(wall)[[0, 1, 2, -1]].tolist(),
        "bricks": np.round(bricks, 4).tolist(),
        "contact_points": layout.n_joints,
    }


def _redrawn(pattern):
    """Cracks and areas of a CrackPattern that the page wrote, as it draws them."""
    seen, parts = {1.0: "yes", 0.0: "no"}, pattern.stretches.assign(seen=pattern.offset)
    cracks = []
    for _, line in parts.groupby("line"):
        ends = line[list(ENDS)].to_numpy(float)
        cracks.append(
            {
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
        or len(cracks) + len(areas) > MOST_LINES
    ):
        raise InputError(f"the survey: expected up to {MOST_LINES} cracks and areas; take some out")
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
            {"crack": number, "point": k, "x_m": x, "z_m": z, **(sizes if k < last else {})}
            for k, (x, z) in enumerate(points, start=1)
        ]
    for number, area in enumerate(areas, start=1):
        corners = np.sort(_points(f"area {number}", area, 2, 2), axis=0)
        rows += [
            {"crack": f"area{number}", "point": k, "x_m": x, "z_m": z, "mode": "none"}
            for k, (x, z) in enumerate(corners, start=1)
        ]
    table = pd.DataFrame(rows, columns=[*REQUIRED, "width_mm", "mode", *OF_SURVEY])
    table = table.round({"x_m": 4, "z_m": 4}).assign(**accuracy)
    return table.to_csv(index=False, lineterminator="\n")


def words():
    """{key: {language: text}} of the page, with those that it shares with the sheet."""
    shared = "one_percent", "catalogue_ends", *(f"profile_{one}" for one in PROFILES)
    return all_words("app") | {key: all_words()[key] for key in shared}
