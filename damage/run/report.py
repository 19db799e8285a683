"""Output of a finished run beside its history: a printed summary, tables and pictures."""

from shlex import quote

from damage.errors import InputError, one_line, warn
from damage.measure.cycles import shocks_table
from damage.measure.evidence import describe as describe_evidence
from damage.measure.house import describe as describe_together
from damage.measure.house import house_summary
from damage.measure.summary import summarise
from damage.measure.warnings import warnings_of
from damage.run.options import SUMMARY
from damage.run.paths import pictures_folder
from damage.units import rounded
from damage.wall.lintels import ElasticShare, describe_share


def report(history, pictures=True):
    """Print the summary of a History; write its pictures beside it.

    The history is complete by then: whatever fails here is reported and loses nothing.
    """
    if history.is_house:
        report_house(history, pictures)
        return
    path = history.path
    if len(history.series) == 0:
        warn(*warnings_of(history))
        print(f"{history.status}: no sample was written")
        return
    summary = with_added(summarise(history), history)
    warn(*summary["warnings"])
    print(describe(summary))
    if history.series["shock"].iloc[-1] > 1:
        print(*describe_events(shocks_table(history)), sep="\n")
    if pictures:
        _draw(history)
    _name(path)


def _draw(history):
    folder = pictures_folder(history.path)
    try:
        from damage.draw.house import save_all

        print(f"pictures: {len(save_all(history, folder))} files in {folder}")
    except Exception as error:
        warn(
            f"the history is whole, its pictures failed ({one_line(error)}); "
            f"try: python3 -m damage plot {history.path} --out {folder}"
        )


def _name(path):
    print(f"history: {path}\nnext, one HTML file:\n  python3 -m damage report {quote(str(path))}")


def report_house(history, pictures=True):
    """As `report`, of a house: all walls in one table, with the warnings of each."""
    if len(history.series) == 0:
        report(history.parts[0], pictures=False)
        return
    summaries = {part.wall: with_added(summarise(part), part) for part in history.parts}
    warn(*dict.fromkeys(text for one in summaries.values() for text in one["warnings"]))
    print(describe_house(house_summary(history, summaries)))
    if pictures:
        _draw(history)
    _name(history.path)


def describe_house(found):
    """A `house_summary` as lines for people: what all walls have together, then each."""
    return "\n\n".join([describe_together(found), *map(describe, found["walls"].values())])


def check_pictures(path, overwrite=False):
    """Raise InputError where pictures of a new run with the history `path` would go among what is
    there already."""
    folder = pictures_folder(path)
    if not overwrite and folder.is_dir() and next(folder.iterdir(), None) is not None:
        raise InputError(
            f"{folder} is not empty, and the pictures of {path.name} would go there: give another"
            " --out, --no-pictures, or --overwrite to replace what has their names"
        )


def describe(summary):
    """The summary as lines for people, without more digits than a scatter of the strengths by 0.1 %
    leaves certain: of widths two, of drift and forces three, of indices three decimals
    (docs/reference/measures.md)."""
    # a wall of a house has base shear and energies of all walls
    whole = "" if summary["max_across_mm"] is None else " of the house"
    lines = [
        f"{summary['wall']} / {summary['motion']} / {summary['solver']}: {summary['status']}"
        + (
            ""
            if summary["collapsed_at_s"] is None
            else f", collapsed at {summary['collapsed_at_s']:.2f} s"
        )
    ]
    lines.append(
        f"{'slip by ' + summary['slip']:22s}{'DI':>8s}{'drift':>8s}{'open':>8s}{'slip':>8s}"
    )
    for key, label in (
        ("max", "maximum"),
        ("residual", "residual"),
        ("max_accumulated", "maximum, accumulated"),
        ("residual_accumulated", "residual, accumulated"),
        ("max_shear_limit", "maximum, shear limit"),
        ("residual_shear_limit", "residual, shear limit"),
    ):
        if summary[key] is not None:
            lines.append(
                f"{label:22s}" + "".join(f"{value:8.3f}" for value in summary[key].values())
            )
    lines.append(
        describe_share(
            ElasticShare(
                summary["elastic_joint_share"], summary["elastic_joint_share_above_openings"]
            )
        )
    )
    lines.append(
        f"drift ratio up to {rounded(100 * summary['max_drift_ratio'], 3)} %, base shear{whole} up"
        f" to {rounded(summary['peak_base_shear_n'] / 1e3, 3)} kN, opening up to "
        f"{rounded(summary['max_opening_mm'], 2)} mm, offset up to"
        f" {rounded(summary['max_offset_mm'], 2)} mm, accumulated slip up to"
        f" {rounded(summary['max_slip_mm'], 2)} mm"
    )
    lines.append(
        f"bonds of contact points failed: {summary['tension_breaks']} in tension,"
        f" {summary['shear_breaks']} in shear; Psi up to {rounded(summary['max_psi'], 2)}"
        f" ({summary['psi_class']}; cracks from {summary['psi_from_mm']:g} mm), widest crack"
        f" {rounded(summary['max_crack_width_mm'], 2)} mm ({summary['crack_width_class']}),"
        f" friction and fracture{whole} dissipated {rounded(summary['dissipated_energy_j'], 2)} J"
    )
    lines += _ground_lines(summary)
    if summary["ended_joints"]:
        lines.append(
            f"joints that ended, as their faces no longer overlapped: {summary['ended_joints']}"
        )
    lines += _motion_lines(summary)
    if summary["energy_error_fraction"] is not None:
        lines.append(
            f"energy balance error{whole} {100 * summary['energy_error_fraction']:.3f} % of the"
            " input"
        )
    if summary["peak_force_n"] is not None:
        stiffness = (summary[f"{name}_stiffness_n_per_m"] for name in ("initial", "secant"))
        at_first, to_peak = ("-" if one is None else rounded(one / 1e6, 3) for one in stiffness)
        wave_n = summary["peak_force_wave_n"]
        wave = "" if wave_n is None else f", with a wave of {rounded(wave_n / 1e3, 2)} kN,"
        lines.append(
            f"peak force {rounded(summary['peak_force_n'] / 1e3, 3)} kN{wave} at "
            f"{rounded(100 * summary['drift_at_peak_force'], 3)} % drift; stiffness "
            f"{at_first} kN/mm at first, {to_peak} kN/mm to 0.7 of the peak"
        )
    if summary["period_s"] is not None:
        lines.append(f"period of the free vibration {summary['period_s']:.4f} s")
    lines.append(describe_evidence(summary["evidence"]))
    for name, (_, lines_of) in SUMMARY.items():
        lines += lines_of(summary[name]) if name in summary else []
    return "\n".join(lines)


