"""Seed faults one by one in a copy of the repository, and say which of the tests named for each
detects it.

    python3 scripts/seeded_faults.py                # all of them, about half an hour on one core
    python3 scripts/seeded_faults.py law index      # those of some subjects
    python3 scripts/seeded_faults.py --table FILE   # write the table that the documents show

A fault is a small change of one line, such as a sign or a factor.  First the tests must pass
without any; status 1 where they do not, or where a fault stays undetected.
"""

import argparse
import csv
import re
import subprocess
import sys
import tempfile
from itertools import starmap
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]


class Fault(NamedTuple):
    """A change of the text `right` in the file at `path` to `wrong`; tests: files that see it."""

    subject: str
    what: str
    path: str
    right: str
    wrong: str
    tests: str


FAULTS = [
    *starmap(
        Fault,
        (
            (
                "wall",
                "every second course starts with the wrong half",
                "damage/wall/plan.py",
                "if (course % 2 == 1) != (",
                "if (course % 2 == 1) == (",
                "test_layout",
            ),
            (
                "wall",
                "inertia of a brick by m (l^2 + h^2) / 6",
                "damage/wall/tables.py",
                "mass * (length * length + height * height) / 12",
                "mass * (length * length + height * height) / 6",
                "test_layout",
            ),
            (
                "wall",
                "a whole brick in series with a base joint",
                "damage/wall/kinds.py",
                "        brick.height / 2\n",
                "        brick.height\n",
                "test_layout test_modes",
            ),
            (
                "wall",
                "strengths that scatter have a mean above one",
                "damage/wall/contact_points.py",
                "exp(spread * normal - spread * spread / 2)",
                "exp(spread * normal)",
                "test_layout test_members",
            ),
            (
                "wall",
                "the critical time step is half as long",
                "damage/linear/modes.py",
                "down_to_three_digits(2 / np.sqrt(rate))",
                "down_to_three_digits(1 / np.sqrt(rate))",
                "test_modes",
            ),
            (
                "wall",
                "a joint ends at the wrong edge of the other face",
                "damage/wall/kinematics.py",
                "np.where(on_ground, -np.inf, start - other_end)",
                "np.where(on_ground, -np.inf, start - other_start)",
                "test_ends",
            ),
            (
                "law",
                "friction falls under compression",
                "damage/law/joint_law.py",
                "abs(shear_stress) < cohesion - normal_stress * friction",
                "abs(shear_stress) < cohesion + normal_stress * friction",
                "test_joint_law",
            ),
            (
                "law",
                "friction work by the stress after the step alone",
                "damage/law/joint_law.py",
                "friction_work += 0.5 * (before + limit) * beyond / ks",
                "friction_work += limit * beyond / ks",
                "test_joint_law test_reference",
            ),
            (
                "law",
                "slip softens by the tensile fracture energy",
                "damage/law/joint_law.py",
                "AREA * parameters.cohesion / parameters.mode_ii_energy",
                "AREA * parameters.cohesion / parameters.mode_i_energy",
                "test_joint_law",
            ),
            (
                "law",
                "crushing takes the full strength from its first step",
                "damage/law/joint_law.py",
                "state.closure + more, 0.5 * (before + left) * more",
                "state.closure + more, left * more",
                "test_joint_law",
            ),
            (
                "law",
                "a bond fails at twice its tensile strength",
                "damage/law/joint_law.py",
                "TENSION if sigma > strength else",
                "TENSION if sigma > 2 * strength else",
                "test_joint_law",
            ),
            (
                "step",
                "the base pushes bodies the wrong way",
                "damage/mechanics/bodies.py",
                "either(free > 0.0, force * free - field, 0.0)",
                "either(free > 0.0, force * free + field, 0.0)",
                "test_reference",
            ),
            (
                "step",
                "forces act at one of the two material points",
                "damage/mechanics/interfaces.py",
                "line.bx + dbx - 0.5 * dx",
                "line.bx + dbx",
                "test_grid",
            ),
            (
                "step",
                "the couple of an interface acts on one of its bodies alone",
                "damage/mechanics/interfaces.py",
                "frame.arm_bx * z - frame.arm_bz * x + couple",
                "frame.arm_bx * z - frame.arm_bz * x",
                "test_reference",
            ),
            (
                "step",
                "moments on both bodies alike",
                "damage/mechanics/rows.py",
                "(-x, -z, -either(which, forces.moment_b, 0.0))",
                "(-x, -z, -either(which, forces.moment_a, 0.0))",
                "test_reference",
            ),
            (
                "step",
                "walls that end count their interfaces twice, among eight",
                "damage/mechanics/step.py",
                "            intact = intact & flags_of(n, everyone ^ ending)",
                "            intact = intact & flags_of(n, everyone)",
                "test_together",
            ),
            (
                "step",
                "a joint that ends loses all its energy to friction",
                "damage/mechanics/contacts.py",
                "add(n, energy, 0, FRICTION, 0.5 * tau * (tau / ks + slid))",
                "add(n, energy, 0, FRICTION, tau * (tau / ks + slid))",
                "test_ends",
            ),
            (
                "step",
                "viscous damping drives the shear motion",
                "damage/mechanics/interfaces.py",
                "resultant.shear + rate * elastic_change.shear,",
                "resultant.shear - rate * elastic_change.shear,",
                "test_reference",
            ),
            (
                "run",
                "the default step may reach the damped limit",
                "damage/run/schedule.py",
                "0.85 * limit",
                "1.0 * limit",
                "test_run",
            ),
            (
                "run",
                "a brick has fallen after its whole height",
                "damage/run/monitor.py",
                "-layout.bodies.height[: layout.n_bricks] / 2",
                "-layout.bodies.height[: layout.n_bricks]",
                "test_run",
            ),
            (
                "run",
                "all events of a sequence have the strength of the first",
                "damage/run/schedule.py",
                "to_grid(event.factor * in_plane,",
                "to_grid(in_plane,",
                "test_sequence test_run",
            ),
            (
                "run",
                "a harmonic motion starts at its peak",
                "damage/motion/loading.py",
                "sin_of_turns(time_s / self.period_s)",
                "sin_of_turns(time_s / self.period_s + 0.25)",
                "test_loading",
            ),
            (
                "run",
                "weight counts twice in the unbalanced force",
                "damage/run/monitor.py",
                "on_bodies[:, 1] - GRAVITY * layout.bodies.mass",
                "on_bodies[:, 1] - 2 * GRAVITY * layout.bodies.mass",
                "test_run",
            ),
            (
                "index",
                "joints count as open from 0.2 mm",
                "damage/index.py",
                "THRESHOLD = 0.1 * MILLIMETRE",
                "THRESHOLD = 0.2 * MILLIMETRE",
                "test_measures",
            ),
            (
                "index",
                "opening and slip add up",
                "damage/index.py",
                "return 1 - (1 - drift) * (1 - opened) * (1 - slipped)",
                "return 1 - (1 - drift) * (1 - opened - slipped)",
                "test_measures",
            ),
            (
                "index",
                "fractions of the joints that are given, not of all",
                "damage/index.py",
                "(np.sum(length) if total_length is None else total_length)",
                "np.sum(length)",
                "test_measures test_history",
            ),
            (
                "index",
                "slip to one side does not count",
                "damage/index.py",
                "np.abs(slip) > threshold",
                "np.asarray(slip) > threshold",
                "test_measures",
            ),
            (
                "measures",
                "Psi with another exponent of the number of cracks",
                "damage/measure/cracks.py",
                "** 0.15 *",
                "** 0.3 *",
                "test_cracks",
            ),
            (
                "measures",
                "the mean width is weighted by length alone",
                "damage/measure/cracks.py",
                "np.divide(width**2 @ length, weight,",
                "np.divide(width @ length, weight,",
                "test_cracks",
            ),
            (
                "measures",
                "the energy balance leaves damping out",
                "damage/measure/energy.py",
                "for name in (*STORED, *DISSIPATED))\n    total = total -",
                "for name in (*STORED, *DISSIPATED[:2]))\n    total = total -",
                "test_measures",
            ),
            (
                "measures",
                "driven cycles end before the motion does",
                "damage/measure/cycles.py",
                "begins_driven = cycles[:, 0] <= _motion_end(series)",
                "begins_driven = cycles[:, 1] <= _motion_end(series)",
                "test_measures",
            ),
            (
                "measures",
                "ripples around zero count as cycles",
                "damage/measure/cycles.py",
                "REARM = 0.02",
                "REARM = 0.0",
                "test_measures",
            ),
            (
                "studies",
                "intervals of few records too narrow",
                "damage/applications/studies/fragility.py",
                "np.sqrt(n / (n - 1)) * stdtrit",
                "np.sqrt((n - 1) / n) * stdtrit",
                "test_fragility",
            ),
            (
                "studies",
                "a wall that collapsed does not exceed",
                "damage/applications/studies/fragility.py",
                '(runs[measure] > level) | runs["collapsed_at_s"].notna()',
                "runs[measure] > level",
                "test_fragility",
            ),
            (
                "studies",
                "the fit's slope has the wrong sign",
                "damage/applications/studies/fragility.py",
                "- (n - y) * np.exp(density - above)",
                "+ (n - y) * np.exp(density - above)",
                "test_fragility",
            ),
            (
                "studies",
                "the last value of a range is left out",
                "damage/applications/studies/grid.py",
                'values["from"] + MOST_POINTS) + 1)',
                'values["from"] + MOST_POINTS))',
                "test_ensembles",
            ),
            (
                "YADE",
                "the energy that an opening joint held is counted twice",
                "yade_scripts/joint_tracker.py",
                "np.abs(self._stress[joints]) ** 2 / (2 * self.shear_stiffness[joints])",
                "np.abs(self._stress[joints]) ** 2 / self.shear_stiffness[joints]",
                "test_joint_tracker",
            ),
            (
                "YADE",
                "slip continues while a joint is open",
                "yade_scripts/joint_tracker.py",
                "np.where(stays_closed, plastic - self._plastic[joints], 0.0)",
                "plastic - self._plastic[joints]",
                "test_joint_tracker",
            ),
            (
                "step",
                "a shear displacement pulls the bodies further apart",
                "damage/mechanics/interfaces.py",
                "        springs.ks * motion.shear,\n",
                "        -springs.ks * motion.shear,\n",
                "test_reference",
            ),
            (
                "step",
                "a bond that fails gives its energy twice",
                "damage/mechanics/contacts.py",
                "FRACTURE, -0.5 * work)",
                "FRACTURE, 0.5 * work)",
                "test_reference test_grid",
            ),
            (
                "split",
                "tension along a brick keeps it from splitting",
                "damage/mechanics/contacts.py",
                "diagonal_tension(cuts.strength[n.lane], sigma)",
                "diagonal_tension(cuts.strength[n.lane], -sigma)",
                "test_crushing",
            ),
            (
                "lanes",
                "what ends in one wall ends in the first of eight",
                "damage/reference/lanes.py",
                "walls[np.searchsorted(steps, of_wall)] |= 1 << lane",
                "walls[np.searchsorted(steps, of_wall)] |= 1",
                "test_together test_ends",
            ),
            (
                "lanes",
                "samples of all eight walls are those of the first",
                "damage/reference/lanes.py",
                "return self._sampling.samples.of_wall(self.lane_of(wall), count)",
                "return self._sampling.samples.of_wall(0, count)",
                "test_together",
            ),
            (
                "run",
                "a run that continues forgets that its base is driven",
                "damage/reference/solver.py",
                'bool(tables["is_driven"])',
                "False",
                "test_checkpoint test_before",
            ),
            (
                "run",
                "a run that continues begins with intact joints",
                "damage/reference/solver.py",
                "            getattr(self.system, name)[:] = state[name]\n",
                "            pass\n",
                "test_before",
            ),
            (
                "run",
                "the middle rises where the ground sags",
                "damage/motion/settlement.py",
                'if self.profile == "hogging" else -deflection',
                'if self.profile == "hogging" else deflection',
                "test_settlement",
            ),
            (
                "wall",
                "drift over the height of the wall, not of its course",
                "damage/wall/layout.py",
                "drift_height=float(bodies.z[drift_bodies].mean())",
                "drift_height=float(wall.built_height)",
                "test_outlines",
            ),
            (
                "wall",
                "a floor's mass goes to bricks by their number",
                "damage/wall/floors.py",
                "factor = 1 + more / bodies.mass",
                "factor = 1 + more / bodies.mass.mean()",
                "test_floors",
            ),
            (
                "house",
                "a floor is half as heavy",
                "damage/house/layout.py",
                "mass = floor.mass_per_area * length * across",
                "mass = floor.mass_per_area * length * across / 2",
                "test_house",
            ),
            (
                "house",
                "a corner's joints are as stiff as their points alone",
                "damage/house/corners.py",
                "span[k, v] * su * sv",
                "span[k, v] * su * su",
                "test_house",
            ),
            (
                "house",
                "the inside of a wall has the cracks of the outside",
                "damage/history/parts.py",
                '(1 if face == "outside" else -1)',
                '(-1 if face == "outside" else 1)',
                "test_house_views",
            ),
            (
                "motion",
                "a record in mg is ten times as strong",
                "damage/motion/columns.py",
                '"mg": GRAVITY / 1000',
                '"mg": GRAVITY / 100',
                "test_formats test_records",
            ),
            (
                "motion",
                "another component starts with its own first sample",
                "damage/motion/record.py",
                "first = round(late_s / step_s)",
                "first = 0",
                "test_records",
            ),
            (
                "index",
                "slip counts from twice the threshold",
                "damage/index.py",
                "np.abs(slip) > threshold",
                "np.abs(slip) > 2 * threshold",
                "test_measures",
            ),
            (
                "measures",
                "cracked joints count with half of their length",
                "damage/measure/cracks.py",
                '"crack_length_m": is_cracked @ length',
                '"crack_length_m": is_cracked @ length / 2',
                "test_cracks",
            ),
            (
                "measures",
                "twice the tested drift is inside the range of validity",
                "damage/measure/evidence.py",
                "self.most * (1 + _ROUNDING)",
                "2 * self.most * (1 + _ROUNDING)",
                "test_evidence",
            ),
            (
                "claims",
                "a wall that differs more from a survey has more weight",
                "damage/applications/groningen/claim/likeness.py",
                "np.exp(-((distance / KERNEL) ** 2) / 2)",
                "np.exp(((distance / KERNEL) ** 2) / 2)",
                "test_claim",
            ),
            (
                "claims",
                "the prior counts the same in both worlds",
                "damage/applications/groningen/claim/answer.py",
                "[[prior], [1 - prior]]",
                "[[prior], [prior]]",
                "test_claim",
            ),
            (
                "YADE",
                "joints count as open from any opening on",
                "yade_scripts/joint_tracker.py",
                "(value > self.threshold) & ~self._passed",
                "(value > 0) & ~self._passed",
                "test_joint_tracker",
            ),
            (
                "YADE",
                "friction work by the stress after the step alone",
                "yade_scripts/joint_tracker.py",
                "mean_stress = (np.abs(tau) + np.abs(self._stress[joints])) / 2",
                "mean_stress = np.abs(tau)",
                "test_joint_tracker",
            ),
            (
                "motion",
                "times off the grid by a tenth of a step count as uniform",
                "damage/motion/columns.py",
                "TIME_TOLERANCE = 0.01",
                "TIME_TOLERANCE = 0.1",
                "test_formats",
            ),
            (
                "history",
                "a history of which a byte has changed is whole",
                "damage/history/head.py",
                "if digest != head.sealed:",
                "if digest[-8:] != head.sealed[-8:]:",
                "test_history",
            ),
            (
                "options",
                "numbers up to twice their limit pass",
                "damage/fields.py",
                'check_range(what, value, expected["least"], expected["most"])',
                'check_range(what, value, expected["least"], 2 * expected["most"])',
                "test_fields",
            ),
            (
                "studies",
                "runs of other inputs count as done",
                "damage/applications/studies/outdated.py",
                "else differences(then, inputs)\n",
                "else []\n",
                "test_outdated",
            ),
            (
                "studies",
                "runs of another model are not named",
                "damage/applications/studies/outdated.py",
                'row["model_digest"] != model_digest(code)',
                'not row["model_digest"]',
                "test_outdated",
            ),
            (
                "verdict",
                "a claim holds where its criterion is missed",
                "paper/verdict.py",
                "verdict = HOLDS if margin >= 0 else DIFFERS",
                "verdict = HOLDS if margin <= 0 else DIFFERS",
                "test_paper",
            ),
            (
                "pictures",
                "intact joints are drawn as cracked",
                "damage/draw/wall.py",
                "chosen & ~self.elastic if state == ",
                "~chosen & ~self.elastic if state == ",
                "test_pictures",
            ),
            (
                "lives",
                "strata count by the lives that ran, not by their probability",
                "damage/applications/groningen/life/estimate.py",
                "weight @ (counts / count)",
                "counts.sum() / n",
                "test_life",
            ),
            (
                "exposure",
                "events are independent in the site term, too",
                "damage/applications/groningen/exposure/exposure.py",
                "[:, np.newaxis] - site * nodes",
                "[:, np.newaxis] - 0 * nodes",
                "test_exposure",
            ),
            (
                "cracks",
                "equivalent damping of a loop is half as large",
                "damage/applications/cracks/loops.py",
                "lost / (4 * np.pi * stored)",
                "lost / (8 * np.pi * stored)",
                "test_hysteresis",
            ),
        ),
    )
]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("subjects", nargs="*", metavar="SUBJECT")
    parser.add_argument("--table", type=Path, metavar="FILE", help="CSV to write")
    asked = parser.parse_args()
    if unknown := {*asked.subjects} - {fault.subject for fault in FAULTS}:
        parser.error(
            f"no subject {min(unknown)}; expected some of"
            f" {', '.join({fault.subject: 0 for fault in FAULTS})}"
        )
    faults = [fault for fault in FAULTS if not asked.subjects or fault.subject in asked.subjects]
    with tempfile.TemporaryDirectory() as folder:
        rows = list(attack(faults, Path(folder)))
    undetected = [what for _, what, _, test in rows if not test]
    if asked.table:
        with asked.table.open("w", newline="", encoding="utf-8") as out:
            csv.writer(out, lineterminator="\n").writerows(
                [("subject", "fault", "file", "detected by"), *rows]
            )
    print(f"{len(rows) - len(undetected)} of {len(rows)} faults detected")
    return 1 if undetected else 0


