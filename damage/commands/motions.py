"""Commands about motions."""

import sys

from damage.commands.table import JSON, command, file_arg, group, output, show
from damage.errors import InputError, warn
from damage.run.options import add_preparation, recorded


@command("intensity measures of a ground-motion record as a run with these options applies it: nothing is filtered "
         "unless --band is given", file_arg("record", "FILE|NAME", "CSV or plain text (time_s and acc_m_s2, acc_cm_s2, "
         "acc_gal or acc_g; semicolons and decimal commas are read), PEER AT2, miniSEED, or a record that ships, as "
         "BGAR_HGE"), group("preparation of the record", add_preparation), JSON,
         output(file_arg("--plot", "FILE.png", "write a picture: acceleration, velocity and response spectrum")))
def _record(asked):
    from damage.motion.intensity import describe, motion_summary
    from damage.motion.plausible import implausible_peak

    loading = recorded(asked)
    found = motion_summary(loading)
    if implausible := implausible_peak(found["pga_g"]):
        warn(implausible)
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
