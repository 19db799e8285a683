"""The options of a run, the same for every solver, and the frozen record that they become."""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cache, lru_cache

import numpy as np

from damage.arguments import (
    WALLS_ARE_CODE,
    OneLineParser,
    Rows,
    arg,
    file_arg,
    file_path,
    flag,
    group,
    number_from,
)
from damage.errors import InputError, did_you_mean
from damage.fields import option_of
from damage.house.plausible import ACCEPT
from damage.motion.settlement import PROFILES
from damage.provenance import shown_command
from damage.run.motion_options import MOTION_GROUPS, motion_of, settlement_of
from damage.run.settings import AFTER_FALL_S, RELAXATIONS, RunSettings, rayleigh_factors
from damage.wall.model_options import ModelOptions

_EXAMPLES = {
    "reference": (
        "python3 -m damage reference symmetric --harmonic 0.2 0.05 --members 8",
        "python3 -m damage reference my_wall.toml --record record.csv --window 17 27 --out run.h5",
    ),
    "yade": (
        "./yade symmetric --harmonic 0.2 0.05 --console",
        "./yade solid --pushover 0.1 --boundary fixed --out pushed.h5",
    ),
}


def arguments_of(kind, *names):
    """Arguments of the named fields of a kind of record, of all without a name, a list."""
    return [
        _argument(attribute) for attribute in fields(kind) if attribute.name in names or not names
    ]


def _argument(attribute):
    metadata = attribute.metadata
    default = None if None in metadata["words"] else attribute.default
    shown = f"{default:g}" if isinstance(default, float) else default
    return arg(
        option_of(attribute),
        metadata["help"] + f" (default {shown})" * (default is not None),
        metadata["metavar"],
        str if metadata["choices"] else float if default is None else type(default),
        choices=metadata["choices"],
        default=default,
    )


ACCEPTING = flag(
    ACCEPT,
    "take the values of the wall and the motion as given, even where they look like a wrong unit "
    "(docs/reference/ranges.md)",
)
"""The option that accepts implausible values."""
UNITS = arg(
    "--units",
    "the wall in larger units of so many bricks and courses, as stiff, strong and tough, with"
    " fewer cracks: for many runs (damage.house.coarser; default 1 1)",
    ("BRICKS", "COURSES"),
    number_from(1, 20, int),
    nargs=2,
    default=(1, 1),
)
PAST = "the wall's past"
"""The title of the options of what a wall went through before the run."""
_CONTINUE = file_arg(
    "--continue",
    "FILE.h5",
    "start from the end of this run of the same wall, as if it had continued; in YADE one with"
    " --checkpoint",
)


def _model_arguments(solver):
    of_reference = (
        []
        if solver != "reference"
        else [
            arg(
                "--rayleigh",
                "mass- and stiffness-proportional damping with this ratio at two frequencies",
                ("RATIO", "F1_HZ", "F2_HZ"),
                float,
                nargs=3,
            ),
            arg(
                "--relaxation",
                "damping of the static stage: adaptive (default), or local as in YADE, "
                "which a pushed top has then, too",
                default="adaptive",
                choices=RELAXATIONS,
            ),
            *arguments_of(RunSettings, "settling", "mass_scaling"),
        ]
    )
    return [
        UNITS,
        *arguments_of(ModelOptions),
        *arguments_of(RunSettings, "beta_s"),
        *of_reference,
        *arguments_of(RunSettings, "scatter", "seed", "members"),
        ACCEPTING,
    ]


def _run_arguments(solver):
    of_yade = (
        []
        if solver != "yade"
        else [
            flag(
                "--after-fall",
                "follow the bricks of a wall that fell until they rest, "
                f"{AFTER_FALL_S:g} s at most (default: end with the first fallen brick)",
            ),
            flag("--view", "with a screen: the 3D view"),
            arg(
                "--console",
                "YADE's prompt before or after "
                "(default) the run, with O, wall, run, scene, and history after it",
                nargs="?",
                const="after",
                choices=("before", "after"),
            ),
        ]
    )
    return [
        file_arg("--out", "FILE.h5", "history file (default: a free name below results/)"),
        flag("--overwrite", "replace an existing FILE.h5 and its pictures in FILE"),
        flag(
            "--stresses",
            "keep normal and shear stress of all joints at every sample"
            " (docs/guides/reading-results.md); the run says first how large they are",
        ),
        arg(
            "--checkpoint",
            "keep the state in FILE.checkpoint, each time after so many minutes of computing,"
            " in YADE at the end, too (default: at an interruption)",
            "MINUTES",
            number_from(1e-3, 1e5),
        ),
        file_arg(
            "--resume",
            "FILE.h5",
            "continue this run, which was interrupted or killed, from its last checkpoint; the"
            " other options as they were. A checkpoint of YADE can execute code: continue runs of"
            " your own only",
        ),
        *arguments_of(RunSettings, "rest_s", "time_step_s"),
        flag("--no-pictures", "write the history only", dest="pictures", action="store_false"),
        flag("--quiet", "print warnings and errors only"),
        *of_yade,
    ]


