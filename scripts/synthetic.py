"""Synthetic ground motion that matches a published spectrum, where a real record cannot be had.

The motion is a sum of wavelets that set in at the arrivals of shear waves and in the coda after
them. Each is the second difference of a displacement that is zero outside a bounded time, so that
velocity and displacement of any sum end at zero and no baseline has to be corrected:

    a(t) = sum over j of c_j psi_j(t)

The amplitudes c_j are drawn at random, with a fixed seed, from an envelope that makes the motion
short; then the least change of them is sought (Gauss-Newton, after the wavelets in the time domain
of Al Atik & Abrahamson 2010, doi:10.1193/1.3459159) that brings PGA, PGV and the spectrum to
their targets. Programs for this (REQPY, for one) modify a real record towards a spectrum; a short
motion with a given PGA and PGV, made from none, is not what they are for.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import fftconvolve

from damage.motion.intensity import oscillator_response
from damage.motion.record import Record
from damage.units import GRAVITY


@dataclass(frozen=True)
class Target:
    """Targets of a synthetic record.

    name: of the record, with the word synthetic in it; source: where the numbers come from.
    periods_s, sa_g: (n_periods,) spectrum at 5 % damping [s], [g]; pga_m_s2, pgv_m_s: peaks.
    arrivals_s: when shear waves set in, strongest first [s].
    """

    name: str
    source: str
    periods_s: tuple[float, ...]
    sa_g: tuple[float, ...]
    pga_m_s2: float
    pgv_m_s: float
    arrivals_s: tuple[float, ...]


HUIZINGE = Target(
    name="MID1_N_synthetic",
    source=(
        "Huizinge, ML 3.6, 2012-08-16, station MID1, North: PGA 85 cm/s2, PGV 3.45 cm/s and the 5 %"
        " spectrum published for a shake-table reproduction of it"
    ),
    periods_s=(0.06, 0.10, 0.12, 0.15, 0.20, 0.25, 0.33, 0.5, 1.0),
    sa_g=(0.199, 0.280, 0.319, 0.290, 0.165, 0.123, 0.094, 0.072, 0.014),
    pga_m_s2=0.85,
    pgv_m_s=0.0345,
    arrivals_s=(0.95, 1.06, 1.22),
)

TIME_STEP_S = 0.005
DURATION_S = 6.0
SEED = 2012

FREQUENCIES_HZ = np.geomspace(0.8, 22.0, 14)
CYCLES = 2.0
"""Length of a wavelet in cycles of its frequency."""

ARRIVAL_FALLOFF = 0.8
"""Amplitude of each further arrival over that of the one before it."""

CODA_ARRIVALS = 14
CODA_SHARE, CODA_DECAY_S = 0.4, 1.0
"""Amplitude of the coda at its start over that of the strongest arrival, and its decay time [s]."""

TIGHT, LOOSE = 0.003, 0.03
"""Errors, as shares of the target, that weigh as much as a random amplitude that is off by its own
standard deviation: at the published periods and for PGA and PGV, and between those periods."""

ITERATIONS = 80
"""A peak jumps from one instant to another as amplitudes change, so the search seldom comes to rest
by
itself; errors stay below 1 % from about half as many on."""

PERIODS_BETWEEN = 24
"""Periods at which the spectrum, interpolated between the published ones on logarithmic scales, is
matched loosely."""


def synthetic_record(target: Target = HUIZINGE, seed: int = SEED) -> Record:
    """A record that matches the target; the same seed gives the same record."""
    generator = np.random.RandomState(seed)  # its streams never change between versions of numpy
    wavelets, deviation = _wavelets(target, generator)
    drawn = deviation * generator.standard_normal(len(deviation))
    drawn *= target.pga_m_s2 / np.abs(drawn @ wavelets).max()
    deviation *= target.pga_m_s2 / np.abs(deviation @ np.abs(wavelets)).max()
    peaks = _peaks(target, wavelets.shape[1])

    def misfit(change):
        """Shares by which each peak is off, and each amplitude's change, over their weights."""
        motion = (drawn + deviation * change) @ wavelets
        off = [np.log(abs(peak.value(motion)) / peak.goal) / peak.weight for peak in peaks]
        return np.concatenate((off, change))

    def slopes(change):
        motion = (drawn + deviation * change) @ wavelets
        by_sample = np.array(
            [peak.slope(motion) / (peak.value(motion) * peak.weight) for peak in peaks]
        )
        return np.vstack((by_sample @ wavelets.T * deviation, np.eye(len(change))))

    best = least_squares(misfit, np.zeros(len(drawn)), slopes, method="lm", max_nfev=ITERATIONS)
    return Record(target.name, TIME_STEP_S, (drawn + deviation * best.x) @ wavelets)