def attack(faults, folder):
    """Rows (subject, what, path, test) of each fault, seeded alone; the test is "" where none of
    those named fails."""
    files = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    subprocess.run(
        ["tar", "cf", str(folder / "copy.tar"), "-T", "-"],
        cwd=ROOT,
        input=files,
        text=True,
        check=True,
    )
    subprocess.run(["tar", "xf", "copy.tar"], cwd=folder, check=True)
    if failed := first_failure(
        folder, sorted({test for fault in faults for test in fault.tests.split()}), False
    ):
        raise SystemExit(f"{failed} fails without a fault: correct it first")
    for fault in faults:
        path = folder / fault.path
        text = path.read_text(encoding="utf-8")
        if fault.right not in text:
            raise SystemExit(f"{fault.path} has no {fault.right!r}: correct FAULTS")
        path.write_text(text.replace(fault.right, fault.wrong), encoding="utf-8")
        test = first_failure(folder, fault.tests.split())
        path.write_text(text, encoding="utf-8")
        print(f"{fault.subject:9} {fault.what}: {test or 'NOT DETECTED'}", flush=True)
        yield fault.subject, fault.what, fault.path, test


def first_failure(folder, tests, stop=True):
    """The first test that fails, as FILE::NAME, "" where all pass."""
    files = [str(next(Path(folder, "tests").rglob(f"{test}.py"))) for test in tests]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *["-x"] * stop, "-p", "no:cacheprovider", *files],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    failed = re.search(r"^(?:FAILED|ERROR) tests/(\S+)", done.stdout, re.MULTILINE)
    if done.returncode not in (0, 1, 2):
        raise SystemExit(
            "pytest ended with status"
            f" {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}"
        )
    return failed[1] if failed else ""


if __name__ == "__main__":
    sys.exit(main())
