"""Commands about laboratory walls and digitised cracks."""

from damage.commands.table import (
    DRIFT_LIMIT,
    HISTORIES,
    JSON,
    PSI_FROM,
    arg,
    command,
    file_arg,
    group,
    out,
    output,
    save,
    show,
    threshold,
)
from damage.history.reader import read_history
from damage.provenance import shown_path
from damage.run.options import WALLS_ARE_CODE, number_from
from damage.units import MILLIMETRE


@command("pushed laboratory walls beside their tests", HISTORIES, out("folder for the pictures"))
def _laboratory(asked):
    from damage.laboratory.pictures import save

    print(*save(map(read_history, asked.histories), asked.out), sep="\n")


@command("cracks, Psi and index of a history, of digitised cracks or of a DIC field",
         file_arg("source", "FILE", "a history (.h5) or a crack file (CSV)", nargs="?"),
         group("a history", arg("--at", metavar="MOMENT,...", help="max, end, times [s] (default max,end)")),
         group("a crack file or a DIC field",
               file_arg("--dic", "FIELD.csv", "instead of FILE: a DIC displacement field"),
               file_arg("--wall", "walls/NAME.py", f"the wall of a crack file or a field. {WALLS_ARE_CODE}"),
               arg("--tolerance-mm", type=number_from(1e-3, 1000), metavar="MM", help="of a crack file: how far from "
                   "a joint a crack may be drawn (default: half a brick's height)"),
               arg("--margin-mm", type=number_from(0, 1000), metavar="MM",
                   help="of a field: how far inside a brick's edges points count (default 10)")),
         threshold("opening, slip and width"), PSI_FROM, DRIFT_LIMIT,
         output(file_arg("--export", "CRACKS.csv", "write the cracks of a history or a field as a crack file")),
         out("folder for a picture of each load level, or moment", required=False), JSON)
def _cracks(asked):
    from damage.laboratory.crack_report import crack_report, describe

    report, drawn = crack_report(**{name: value for name, value in vars(asked).items()
                                    if name not in ("command", "json", "version", "quiet")})
    if asked.out:
        from damage.laboratory.crack_picture import crack_pictures

        save(crack_pictures(*drawn, asked.threshold_mm * MILLIMETRE), asked.out,
              f"cracks of {shown_path(asked.source or asked.dic)}")
    show(asked, report, describe)
