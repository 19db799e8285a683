"""What is odd about a run, so that a reader may doubt its numbers: a line each."""

from damage.measure.validity import offset_over_overlap
from damage.wall.lintel import warn_of_share

AT_REST = 1e-5
"""Unbalanced force below which the static stage is over [-]."""
ENERGY_ERROR, ENERGY_FAILURE = 0.03, 1.0
"""Energy errors [-] above which a run is warned of, and above which it has failed.

Of the runs of `docs/tables` standing walls have up to 0.021 in YADE and 0.0042 in the reference solver, falling ones
up to 0.25 and 0.016; the bounds lie above the standing walls, and where the error is all that came in.
"""


def doubts(history, energy_error, share):
    """What is odd about a History, whose energy error, None where it has none, and damage.wall.lintel.ElasticShare are
    given: a list of str."""
    return [*static_doubts(history), *energy_doubts(energy_error), *offset_doubts(history), *normal_doubts(history),
            *warn_of_share(share), *warn_of_overlap(history)]


def static_doubts(history):
    """What is odd about the start of a run: broken joints, or a wall not at rest."""
    static, found = history.static, []
    if static["broken_joints"] > 0:
        found.append(f"{static['broken_joints']:.0f} contact points broke under gravity, before the motion")
    if static["unbalanced_force"] > AT_REST:
        found.append(f"the motion began before the wall was at rest: unbalanced force "
                     f"{static['unbalanced_force']:.2g}, expected below {AT_REST:g}")
    return found


def energy_doubts(error):
    """What is odd about a run's energy error [-], None where there is none."""
    if error is None or error <= ENERGY_ERROR:
        return []
    return [f"energy error {100 * error:.3g} % of the input, expected up to {100 * ENERGY_ERROR:g} %: do not trust "
            "this run; give a smaller --dt"]


def offset_doubts(history):
    """What is said of a run whose file has no offsets: everywhere where slip by displacement is shown."""
    if history.told.offset_m is not None:
        return []
    return ["the history has no offsets of its joints (schema version 1 or 2): slip by displacement is judged by "
            "accumulated, in crack widths and Psi, too; for offsets run the wall again"]


def warn_of_overlap(history):
    """A warning where a joint has slid beyond the end of its faces."""
    found = offset_over_overlap(history)
    if found is None or found[0] < 1:
        return []
    share, row, sample = found
    joint, time_s = history.joints.iloc[row], history.series["time_s"].iloc[sample]
    return [f"the {joint['kind']} joint at x = {joint['x_m']:.2f} m, z = {joint['z_m']:.2f} m slid to {share:.2f} of "
            f"the overlap of its faces (t = {time_s:.2f} s): beyond 1 a joint has ended, bricks find no new contacts, "
            "and what the run says from there on is not valid"]


def normal_doubts(history):
    """What is said of a run in YADE whose joints leant."""
    if history.joint_normals == "face":
        return []
    return ["joints between the centres of cells, as in YADE before version 0.2: a joint that slides leans; this "
            "version has joints by face alone"]
