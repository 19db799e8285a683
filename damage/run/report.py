"""What a finished run leaves beside its history: a summary on the screen, tables and pictures."""

import sys

from damage.errors import InputError, one_line
from damage.measure.doubts import static_doubts
from damage.measure.summary import summarise
from damage.run.options import pictures_folder
from damage.wall.lintel import ElasticShare, describe_share


def report(history, pictures=True):
    """Print the summary of a History; write its pictures beside it.

    The history is complete by then: whatever fails here is told and loses nothing.
    """
    path = history.path
    if len(history.series) == 0:
        warn(static_doubts(history))
        print(f"{history.status}: no sample was written")
        return
    summary = summarise(history)
    warn(summary["warnings"])
    print(describe(summary))
    if pictures:
        try:
            from damage.draw.run import save_all

            for picture in save_all(history, pictures_folder(path)):
                print(f"picture: {picture}")
        except Exception as error:
            print(f"warning: the history is whole, its pictures failed ({one_line(error)}); "
                  f"try: python3 -m damage plot {path} --out {pictures_folder(path)}", file=sys.stderr)


def check_pictures(path, overwrite=False):
    """Raise InputError where pictures of a new run with the history `path` would go among what is there already."""
    folder = pictures_folder(path)
    if not overwrite and folder.is_dir() and next(folder.iterdir(), None) is not None:
        raise InputError(f"{folder} is not empty, and the pictures of {path.name} would go there: give another --out, "
                         "--no-pictures, or --overwrite to replace what has their names")


def warn(warnings):
    """Print warnings, a line each."""
    for warning in warnings:
        print(f"warning: {warning}", file=sys.stderr)


def describe(summary):
    """The summary as lines for people."""
    lines = [f"{summary['wall']} / {summary['motion']} / {summary['solver']}: {summary['status']}"
             + (f", collapsed at {summary['collapsed_at_s']:.3f} s" if summary["collapsed_at_s"] else "")]
    lines.append(f"{'slip by ' + summary['slip']:22s}{'DI':>8s}{'drift':>8s}{'open':>8s}{'slip':>8s}")
    for key, label in (("max", "maximum"), ("residual", "residual"),
                       ("max_accumulated", "maximum, accumulated"),
                       ("residual_accumulated", "residual, accumulated"),
                       ("max_shear_limit", "maximum, shear limit"),
                       ("residual_shear_limit", "residual, shear limit")):
        if summary[key] is not None:
            lines.append(f"{label:22s}" + "".join(f"{value:8.4f}" for value in summary[key].values()))
    lines.append(describe_share(ElasticShare(summary["elastic_joint_share"],
                                             summary["elastic_joint_share_above_openings"])))
    lines.append(f"drift ratio up to {100 * summary['max_drift_ratio']:.4f} %, base shear up to "
                 f"{summary['peak_base_shear_n'] / 1e3:.2f} kN, opening up to "
                 f"{summary['max_opening_mm']:.3f} mm, "
                 + ("" if summary["max_offset_mm"] is None else f"offset up to {summary['max_offset_mm']:.3f} mm, ")
                 + f"accumulated slip up to {summary['max_slip_mm']:.3f} mm")
    lines.append(f"{summary['tension_breaks']} tension and {summary['shear_breaks']} shear breaks, Psi up to "
                 f"{summary['max_psi']:.2f} ({summary['psi_class']}; cracks from {summary['psi_from_mm']:g} mm), "
                 f"friction and fracture took {summary['dissipated_energy_j']:.3g} J")
    if summary["pgv_m_s"] is not None and summary["avg_sa_g"] is not None:
        lines.append(f"motion as applied: PGV {summary['pgv_m_s']:.3g} m/s, AvgSa {summary['avg_sa_g']:.3g} g, "
                     f"Arias intensity {summary['arias_m_s']:.3g} m/s")
    if summary["period_elongation"] is not None:
        lines.append(f"first free cycle {summary['first_free_cycle_s']:.3f} s, "
                     f"{summary['period_elongation']:.2f} of the intact wall's period")
    if summary["energy_error_fraction"] is not None:
        lines.append(f"energy error {100 * summary['energy_error_fraction']:.3f} % of the input")
    if summary["peak_force_n"] is not None:
        lines.append(f"peak force {summary['peak_force_n'] / 1e3:.1f} kN at "
                     f"{100 * summary['drift_at_peak_force']:.4f} % drift; stiffness "
                     f"{summary['initial_stiffness_n_per_m'] / 1e6:.1f} kN/mm at first, "
                     f"{summary['secant_stiffness_n_per_m'] / 1e6:.1f} kN/mm to 0.7 of the peak")
    if summary["period_s"] is not None:
        lines.append(f"period of the free vibration {summary['period_s']:.4f} s")
    return "\n".join(lines)