@dataclass(frozen=True)
class _Peak:
    """The largest value of something that a motion causes linearly, and what it should be.

    kernel: (instants, n_samples), what a motion of 1 in the first sample alone causes from there
    on.
    goal: of the peak's absolute value; weight: error, as a share of it, that counts 1.
    """

    kernel: np.ndarray
    goal: float
    weight: float

    def value(self, motion):
        """The value of largest magnitude, with its sign."""
        return self.slope(motion) @ motion

    def slope(self, motion):
        """Derivative of that value by the motion's samples, (n_samples,)."""
        instant, sample = self._place(motion)
        slope = np.zeros(len(motion))
        slope[: sample + 1] = self.kernel[instant, sample::-1]
        return slope

    def _place(self, motion):
        caused = fftconvolve(self.kernel, motion[np.newaxis], axes=1)[:, : len(motion)]
        return np.unravel_index(np.argmax(np.abs(caused)), caused.shape)


def _peaks(target, n_samples):
    """PGA, PGV and the spectrum: at the published periods, and between them with less weight."""
    impulse = np.zeros(n_samples + 1)
    impulse[1] = 1.0  # the response to it begins in the step before
    between_s = np.geomspace(target.periods_s[0], target.periods_s[-1], PERIODS_BETWEEN)
    between_g = np.exp(np.interp(np.log(between_s), np.log(target.periods_s), np.log(target.sa_g)))
    peaks = [
        _Peak(impulse[np.newaxis, 1:], target.pga_m_s2, TIGHT),
        _Peak(np.full((1, n_samples), TIME_STEP_S), target.pgv_m_s, TIGHT),
    ]
    for periods_s, ordinates_g, weight in (
        (target.periods_s, target.sa_g, TIGHT),
        (between_s, between_g, LOOSE),
    ):
        peaks += [
            _Peak(oscillator_response(impulse, TIME_STEP_S, period_s), ordinate_g * GRAVITY, weight)
            for period_s, ordinate_g in zip(periods_s, ordinates_g)
        ]
    return peaks


def _wavelets(target, generator):
    """Accelerations (n_wavelets, n_samples) with a peak of 1, and standard deviations of their
    amplitudes."""
    time_s = np.arange(round(DURATION_S / TIME_STEP_S) + 1) * TIME_STEP_S
    spectrum = np.interp(np.log(1 / FREQUENCIES_HZ), np.log(target.periods_s), target.sa_g)
    rows, deviations = [], []
    for onset_s, strength in _onsets(target, generator):
        for frequency_hz, ordinate in zip(FREQUENCIES_HZ, spectrum):
            for phase in (0.0, np.pi / 2):
                rows.append(_wavelet(time_s, onset_s, frequency_hz, phase))
                deviations.append(strength * ordinate)
    return np.array(rows), np.array(deviations)


def _onsets(target, generator):
    """Time [s] and relative strength of every arrival, those of the coda at random times."""
    first_s = target.arrivals_s[0]
    for number, onset_s in enumerate(target.arrivals_s):
        yield onset_s, ARRIVAL_FALLOFF**number
    longest_s = CYCLES / FREQUENCIES_HZ[0]
    for onset_s in np.sort(generator.uniform(first_s, DURATION_S - longest_s, CODA_ARRIVALS)):
        yield onset_s, CODA_SHARE * np.exp(-(onset_s - first_s) / CODA_DECAY_S)


def _wavelet(time_s, onset_s, frequency_hz, phase):
    """Acceleration whose displacement is a sinusoid in a smooth window of CYCLES cycles."""
    half_s = 0.5 * CYCLES / frequency_hz
    after_s = time_s - onset_s - half_s
    window = np.clip(1 - (after_s / half_s) ** 2, 0, None) ** 4
    displacement = window * np.cos(2 * np.pi * frequency_hz * after_s + phase)
    acceleration = np.pad(np.diff(displacement, 2), 1)
    return acceleration / np.abs(acceleration).max()
