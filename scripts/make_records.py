"""Make the records in damage/data that are not kept as their owner distributes them.

    python3 scripts/make_records.py zeerijp    # CSV of the horizontal components, from miniSEED
                                               # (needs obspy), and
                                               # components.csv, what each of them is
    python3 scripts/make_records.py stations   # studies/stations.csv: the components at the PGV
                                               # that they may reach
    python3 scripts/make_records.py synthetic  # the synthetic stand-in for the Huizinge record

With --out DIR the files go elsewhere.  The first makes the same bytes on any machine; the second
the same motion, up to what the rounding of another machine's linear algebra makes of it.
"""

import argparse
import math
import re
import sys
from functools import lru_cache
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(REPOSITORY))

import pandas as pd
from synthetic import HUIZINGE, SEED, synthetic_record

from damage.applications.groningen.exposure.ground_motion import ZEERIJP
from damage.applications.groningen.exposure.places import to_rd
from damage.errors import InputError
from damage.files import write_text
from damage.motion.formats import read_record, write_csv
from damage.motion.intensity import pga_g, pgv_rotd100_m_s, response_spectrum, summary
from damage.motion.record import band_passed, on_axis_of, start_difference_s, windowed

DATA = REPOSITORY / "damage" / "data"
WINDOWS_S = {
    "BGAR_HGE": (17, 27),
    "BGAR_HGN": (18.5, 26.5),
    "BWSE_HGE": (19, 28),
    "BWSE_HGN": (19.5, 27.5),
    "BZN1_HGE": (17, 25),
    "BZN1_HGN": (17.5, 25.5),
    "BLOP_HGE": (16.5, 24.5),
    "BLOP_HGN": (17.5, 26.5),
}
"""Recommended windows of the CSV files that are as long as their miniSEED [s]."""
SHORTENED_S = {
    "BAPP_HGE": (18.5, 38.5),
    "BAPP_HGN": (18.5, 36),
    "BOWW_HGE": (19, 31.5),
    "BOWW_HGN": (19, 35),
    "BWIR_HGE": (18.5, 34.5),
    "BWIR_HGN": (17.5, 32.5),
    "G010_HG1": (20, 29.5),
    "G010_HG2": (21, 30.5),
    "G040_HG1": (19, 34),
    "G040_HG2": (18, 33.5),
    "G080_HG1": (20, 33),
    "G080_HG2": (19, 34.5),
    "G100_HG1": (17, 31),
    "G100_HG2": (17, 29.5),
    "G130_HG1": (19, 30),
    "G130_HG2": (18.5, 29.5),
    "G170_HG1": (18.5, 33),
    "G170_HG2": (17, 29),
    "G190_HG1": (17.5, 32.5),
    "G190_HG2": (17.5, 33),
    "G220_HG1": (18.5, 32),
    "G220_HG2": (18.5, 34.5),
    "G620_HG1": (19.5, 39.5),
    "G620_HG2": (17.5, 36.5),
}
"""Windows of the others in their miniSEED [s]: 1 % to 97 % of the Arias intensity after the
band-pass, rounded outwards; their CSV files hold these and MARGIN_S on both sides."""
FARTHEST_KM, FACTORS = 10.0, (0.1, 10.0)
"""Which record may be scaled how far: the rule of the README in damage/data/zeerijp_20180108."""
PGV_MM_S = 10, 20, 40, 80
"""To which components are scaled in the study `stations` [mm/s]."""
STEPPED = "BLOP_HGE"
"""A record that steps at the first strong motion: unfiltered its velocity drifts away."""
MARGIN_S = 3.0
BAND_HZ = 0.5, 40.0
"""Band in which components are measured: below it the weak ones are noise."""
KNMI = "KNMI NL network, CC BY 4.0, doi 10.21944/e970fd34-23b9-3411-b366-e4f72877d2c5"


def make_zeerijp(folder):
    """One CSV for each horizontal component whose miniSEED is in the data folder, and
    components.csv."""
    rows = []
    for path in sorted((DATA / "zeerijp_20180108").glob("*..HG[EN12]__*.mseed")):
        record = read_record(path)
        _, station, _, channel = record.name.split(".")
        station_xml = path.parent / f"NL.{station}.xml"
        name, sensitivity = f"{station}_{channel}", only_of("InstrumentSensitivity", station_xml)
        rows.append(component_row(name, record, station_xml))
        if name in SHORTENED_S:
            start, end = SHORTENED_S[name]
            record = windowed(record, start - MARGIN_S, end + MARGIN_S)
        comment = (
            f"Zeerijp ML3.4 2018-01-08 NL.{station}.{channel} start {record.start_utc};"
            f" time_s,acc_m_s2 = counts/{sensitivity}, mean of first 2 s removed, no filter. {KNMI}"
        )
        yield write_csv(record, folder / f"{name}_acc_m_s2.csv", [comment])
    table = pd.DataFrame(rows).sort_values(["epicentral_km", "record"])
    table.insert(
        list(table).index("pgv_mm_s") + 1,
        "pgv_rotd100_mm_s",
        [round(1e3 * station_pgv_m_s(station), 4) for station in table["station"]],
    )
    yield write_text(folder / "components.csv", f"# {KNMI}\n" + table.to_csv(index=False))


