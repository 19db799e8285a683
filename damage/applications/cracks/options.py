"""The option --cracked of a run: cracks of a survey, along which its joints have no bond from the
start."""

from dataclasses import dataclass

import numpy as np

from damage.applications.cracks.crack_file import read_cracks
from damage.applications.cracks.plausible import implausible_places
from damage.arguments import arg, file_arg, number_from
from damage.errors import InputError, warn
from damage.measure.cracks import ENDS
from damage.provenance import file_origin
from damage.run.options import PAST, Source, register
from damage.units import MILLIMETRE


@dataclass(frozen=True)
class Surveyed:
    """Cracks of a file in the format of docs/reference/crack-format.md, at its last load level.

    Attributes
    ----------
    file, sha256 : str
        Its name without its folder, and its checksum.
    stretches : tuple of tuple of float
        Straight parts, (x, z of one end, x, z of the other) each [m].
    tolerance_m : float or None
        How far from a joint a crack may be drawn [m], None for half a brick's length.
    """

    file: str
    sha256: str
    stretches: tuple[tuple[float, ...], ...]
    tolerance_m: float | None = None

    @classmethod
    def read(cls, path, tolerance_m=None):
        """The cracks of a file; raises InputError."""
        ends = read_cracks(path)[-1].stretches[list(ENDS)].to_numpy(float).tolist()
        return cls(**file_origin(path), stretches=tuple(map(tuple, ends)), tolerance_m=tolerance_m)

    @property
    def lines(self):
        """The ends of the straight parts, (n, 2, 2) [m]."""
        return np.reshape(self.stretches, (-1, 2, 2))

    def implausible(self, wall):
        """What of these places cannot be on a wall, in words; None where all can."""
        places = implausible_places(self.lines, wall)
        return places and f"--cracked {self.file}: {places}"

    def joints(self, layout):
        """Which contact points along the cracks have no bond, (n_joints,) of bool.

        Straight lines become the nearest paths along joints
        (`damage.applications.cracks.crack_paths`).  Elastic contact points stay as they are, with a
        warning; what the survey comes to is printed.  Raises InputError where less than half of it
        lies on joints.
        """
        # whose libraries no other run needs
        from damage.applications.cracks.crack_paths import crack_paths
        from damage.applications.cracks.survey import check_share

        contacts = layout.contacts
        paths = crack_paths(self.lines, layout, self.tolerance_m)
        check_share(paths, f"--cracked {self.file}", layout)
        failed = np.zeros(len(contacts), bool)
        failed[paths.table["joint"]] = True
        if elastic := int(contacts.elastic[failed].sum()):
            warn(
                f"--cracked {self.file}: {elastic} of {failed.sum()} contact points are elastic by"
                " --lintel and stay so"
            )
        failed &= ~contacts.elastic
        print(
            f"cracks of {self.file}: {paths.drawn_m:.2f} m, {100 * paths.share:.0f} % of it on"
            f" joints up to {1e3 * paths.apart_m:.0f} mm away; {failed.sum()} of {layout.n_joints}"
            f" contact points ({contacts.length[failed].sum():.2f} m) start without bond; widths"
            " are not used"
        )
        return failed


def _fields(given):
    """{"joints_without_bond": Surveyed} of parsed options, empty without --cracked."""
    tolerance_mm = given.tolerance_mm
    if given.cracked is None:
        if tolerance_mm is not None:
            raise InputError("--tolerance-mm belongs to --cracked; give both")
        return {}
    tolerance_m = tolerance_mm and tolerance_mm * MILLIMETRE
    return {"joints_without_bond": Surveyed.read(given.cracked, tolerance_m)}


register(
    Source(
        PAST,
        (
            file_arg(
                "--cracked",
                "CRACKS.csv",
                "joints along these cracks have no bond from the start "
                "(docs/reference/crack-format.md; the last load level; widths are not used)",
            ),
            arg(
                "--tolerance-mm",
                "how far from a joint a crack of "
                "--cracked may be drawn (default: half a brick's length)",
                "MM",
                number_from(1e-3, 1000),
            ),
        ),
        _fields,
    )
)
