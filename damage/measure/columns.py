"""Columns of summary.csv and points.csv that say which run it was: name, unit and meaning.

They are tables of `docs/reference/measures.md`, as `damage.measure.summary.MEASURES`.
`damage.measure.tables` computes their values, and `damage.applications.studies.tables` the medians
and ranges of a point.
"""

from dataclasses import fields

from damage.history.schema import Column
from damage.wall.model_options import ModelOptions


def _model(seeds):
    """Columns of the options of ModelOptions, of those that seed draws or of the others."""
    return {
        attribute.name: Column("", attribute.metadata["help"])
        for attribute in fields(ModelOptions)
        if attribute.metadata["seed"] == seeds
    }


PARAMETERS = {
    "point": Column("", "point of a study that the run belongs to"),
    "solver": Column("", "yade or reference"),
    "wall": Column("", "name of the wall"),
    "motion": Column("", "name of the loading"),
    "record": Column("", "name of the record"),
    "record_unit": Column(
        "", "unit that the record's samples were taken to be in, and what says so"
    ),
    "record_pga_g": Column(
        "g", "peak of the horizontal record times its scale, before it is interpolated for a wall"
    ),
    "pga_g, sa_0.2_s_g": Column(
        "g", "of the horizontal motion as applied: peak, and 5 % spectral at 0.2 s"
    ),
    "pgv_m_s": Column("m/s", "peak velocity of the base, from rest, nothing filtered"),
    "pgv_rotd100_m_s": Column(
        "m/s",
        "the same in the direction in which it is largest (RotD100), of the record and "
        "its other component (`--across`); empty without it",
    ),
    "avg_sa_g": Column(
        "g",
        "AvgSa: geometric mean of the 5 % spectral accelerations at ten periods from 0.01 to 1 s, "
        "equally far apart in their logarithm",
    ),
    "sa_eigen_period_g": Column("g", "5 % spectral at `eigen_period_s`"),
    "arias_m_s": Column(
        "m/s", "Arias intensity, pi / (2 g) times the integral of the squared acceleration"
    ),
    "d5_75_s, d5_95_s": Column(
        "s", "significant duration: between 5 and 75 %, 5 and 95 % of the Arias intensity"
    ),
    "settlement, distortion": Column(
        ", 1",
        "of the ground before the motion: profile or its file, and the angular "
        "distortion of a named profile",
    ),
    "motion_period_s, amplitude_g": Column("s, g", "of a harmonic motion"),
    "cycles": Column("1", "of a harmonic motion, or at each drift of a pushed top"),
    "speed_m_s": Column("m/s", "of a pushed top"),
    "scale": Column("1", "factor on the record"),
    "window_start_s, window_end_s": Column("s", "part of the record that was used"),
    "lost_by_lines": Column(
        "1",
        "of a record in steps of more than a tenth of `eigen_period_s`, which is "
        "interpolated, band-limited: share of the motion at that period that lines between its "
        "samples would take off; empty where samples are taken as they are",
    ),
    "vertical": Column("1", "1 with the record's vertical component, else 0"),
    "shocks": Column("1", "how many, of a sequence"),
    "motion_duration_s, rest_s": Column(
        "s", "of the base's motion, and of the free vibration after it"
    ),
    **_model(seeds=False),
    "alpha_1_s, beta_s": Column("1/s, s", "damping proportional to mass, and to stiffness"),
    "scatter": Column(
        "1", "coefficient of variation of the strengths, by which the members of an ensemble differ"
    ),
    "mode_i_fracture_energy_j_m2, mode_ii_fracture_energy_j_m2": Column(
        "J/m2", "of the joints, 0 where brittle"
    ),
    "time_step_s": Column("s", "of the solver, in points.csv that of the first run"),
    "eigen_period_s": Column("s", "first period of the intact wall, by its eigenvalues"),
    "slip": Column("", "criterion of slip in the columns that name none, cracks and Psi included"),
    "psi_from_mm": Column("mm", "width from which a crack counts in crack widths and Psi"),
    "total_joint_length_m": Column("m", "of all contact points, bricks' cuts left out"),
    "elastic_joint_share": Column(
        "1",
        "length of joints that are elastic by `lintel` and cannot fail, over the length "
        "of all joints",
    ),
    "elastic_joint_share_above_openings": Column(
        "1",
        "the same share of the courses above openings, along the whole "
        "wall; empty without openings",
    ),
}
"""{names: Column} of the parameters that are equal in all runs of a point, but for the motions of
lives and the walls of samples: of those that differ a point has median and range."""
OF_THE_FIRST = "time_step_s"
"""Column of which a point has the value of its first run."""
RUN = {
    "run": Column("", "name of the run"),
    "status": Column("", "complete, interrupted, failed, unfinished"),
    "outside_validity": Column(
        "",
        "quantities of the run outside the range of validity, each with value and range; "
        "empty where all are inside",
    ),
    "mass_scaling": Column(
        "",
        "none, or selective: with masses that grow with the intact wall's stiffness; lintels: with"
        " those of lintels alone",
    ),
    "repeats": Column(
        "1",
        "how often the run was repeated in smaller steps until it was accepted; `mass_scaling` and "
        "`time_step_s` are of the last one",
    ),
    "repeated_for": Column(
        "", "why it was repeated last: energy (balance), drop (of a brick), failure (any other)"
    ),
    "collapsed_at_s": Column("s", "when a brick had dropped by half its height"),
    **_model(seeds=True),
    "seed": Column("1", "of the bricks' random offsets and of `scatter`"),
}
"""{names: Column} of the parameters that differ between the runs of a point, and of their end."""
MADE_BY = {
    "software": Column("", "version of this software"),
    "commit": Column("", "of its repository; `changed` where the tree differed"),
    "model_digest": Column(
        "", "of the code of the model in this solver: runs with equal ones can be compared"
    ),
    "measures_digest": Column(
        "",
        "of the code of index and measures, which made the row: rows with equal ones can be "
        "compared",
    ),
}
"""{name: Column} of the origin of a run; in points.csv of all its runs."""