@dataclass(frozen=True)
class Source:
    """Options that an application adds to those of a run, and what they make of its settings.

    Attributes
    ----------
    title : str
        Of the group of the options in the help.
    arguments : tuple of callable
        Each adds an option to a parser, as of `arg`.
    fields : callable
        From parsed options {field of RunSettings: value}, empty where none of its own is given.
        Raises InputError where they do not go with the others.
    digest : callable, optional
        From options {name: value} the SHA-256 of the files that motions are drawn from.
    """

    title: str
    arguments: tuple
    fields: Callable
    digest: Callable | None = None


SOURCES = []
"""Sources that applications add."""
RUN_MEMBERS = []
"""What runs --members: a function(wall_file, make_wall, RunSettings, words of the command line),
which returns the exit status."""
SUMMARY = {}
"""Additions to a printed summary, {name: (function of a History, None where there is nothing;
function of that, a list of lines)}."""
SOLVERS = "yade", "reference"


def register(source):
    """Add a Source to SOURCES, and its options to the help."""
    SOURCES.append(source)
    make_parser.cache_clear()
    options_of_a_run.cache_clear()


def parse_run(arguments, prog, solver):
    """RunSettings from a command line.

    Parameters
    ----------
    arguments : list of str
        Its words.
    prog : str
        What stands before them.
    solver : {"yade", "reference"}

    Raises
    ------
    InputError
        Where an option, its value or a file is not valid.
    """
    given = make_parser(prog, solver).parse_args(arguments)
    added = {}
    for source in SOURCES:
        added |= source.fields(given)
    alpha_1_s, beta_s = _damping(given)
    before = getattr(given, "continue")
    return RunSettings(
        **_fields_of(RunSettings, given)
        | ({} if "loading" in added else motion_of(given))
        | {
            "settlement": settlement_of(given),
            "model": model_of(given),
            "continued": before and str(before),
            "alpha_1_s": alpha_1_s,
            "beta_s": beta_s,
            "checkpoint_s": math.inf if given.checkpoint is None else 60 * given.checkpoint,
            "resumed": given.resume and str(given.resume),
            "out": given.out or given.resume,
            "command": f"{prog} {shown_command(arguments)}".strip(),
        }
        | added
    )


def settings_of(options, prog, solver):
    """RunSettings from a dictionary of options; otherwise as `parse_run`.

    Parameters
    ----------
    options : dict
        {name: value}: the name without its dashes, - or _ inside of it.  An option of several
        values has a tuple or a list, one without a value True.  None stands for the default.
    """
    return parse_run(words_of(options, solver), prog, solver)


@lru_cache(maxsize=8)  # a study asks for one for each of its runs
def make_parser(prog, solver):
    """The parser of a run's command line."""
    parser = OneLineParser(
        prog=prog,
        allow_abbrev=False,
        examples=_EXAMPLES[solver],
        description=(
            f"Shake one wall ({solver} solver) and write its history, summary and pictures."
            f" {WALLS_ARE_CODE}"
        ),
    )
    _add_arguments(parser, solver)
    return parser


def _add_arguments(parser, solver):
    """Add the options of a run in a solver to a parser; returns their actions."""
    groups = dict(MOTION_GROUPS)
    groups |= {source.title: source.arguments for source in SOURCES}
    groups[PAST] = (_CONTINUE, *groups.pop(PAST, ()))
    groups |= {"model": _model_arguments(solver), "run": _run_arguments(solver)}
    return [
        action for title, arguments in groups.items() for action in group(title, *arguments)(parser)
    ]


