"""Make the records in damage/data that are not kept as their owner distributes them.

    python3 scripts/make_records.py zeerijp      # CSV of the horizontal components, from miniSEED (needs obspy)
    python3 scripts/make_records.py synthetic    # the synthetic stand-in for the Huizinge record

With --out DIR the files go elsewhere.  The first makes the same bytes on any machine; the second the same
motion, up to what the rounding of another machine's linear algebra makes of it.
"""

import argparse
import re
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(REPOSITORY))

from synthetic import HUIZINGE, SEED, synthetic_record

from damage.errors import InputError
from damage.motion.formats import read_record, write_csv
from damage.motion.intensity import response_spectrum, summary

DATA = REPOSITORY / "damage" / "data"
KNMI = "KNMI NL network, CC BY 4.0, doi 10.21944/e970fd34-23b9-3411-b366-e4f72877d2c5"


def make_zeerijp(folder):
    """One CSV for each horizontal component whose miniSEED is in the data folder."""
    for path in sorted((DATA / "zeerijp_20180108").glob("*..HG[EN]__*.mseed")):
        record = read_record(path)
        _, station, _, channel = record.name.split(".")
        sensitivity = only_sensitivity(path.parent / f"NL.{station}.xml")
        comment = (f"Zeerijp ML3.4 2018-01-08 NL.{station}.{channel} start {record.start_utc}; time_s,acc_m_s2 ="
                   f" counts/{sensitivity}, mean of first 2 s removed, no filter. {KNMI}")
        yield write_csv(record, folder / f"{station}_{channel}_acc_m_s2.csv", [comment])


def only_sensitivity(station_xml):
    """The sensitivity that all channels of a StationXML file share, as it is written there."""
    text = station_xml.read_text(encoding="utf-8")
    values = set(re.findall(r"<InstrumentSensitivity>\s*<Value>([^<]+)</Value>", text))
    if len(values) != 1:
        raise InputError(f"{station_xml}: sensitivities {sorted(values)}; expected one for all channels")
    return values.pop()


def make_synthetic(folder):
    """The synthetic Huizinge record, with its targets and what it reached in its comments."""
    record = synthetic_record(HUIZINGE, SEED)
    yield write_csv(record, folder / f"{record.name}_acc_m_s2.csv", [
        "SYNTHETIC motion, not a recording: a stand-in for the Huizinge record, which cannot be redistributed.",
        f"Target: {HUIZINGE.source}.",
        *describe(record),
        f"Made by: python3 scripts/make_records.py synthetic; seed {SEED}."])


def describe(record, target=HUIZINGE):
    """Target and reached values, a line each."""
    measures = summary(record)
    reached_g = response_spectrum(record, target.periods_s)
    yield f"Target PGA {target.pga_m_s2:g} m/s2, PGV {100 * target.pgv_m_s:g} cm/s; 5 % spectrum [s: g] " + ", ".join(
        f"{period:g}: {ordinate:.3f}" for period, ordinate in zip(target.periods_s, target.sa_g))
    yield (f"Reached PGA {max(abs(record.acceleration_m_s2)):.4f} m/s2, PGV {measures['pgv_cm_s']:.3f} cm/s, spectrum"
           f" within {100 * max(abs(reached_g / target.sa_g - 1)):.1f} %; Arias {measures['arias_m_s']:.4f} m/s,"
           f" D5-75 {measures['d5_75_s']:.2f} s, D5-95 {measures['d5_95_s']:.2f} s")


MAKERS = {"zeerijp": ("zeerijp_20180108", make_zeerijp),
          "synthetic": ("huizinge_20120816_synthetic", make_synthetic)}


def main(arguments=None):
    """Make the named files; returns the exit status: 0 done, 2 bad input."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=MAKERS)
    parser.add_argument("--out", type=Path, metavar="DIR", help="instead of the folder in damage/data")
    parsed = parser.parse_args(arguments)
    name, make = MAKERS[parsed.what]
    folder = parsed.out or DATA / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path in make(folder):
            print(path)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