def _ground_lines(summary):
    """Lines on the settlement of the ground and the rigid motion of the base; none where it does
    not move."""
    lines = []
    if summary["settled_psi"] is not None:
        lines.append(
            f"settlement: angular distortion {summary['angular_distortion']:.3g}, deflection ratio"
            f" {summary['deflection_ratio']:.3g}, relative settlement"
            f" {rounded(summary['relative_settlement_mm'], 2)} mm; then widest crack"
            f" {rounded(summary['settled_crack_width_mm'], 2)} mm, Psi"
            f" {rounded(summary['settled_psi'], 2)}, DI {summary['settled_DI']:.3f}"
        )
    if summary["max_base_rotation_rad"] is not None:
        lines.append(
            "rigid motion of the base, not in the drift: up to "
            f"{rounded(summary['max_base_translation_mm'], 2)} mm and "
            f"{rounded(1e3 * summary['max_base_rotation_rad'], 2)} mrad"
        )
    return lines


def _motion_lines(summary):
    """Lines on the motion as applied and the first free cycle after it; none without them."""
    lines = []
    if summary["avg_sa_g"] is not None:
        lines.append(
            f"motion as applied: PGV {summary['pgv_m_s']:.3g} m/s, AvgSa {summary['avg_sa_g']:.3g}"
            f" g, Arias intensity {summary['arias_m_s']:.3g} m/s"
            + (
                ""
                if summary["lost_by_lines"] is None
                else (
                    "; record interpolated, as lines between its samples would take off"
                    f" {100 * summary['lost_by_lines']:.2g} % at the first period"
                )
            )
            + (f"; record in {summary['record_unit']}" if summary["record_unit"] else "")
        )
    if summary["period_elongation"] is not None:
        lines.append(
            f"first free cycle {summary['first_free_cycle_s']:.3f} s, "
            f"{summary['period_elongation']:.2f} of the intact wall's period"
        )
    return lines


def describe_events(table):
    """The events of a `shocks_table` as lines for people."""
    lines = [
        f"{'event':>5} {'factor':>7} {'max Psi':>8} {'Psi':>6} {'max DI':>7} {'DI':>6}"
        f" {'offset [mm]':>13} {'failed':>7}  motion"
    ]
    for row in table.itertuples():
        rest = [
            (
                f"{value:>{width}.{digits}f}"
                if value is not None and value == value
                else f"{'-':>{width}}"
            )
            for value, width, digits in ((row.residual_psi, 6, 2), (row.residual_DI, 6, 3))
        ]
        lines.append(
            f"{row.shock:>5} {row.factor:>7.3g} {row.max_psi:>8.2f} {rest[0]} {row.max_DI:>7.3f}"
            f" {rest[1]} {row.offset_before_mm:>5.2f} > {row.offset_after_mm:<5.2f}"
            f" {row.newly_failed:>7}  {row.motion}"
        )
    return lines


def with_added(summary, history):
    """A summary with what applications add to it (`damage.run.options.SUMMARY`)."""
    found = {name: of(history) for name, (of, _) in SUMMARY.items()}
    return summary | {name: value for name, value in found.items() if value is not None}