@cache
def options_of_a_run(*solvers):
    """{name in Python: argparse's action} of the options of a run in these solvers, all of them
    without one."""
    return {
        action.dest: action
        for solver in solvers or SOLVERS
        for action in _add_arguments(OneLineParser(), solver)
    }


def _action(actions, name):
    """The action of an option; InputError where there is none of its name."""
    if name.replace("-", "_") not in actions:
        raise InputError(
            f"no option {name}: expected one of {', '.join(actions)}{did_you_mean(name, actions)}"
        )
    return actions[name.replace("-", "_")]


def names_file(name, value):
    """Whether the value of an option names a file.

    >>> options = ("settle", "hogging"), ("settle", "dip.csv"), ("sequence", "1,0.5")
    >>> tuple(names_file(*one) for one in options)
    (False, True, False)
    """
    if name == "sequence":
        return isinstance(value, str) and value.lower().endswith(".csv")
    return _action(options_of_a_run(), name).type is file_path and not (
        name == "settle" and str(value) in PROFILES
    )


def words_of(options, *solvers):
    """The command line, a list of words, of a dictionary of options as `settings_of` takes it, of
    these solvers, all of them without one.  Raises InputError of an option that there is not, or
    whose value has another number of words.

    >>> words_of({"harmonic": [0.2, 0.05], "rest": 1.0, "sequence": (1, 0.5), "stresses": True})
    ['--harmonic', '0.2', '0.05', '--rest', '1.0', '--sequence', '1,0.5', '--stresses']
    """
    actions = options_of_a_run(*solvers)
    return [
        word
        for name, value in options.items()
        for word in _words(_action(actions, name), name, value)
    ]


def _words(action, name, value):
    """Words of one option on the command line; none where its value is None or the default of a
    flag."""
    option = action.option_strings[0]
    if value is None:
        return []
    if action.nargs == 0:
        if not isinstance(value, bool):
            raise InputError(f"{name} = {value!r}: expected True or False; give one of them")
        return [option] if value is action.const else []
    if isinstance(action, Rows):
        return [word for row in _rows(action, name, value) for word in (option, *map(str, row))]
    several = isinstance(value, (tuple, list, np.ndarray))
    words = [_word(action, item) for item in (value if several else [value])]
    if isinstance(action.nargs, int) and len(words) != action.nargs:
        raise InputError(
            f"argument {option}: expected {action.nargs} arguments,"
            f" {' '.join(action.metavar)}; given {value!r:.80}; correct it"
        )
    return [option, *words] if action.nargs else [option, ",".join(words)]


def _word(action, value):
    """The word of one value; a number that is whole is one for an option of whole numbers."""
    is_whole = isinstance(value, float) and value.is_integer()
    if is_whole and getattr(action.type, "__name__", "") == "int":
        return str(int(value))
    return repr(float(value)) if isinstance(value, np.floating) else str(value)


def _rows(action, name, value):
    """Rows of numbers of an option that may be repeated."""
    try:
        return np.reshape(np.array(value, float), (-1, action.nargs)).tolist()
    except (TypeError, ValueError):
        raise InputError(
            f"{name} = {value!r:.80}: expected {' '.join(action.metavar)}, or a list of these;"
            " correct it"
        ) from None


def _fields_of(kind, parsed):
    """{name: value} of the fields of a record for which options were offered."""
    given = (
        (attribute.name, (attribute.metadata.get("option") or attribute.name).replace("-", "_"))
        for attribute in fields(kind)
    )
    return {name: getattr(parsed, option) for name, option in given if option in parsed}


def model_of(parsed):
    """The ModelOptions of parsed options, defaults where an option was not offered."""
    return ModelOptions(**_fields_of(ModelOptions, parsed))


def _damping(parsed):
    """(alpha [1/s], beta [s]) of --beta or --rayleigh, beta None where neither is given."""
    given = [name for name in ("beta", "rayleigh") if getattr(parsed, name, None)]
    if given and (parsed.pushover or parsed.cyclic):
        raise InputError(
            f"--{given[0]} with a pushed top: expected neither --beta nor --rayleigh, as a push is"
            " damped locally or adaptively; leave it out"
        )
    if getattr(parsed, "rayleigh", None) is None:
        return 0.0, parsed.beta
    if parsed.beta:
        raise InputError("--beta and --rayleigh given together: choose one kind of damping")
    return rayleigh_factors(*parsed.rayleigh)
