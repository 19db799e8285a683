"""Commands about motions."""

import sys

from damage.commands.table import JSON, arg, command, file_arg, group, output, show
from damage.errors import InputError, warn
from damage.motion.loading import PERIODS_S
from damage.run.options import add_preparation, number_from, recorded
from damage.run.plausible import implausible_motion


@command("intensity measures of a ground-motion record as a run with these options applies it: nothing is filtered "
         "unless --band is given", file_arg("record", "FILE|NAME", "CSV or plain text (time_s and acc_m_s2, acc_cm_s2, "
         "acc_gal or acc_g; or --unit; semicolons and decimal commas are read), PEER AT2, miniSEED, or a record that "
         "ships, as BGAR_HGE"), group("preparation of the record", add_preparation, arg(
             "--period", type=number_from(*PERIODS_S), metavar="T1_S", help="first period of a wall (of `modes`): "
             "also Sa there, of the motion as that wall gets it, interpolated where its steps are coarse")),
         JSON, output(file_arg("--plot", "FILE.png", "write a picture: acceleration, velocity and response spectrum")))
def _record(asked):
    from damage.motion.intensity import describe, motion_summary
    from damage.motion.plausible import faint_warnings, implausible_peak, implausible_velocity

    loading = recorded(asked)
    if asked.period is not None:
        loading = loading.for_period(asked.period)
    found = motion_summary(loading, asked.period)
    warn(*implausible_motion(loading), *filter(None, (
        implausible_peak(found["pga_g"]), implausible_velocity(found["pgv_cm_s"] / 100))),
         *faint_warnings(found["pga_g"]))
    if asked.plot:
        _plot_motion(loading, found, asked.plot)
    show(asked, found, describe)


def _plot_motion(loading, found, path):
    """Write the picture of a motion; its path goes to stderr: stdout may be JSON."""
    from damage.draw.motion import motion_picture
    from damage.draw.style import save_png

    if path.suffix.lower() != ".png":
        raise InputError(f"--plot {path}: expected a name that ends in .png; give it one")
    print(f"picture: {save_png(motion_picture(loading, found), path, f'motion {loading.name}')}", file=sys.stderr)
