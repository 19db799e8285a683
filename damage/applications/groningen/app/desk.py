"""What the page of a claim asks for: front, address, photograph, survey, levels, runs; all in the
folder --out."""

import contextlib
import hashlib
import json
import os
from pathlib import Path

from damage.applications.cracks.crack_file import read_cracks
from damage.applications.cracks.survey import read_survey
from damage.applications.groningen.app.front import check_marks, drawn, laid_out, view
from damage.applications.groningen.app.job import Job
from damage.applications.groningen.app.marked import SURVEY, as_csv, points_of, redrawn, surveyed
from damage.applications.groningen.app.photo import cleaned, rectified
from damage.applications.groningen.claim.sheet import NUMBERS, SHEET, set_aside
from damage.applications.groningen.exposure.exposure import strongest
from damage.applications.groningen.exposure.lives import draws_of
from damage.applications.report.words import LANGUAGES, all_words
from damage.checks import check_choice, check_range, check_whole
from damage.errors import InputError, heard
from damage.files import write_bytes, write_text
from damage.motion.settlement import PROFILES, read_profile
from damage.wall.file import shipped_walls
from damage.wall.new import as_toml

HOUSE = "house.toml"
PHOTO = "photo.jpg"
STRAIGHT = "straight.jpg"
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
"""Characters of a text that is typed."""
EVENTS = 8
"""Earthquakes that the page lists."""
BRICKS = [1, 1]


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
        self.job = Job()

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
            before = view(self.layout())
        layout = self._keep(HOUSE, "the front", text, laid_out)
        if view(layout) != before:  # the photograph was straightened to another front
            self.path(STRAIGHT).unlink(missing_ok=True)
        return drawn(layout, text) | {"straight": self.path(STRAIGHT).exists()}

    def sketch(self, table):
        """The front of a table that was edited as a drawing, as of `front`."""
        if not isinstance(table, dict):
            raise InputError("the front: expected a table of its sizes; begin with another front")
        return self.front(as_toml(table))

    def _keep(self, name, what, text, read):
        """What read(path) makes of a text, which is kept in a file of the claim if it is accepted;
        of another text than the one before the sheet is set aside."""
        if self.job.running:
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
        return laid_out(self._given(HOUSE, "the front"))

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
        pixels, places = (points_of("the four points", given, 4, 4) for given in (pixels, places))
        openings = [points_of("an opening", opening, 2, 2) for opening in openings]
        check_marks(layout, pixels, places, openings)
        jpeg = self._given(PHOTO, "the photograph").read_bytes()
        write_bytes(
            self.path(STRAIGHT),
            rectified(jpeg, pixels, places, layout.wall.length, layout.wall.built_height),
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
            as_csv(cracks, areas, limit_mm, error_mm),
            lambda path: read_survey(path, layout),
        )
        return surveyed(survey, layout)

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
            "uz_m": list(profile.uz_m),
            "notes": list(map(str, notes)),
        }

    # --- runs -------------------------------------------------------------------------------------

    def start(self, latitude, longitude, settle, distortion, draws, language, units=BRICKS):
        """Begin, or continue, the runs of the claim: `python3 -m damage claim` in a process of its
        own."""
        if self.job.running:
            raise InputError("the computation is running already; stop it first")
        set_aside(self.path(RESULTS))
        self._check_no_links()
        self.address(latitude, longitude)
        check_choice("language", language, LANGUAGES)
        if not isinstance(units, list) or len(units) != 2:
            raise InputError(f"units = {units!r}: expected two whole numbers, 1 to 20; correct it")
        for value in units:
            check_whole("units", value, 1, 20)
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
            *map(str, units),
            *self._settled(settle, distortion),
        ]
        if draws is not None:
            check_whole("draws", draws, 2, 10000)
            words += ["--draws", str(draws)]
        self.job.start(words, self.path(LOG))
        return self.progress()

    def _check_no_links(self):
        """InputError where a link lies in the folder, which may have been sent: runs would write
        elsewhere through it."""
        for folder, folders, files in os.walk(self.out):
            for path in (Path(folder, name) for name in (*folders, *files)):
                self.path(path.relative_to(self.out))

    def _settled(self, settle, distortion):
        if settle == "levels":
            return ["--levels", str(self._given(LEVELS, "the file of levels"))]
        if settle is None:
            return []
        check_choice("settlement", settle, PROFILES)
        check_range("distortion", distortion, 1e-7, 0.02)
        return ["--settle", settle, "--distortion", repr(float(distortion))]

    def progress(self):
        """How far the runs are: `Job.progress`, whether more draws help, and the sheet's file, None
        where there is none yet."""
        more = None
        with contextlib.suppress(OSError, ValueError):  # there is no sheet yet
            more = json.loads(self.path(f"{RESULTS}/{NUMBERS}").read_text())["more_draws"]
        progress = self.job.progress(self.path(LOG))
        return progress | {
            "more": more,
            "lines": [line.replace(str(self.out) + os.sep, "") for line in progress["lines"]],
            "sheet": f"{RESULTS}/{SHEET}" if self.path(f"{RESULTS}/{SHEET}").exists() else None,
        }

    def stop(self, patience_s=20.0):
        """Interrupt the runs, as of Job; they continue from there when they are started again."""
        self.job.stop(patience_s)
        return self.progress()

    def state(self):
        """What there is already of the claim: after a restart the page continues with it."""
        house = self.path(HOUSE)
        survey = self.path(SURVEY)
        layout = self.layout() if house.exists() else None
        on_joints = None
        with contextlib.suppress(InputError):  # of another front
            if layout and survey.exists():
                on_joints = surveyed(read_survey(survey, layout), layout)
        return {
            "folder": hashlib.sha256(str(self.out).encode()).hexdigest()[:16],
            "front": layout and drawn(layout, house.read_text(encoding="utf-8")),
            "drawn": redrawn(read_cracks(survey)[-1]) if survey.exists() else None,
            "survey": on_joints,
            "photo": self.path(PHOTO).exists(),
            "straight": self.path(STRAIGHT).exists(),
            "fronts": self.fronts(),
            **self.progress(),
        }


def words():
    """{key: {language: text}} of the page, with those that it shares with the sheet."""
    shared = "one_percent", "catalogue_ends", *(f"profile_{profile}" for profile in PROFILES)
    return all_words("app") | {key: all_words()[key] for key in shared}
