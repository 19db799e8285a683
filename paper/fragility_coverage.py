"""How often the 90 % interval for a new record holds its median: the table in
docs/reference/studies.md.

    python3 -m paper fragility_coverage [--studies 100]

Made-up studies of 25 walls at 4 intensities a record; medians of records scatter by tau, walls by
0.1.  The share of all new records that an interval holds is known, as tau is: printed is its mean
over the studies, expected to be 0.90.
"""

import sys

import numpy as np
from scipy.special import ndtr

from damage.applications.studies.new_record import new_record
from paper.bench import arguments, option, print_row, print_table

RECORDS, FACTORS, TAUS = (3, 5, 10, 20), (1.2, 1.7), (0.05, 0.1, 0.3)
WALLS, LEVELS, BETA = 25, 4, 0.1


def made_up(random, n_records, factor, tau):
    """What `new_record` takes, of a study whose records have medians about 1; factor: between
    intensities."""
    steps = np.log(factor) * (np.arange(LEVELS) - (LEVELS - 1) / 2)
    x = random.uniform(-0.3, 0.3, (n_records, 1)) + steps
    capacity = (
        tau * random.standard_normal((n_records, 1))
        + BETA * random.standard_normal(WALLS)
        + BETA / 2 * random.standard_normal((n_records, WALLS))
    )
    exceeding = np.sum(x[:, :, None] > capacity[:, None, :], axis=2)
    of_record = np.repeat(np.eye(n_records), LEVELS, axis=1)
    return np.exp(x.ravel()), of_record * exceeding.ravel(), of_record * WALLS


def coverage(n_records, factor, tau, n_studies):
    """Mean share of new records in their interval, and its standard error."""
    random, held = np.random.default_rng((n_records, int(100 * factor), int(100 * tau))), []
    for _ in range(n_studies):
        if found := new_record(*made_up(random, n_records, factor, tau)):
            low, high = np.log(found.median_bounds()) / tau
            held.append(ndtr(high) - ndtr(low))
    return np.mean(held), np.std(held) / np.sqrt(len(held))


def main():
    n_studies = arguments(__doc__, option("--studies", type=int, default=100)).studies
    cells = [(factor, tau) for factor in FACTORS for tau in TAUS]
    print_table("records", *(f"{factor:g}, {tau:g}" for factor, tau in cells))
    for n_records in RECORDS:
        found = [coverage(n_records, factor, tau, n_studies) for factor, tau in cells]
        print_row(n_records, *(f"{mean:.2f}" for mean, _ in found))
        print(f"largest standard error {max(error for _, error in found):.3f}", file=sys.stderr)