@lru_cache
def station_pgv_m_s(station):
    """PGV of a station in the direction in which it is largest, of its two horizontal components
    where both have samples, after the band-pass [m/s]."""
    first, second = (
        band_passed(read_record(path), *BAND_HZ)
        for path in sorted((DATA / "zeerijp_20180108").glob(f"NL.{station}..HG[EN12]__*.mseed"))
    )
    late = max(start_difference_s(second, first), 0.0)
    shared_s = min(first.duration_s, start_difference_s(second, first) + second.duration_s)
    return pgv_rotd100_m_s(
        windowed(first, late, shared_s),
        windowed(on_axis_of(second, first, (late, shared_s)), late, shared_s),
    )


def component_row(name, record, station_xml):
    """A row of components.csv: where a station is, and measures of the whole record, PGA as it is
    and the others after a band-pass."""
    latitude, longitude = (float(only_of(tag, station_xml)) for tag in ("Latitude", "Longitude"))
    x_m, y_m = to_rd(latitude, longitude)
    start, end = WINDOWS_S.get(name) or (
        MARGIN_S,
        MARGIN_S + SHORTENED_S[name][1] - SHORTENED_S[name][0],
    )
    measures = summary(band_passed(record, *BAND_HZ))
    return {
        "record": name,
        "station": name.split("_")[0],
        "latitude": latitude,
        "longitude": longitude,
        "epicentral_km": round(math.hypot(x_m - ZEERIJP["x_m"], y_m - ZEERIJP["y_m"]) / 1e3, 3),
        "start_s": start,
        "end_s": end,
        "pga_g": round(pga_g(record), 5),
        "pgv_mm_s": round(10 * measures["pgv_cm_s"], 4),
        "arias_m_s": float(f"{measures['arias_m_s']:.4g}"),
        "d5_95_s": round(measures["d5_95_s"], 2),
        "sa_0.2_s_g": round(float(response_spectrum(record, [0.2])[0]), 5),
    }


def only_of(tag, station_xml):
    """The value of a tag that is the same everywhere in a StationXML file, as it is written
    there."""
    text = station_xml.read_text(encoding="utf-8")
    values = set(re.findall(rf"<{tag}(?: [^>]*)?>\s*(?:<Value>)?([^<]+)<", text))
    if len(values) != 1:
        raise InputError(
            f"{station_xml}: values {sorted(values)} of {tag}; expected one for all channels"
        )
    return values.pop()


def make_stations(folder):
    """Rows of the study `stations`: every component at each of PGV_MM_S that the rule for scaling
    admits, but STEPPED, which the study filters."""
    table = pd.read_csv(DATA / "zeerijp_20180108" / "components.csv", comment="#")
    lines = ["record,start,end,scale"]
    for row in table[table["record"] != STEPPED].itertuples():
        factors = [float(f"{pgv / row.pgv_mm_s:.3g}") for pgv in PGV_MM_S]
        lines += [
            f"damage/data/zeerijp_20180108/{row.record}_acc_m_s2.csv,{row.start_s:g},{row.end_s:g},{factor:g}"
            for factor in factors
            if FACTORS[0] <= factor <= FACTORS[1] and row.epicentral_km <= FARTHEST_KM
        ]
    yield write_text(folder / "stations.csv", "\n".join(lines) + "\n")


def make_synthetic(folder):
    """The synthetic Huizinge record, with its targets and what it reached in its comments."""
    record = synthetic_record(HUIZINGE, SEED)
    yield write_csv(
        record,
        folder / f"{record.name}_acc_m_s2.csv",
        [
            (
                "SYNTHETIC motion, not a recording: a stand-in for the Huizinge record, which"
                " cannot be redistributed."
            ),
            f"Target: {HUIZINGE.source}.",
            *describe(record),
            f"Made by: python3 scripts/make_records.py synthetic; seed {SEED}.",
        ],
    )


def describe(record, target=HUIZINGE):
    """Target and reached values, a line each."""
    measures = summary(record)
    reached_g = response_spectrum(record, target.periods_s)
    yield (
        f"Target PGA {target.pga_m_s2:g} m/s2, PGV {100 * target.pgv_m_s:g} cm/s; 5 % spectrum"
        " [s: g] "
        + ", ".join(
            f"{period:g}: {ordinate:.3f}" for period, ordinate in zip(target.periods_s, target.sa_g)
        )
    )
    yield (
        f"Reached PGA {max(abs(record.acceleration_m_s2)):.4f} m/s2, PGV {measures['pgv_cm_s']:.3f}"
        f" cm/s, spectrum within {100 * max(abs(reached_g / target.sa_g - 1)):.1f} %; Arias"
        f" {measures['arias_m_s']:.4f} m/s, D5-75 {measures['d5_75_s']:.2f} s, D5-95"
        f" {measures['d5_95_s']:.2f} s"
    )


MAKERS = {
    "zeerijp": (DATA / "zeerijp_20180108", make_zeerijp),
    "stations": (REPOSITORY / "studies", make_stations),
    "synthetic": (DATA / "huizinge_20120816_synthetic", make_synthetic),
}


def main(arguments=None):
    """Make the named files; returns the exit status: 0 done, 2 bad input."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=MAKERS)
    parser.add_argument("--out", type=Path, metavar="DIR", help="instead of the usual folder")
    parsed = parser.parse_args(arguments)
    usual, make = MAKERS[parsed.what]
    folder = parsed.out or usual
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
