"""What a finished run leaves beside its history: a summary on the screen, tables and pictures."""

import sys

from damage.history.reader import read_history
from damage.measure.summary import summarise
from damage.run.settings import AT_REST

ENERGY_ERROR = 0.03
"""Energy error [-] above which a run is warned of: standing walls of the studies have up to 0.021."""


def report(path, pictures=True):
    """Print the summary of the history at `path`; write its tables and pictures beside it.

    The history is complete by then: whatever fails here is told and loses nothing.
    """
    history = read_history(path)
    for warning in static_warnings(history):
        print(f"warning: {warning}", file=sys.stderr)
    if len(history.series) == 0:
        print(f"{history.status}: no sample was written")
        return
    summary = summarise(history)
    for warning in energy_warnings(summary["energy_error_fraction"]):
        print(f"warning: {warning}", file=sys.stderr)
    print(describe(summary))
    if pictures:
        try:
            from damage.draw.run import save_all

            folder = path.with_suffix("")
            for picture in save_all(history, folder):
                print(f"picture: {picture}")
        except Exception as error:
            print(f"warning: the history is whole, its pictures failed ({error}); "
                  f"try: python3 -m damage plot {path} --out {path.with_suffix('')}", file=sys.stderr)


def static_warnings(history):
    """What is odd about the start of a run, a line each: broken joints, or a wall not at rest."""
    static, warnings = history.static, []
    if static["broken_joints"] > 0:
        warnings.append(f"{static['broken_joints']:.0f} contact points broke under gravity, before the motion")
    if static["unbalanced_force"] > AT_REST:
        warnings.append(f"the motion began before the wall was at rest: unbalanced force "
                        f"{static['unbalanced_force']:.2g}, expected below {AT_REST:g}")
    return warnings


def energy_warnings(error):
    """What is odd about a run's energy error [-], None where there is none: a list of str."""
    if error is None or error <= ENERGY_ERROR:
        return []
    return [f"energy error {100 * error:.3g} % of the input, expected up to {100 * ENERGY_ERROR:g} %: do not trust "
            "this run; give a smaller --dt"]


def describe(summary):
    """The summary as lines for people."""
    lines = [f"{summary['wall']} / {summary['motion']} / {summary['solver']}: {summary['status']}"
             + (f", collapsed at {summary['collapsed_at_s']:.3f} s" if summary["collapsed_at_s"] else "")]
    lines.append(f"{'':22s}{'DI':>8s}{'drift':>8s}{'open':>8s}{'slip':>8s}")
    for key, label in (("max", "maximum"), ("residual", "residual"),
                       ("max_shear_limit", "maximum, shear limit"),
                       ("residual_shear_limit", "residual, shear limit")):
        if summary[key] is not None:
            lines.append(f"{label:22s}" + "".join(f"{value:8.4f}" for value in summary[key].values()))
    lines.append(f"drift ratio up to {100 * summary['max_drift_ratio']:.4f} %, base shear up to "
                 f"{summary['peak_base_shear_n'] / 1e3:.2f} kN, opening up to "
                 f"{summary['max_opening_mm']:.3f} mm, slip up to {summary['max_slip_mm']:.3f} mm")
    lines.append(f"{summary['tension_breaks']} tension and {summary['shear_breaks']} shear breaks, Psi up to "
                 f"{summary['max_psi']:.2f} ({summary['psi_class']}), friction and fracture took "
                 f"{summary['dissipated_energy_j']:.3g} J")
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
