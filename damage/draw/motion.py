"""Picture of a ground motion: its acceleration and velocity over time, and its response
spectrum."""

import numpy as np
import scipy  # integrate where it is used: it starts slowly

from damage.draw.panels import from_zero, letter
from damage.draw.style import BLACK, BLUE, COLUMN_WIDTH, LIGHT, new_figure, put_title, styled
from damage.draw.words import preparation, record_label
from damage.motion.intensity import SPECTRUM_PERIODS_S, response_spectrum
from damage.units import GRAVITY

PERIODS_S = np.union1d(np.geomspace(0.02, 2.0, 80), SPECTRUM_PERIODS_S)
"""Periods at which the line of the spectrum is evaluated [s], those of the printed ordinates among
them."""
LABELLED_S = (0.02, 0.05, 0.1, 0.2, 0.5, 1, 2)
DAMPING = 0.05


@styled
def motion_picture(loading, measures):
    """Figure of a motion as a run applies it: acceleration [g], velocity [cm/s] and 5 % response
    spectrum [g].

    loading: a `damage.motion.loading.Recorded`; measures: its
    `damage.motion.intensity.motion_summary`, whose peaks are in the titles and whose spectral
    ordinates are marked.  The velocity starts from rest, as that of a run's base.
    """
    record = loading.applied()
    velocity_cm_s = 100.0 * scipy.integrate.cumulative_trapezoid(
        record.acceleration_m_s2, dx=record.time_step_s, initial=0.0
    )
    figure, (acceleration, velocity, spectrum) = new_figure(1.35 * COLUMN_WIDTH, 3)
    _over_time(acceleration, record.time_s, record.acceleration_m_s2 / GRAVITY, "acceleration [g]")
    letter(acceleration, 0, f"PGA {measures['pga_g']:.3g} g")
    _over_time(velocity, record.time_s, velocity_cm_s, "velocity [cm/s]")
    velocity.set_xlabel("time [s]")
    letter(velocity, 1, f"PGV {measures['pgv_cm_s']:.3g} cm/s")
    spectrum.plot(PERIODS_S, response_spectrum(record, PERIODS_S, DAMPING), color=BLUE)
    spectrum.plot(SPECTRUM_PERIODS_S, list(measures["sa_g"].values()), "o", color=BLUE, ms=2.5)
    spectrum.set(
        xscale="log", xlim=(PERIODS_S[0], PERIODS_S[-1]), xlabel="period [s]", ylabel="Sa [g]"
    )
    spectrum.set_xticks(LABELLED_S, list(map("{:g}".format, LABELLED_S)))
    from_zero(spectrum)
    letter(spectrum, 2, f"spectrum, {100 * DAMPING:g} % damping; points as printed")
    unfiltered = [] if loading.band_hz else ["not filtered"]
    steps = ", ".join([*preparation(loading), *unfiltered])
    put_title(figure, f"{record_label(loading.record.name)}: {steps}")
    return figure


def _over_time(ax, time_s, values, label):
    ax.axhline(0, color=LIGHT, lw=0.8, zorder=0)
    ax.plot(time_s, values, color=BLACK, lw=0.6)
    ax.set_ylabel(label)
    ax.margins(x=0)
