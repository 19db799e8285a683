"""The options of a run, the same for every solver, and the frozen record that they become."""

import argparse
import hashlib
import math
import os
import re
import sys
from dataclasses import fields, replace
from functools import lru_cache
from itertools import takewhile
from pathlib import Path

import numpy as np

from damage.checks import check_path
from damage.errors import InputError, did_you_mean
from damage.exposure.lives import events_of, read_address
from damage.fields import MOST_SEED, option_of
from damage.measure.crack_file import Surveyed
from damage.motion.columns import UNITS_M_S2
from damage.motion.formats import read_record
from damage.motion.loading import BOUNDARIES, AtRest, FreeVibration, Harmonic, Recorded, TopDisplacement
from damage.motion.record import aligned_with, on_axis_of
from damage.motion.sequence import read_sequence, strongest
from damage.motion.settlement import PROFILES, Settlement, read_profile
from damage.provenance import shown_command
from damage.run.settings import AFTER_FALL_S, RELAXATIONS, RunSettings, rayleigh_factors
from damage.units import MILLIMETRE
from damage.wall.model_options import ModelOptions
from damage.wall.plausible import ACCEPT

USUAL_DISTORTION = 1 / 500
_EXAMPLES = {
    "reference": ("python3 -m damage reference symmetric --harmonic 0.2 0.05 --members 8",
                  "python3 -m damage reference my_wall.toml --record record.csv --window 17 27 --out run.h5"),
    "yade": ("./yade symmetric --harmonic 0.2 0.05 --console",
             "./yade solid --pushover 0.1 --boundary fixed --out pushed.h5")}

BY_FILE = "file"
"""Of --unit: the unit that the file names; for tables whose cells may not be empty."""

WALLS_ARE_CODE = "A wall file is Python and is executed: read a file from someone else before you use it."
"""For the help of every command that takes one."""


class _Help(argparse.HelpFormatter):
    """Help whose texts of several lines, as examples are, stand as they are."""

    def _fill_text(self, text, width, indent):
        return text if "\n" in text else super()._fill_text(text, width, indent)


class OneLineParser(argparse.ArgumentParser):
    """An argument parser that raises its complaint as InputError instead of printing the usage.

    examples: command lines, which its help ends with.
    """

    def __init__(self, *args, examples=(), **kwargs):
        self.examples = examples
        more = {"epilog": "\n  ".join(["examples:", *examples])} if examples else {}
        super().__init__(*args, **{"formatter_class": _Help, **more, **kwargs})
        # argparse takes -1e-5 for an option; it is a number.
        self._negative_number_matcher = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")

    def parse_known_args(self, args=None, namespace=None):
        """As argparse's; an unknown option is refused first, since it may be the wrong name of one that is required."""
        args = sys.argv[1:] if args is None else list(args)
        # Behind a command they are the command's.
        mine = takewhile(lambda word: word.startswith("-") if self._subparsers else word != "--", args)
        for name in (word.partition("=")[0] for word in mine if word.startswith("--")):
            if name != "--" and name not in self._option_string_actions:
                self.error(f"unrecognized arguments: {name}{did_you_mean(name, self._option_string_actions)}")
        return super().parse_known_args(args, namespace)

    def error(self, message):
        raise InputError(f"{message}{' ' if message.endswith('?') else '; '}see --help")


def file_path(word):
    """The type of an option that names a file or a folder."""
    try:
        return check_path(word)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def number_from(least, most, kind=float):
    """The type of an option that is a number from `least` to `most`; kind: int for a whole one."""
    def convert(word):
        value = kind(word)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{word}: expected a number from {least:g} to {most:g}; correct it")
        return value

    convert.__name__ = kind.__name__  # for what argparse says of a word that is none
    return convert


def arg(*names, **options):
    """A function that adds this argument to a parser, or a group of one, as `add_argument` takes it."""
    return lambda parser: parser.add_argument(*names, **options)


def file_arg(name, metavar, help_=None, **options):
    """The same of a path."""
    return arg(name, type=file_path, metavar=metavar, help=help_, **options)


def flag(name, help_, **options):
    """The same of an option without a value."""
    return arg(name, action="store_true", help=help_, **options)


def group(title, *arguments):
    """A function that adds these arguments to the group of a parser with this title."""
    def add(parser):
        named = (one for one in parser._action_groups if one.title == title)
        titled = next(named, None) or parser.add_argument_group(title)
        for one in arguments:
            one(titled)
    return add


def fraction(word):
    """The type of an option that is a number, or two with a stroke between, like 1/500."""
    over, _, under = word.partition("/")
    try:
        return float(over) / (float(under) if under else 1.0)
    except (ValueError, ZeroDivisionError) as error:
        raise argparse.ArgumentTypeError(f"{word}: expected a number, or a fraction like 1/500; correct it") from error


def _field(one, default, help_):
    """The argument of a field of a record."""
    kind = str if one.metadata["choices"] else float if one.default is None else type(one.default)
    return arg(option_of(one), type=kind, choices=one.metadata["choices"], metavar=one.metadata["metavar"],
               default=default, help=help_)


def model_arguments(*names):
    """Arguments of the named fields of ModelOptions, a list."""
    chosen = [one for one in fields(ModelOptions) if one.name in names]
    usual = [one.default if isinstance(one.default, str) else f"{one.default:g}" for one in chosen]
    return [_field(one, one.default, f"{one.metadata['help']} (default {default})")
            for one, default in zip(chosen, usual)]


def _settings(*names):
    """Arguments of the named fields of RunSettings, a list."""
    return [_field(one, None if None in one.metadata["words"] else one.default, one.metadata["help"])
            for one in fields(RunSettings) if one.name in names]


ACCEPTING = flag(ACCEPT, "take the values of the wall and the motion as given, even where they look like a wrong unit "
               "(docs/reference/ranges.md)")
"""The option that accepts implausible values."""
PREPARATION = (
    arg("--unit", choices=(BY_FILE, *UNITS_M_S2), help="unit of a record whose file names none, or contradicts itself "
        f"(default {BY_FILE}: as the file says)"),
    arg("--sample-step", type=float, metavar="S", help="time between two samples of a record whose file has one "
        "column, sample numbers or rounded times"),
    arg("--scale", type=float, help="factor on the record (default 1)"),
    arg("--window", nargs=2, type=float, metavar=("T0_S", "T1_S"), help="part of the record to use"),
    arg("--baseline", type=int, metavar="ORDER", help="subtract a polynomial of this order from the record"),
    arg("--band", nargs=2, type=float, metavar=("LOW_HZ", "HIGH_HZ"),
        help="band-pass the record, 4th order Butterworth, zero phase (default: no filter)"),
    file_arg("--across", "FILE", "the record's other horizontal component, which is not applied: with it there are "
             "measures of the largest of all directions (RotD100)"))
"""The options that prepare a record; `recorded` reads them."""
_GROUPS = {
    "motion (one of; default --harmonic 0.2 0.05)": (
        arg("--harmonic", nargs=2, type=float, metavar=("PERIOD_S", "AMPLITUDE_G"),
            help="sinusoidal base acceleration that starts at zero"),
        arg("--cycles", type=int, help="cycles of the harmonic motion (default 3), or at each drift of --cyclic "
            "(default 2)"),
        file_arg("--record", "FILE", "recorded ground motion: CSV, PEER AT2, or miniSEED with StationXML beside it "
                 "(docs/guides/own-record.md)"),
        *PREPARATION,
        file_arg("--vertical", "FILE", "the record's vertical component"),
        flag("--free-vibration", "free vibration in the first mode, which starts with 1 mm/s at the top",
             default=None),
        arg("--sequence", metavar="F,F,...|FILE.csv", help="events on the same wall, damage carried over: the harmonic "
            "or recorded motion times each factor, then rest and settling (default 1); or different records, a row of "
            "a CSV file each (docs/guides/own-record.md)")),
    "quasi-static loading, instead of a motion": (
        arg("--pushover", type=float, metavar="DRIFT_PCT", help="push the top to this drift, after --settle from where "
            "it stands then"),
        arg("--cyclic", metavar="PCT,PCT,...", help="push the top cyclically to these drifts"),
        arg("--boundary", choices=BOUNDARIES,
            help="the pushed top may rotate (cantilever, default), or not (fixed)"),
        arg("--top-rotation", type=float, metavar="N_M_RAD", help="rotational spring between the pushed top and what "
            "moves it (default 0: free; reference solver)"),
        arg("--speed", type=float, metavar="M_S", help="speed of the pushed top (default 0.005)"),
        arg("--damping", type=float, metavar="C", help="local damping of the pushed wall, 0 to 0.7 (default 0.7); the "
            "reference solver has it with --relaxation local only")),
    "settlement of the ground, before the motion or without one": (
        file_arg("--settle", f"{'|'.join(PROFILES)}|FILE.csv", "move a support below each brick of the base by this "
                 "profile, or by points x_m,uz_m, or levels x_m,height_m,date, of a file; without a motion the run "
                 "ends then"),
        arg("--distortion", type=fraction, metavar="1/500", help="of a named profile: relative deflection over half "
            f"the wall's length, or the angle of tilt and knick (default 1/{1 / USUAL_DISTORTION:g})")),
    "a life: the earthquakes at an address, one after the other, instead of a motion": (
        file_arg("--address", "ADDRESS.toml", "where, and how motions are chosen (docs/guides/groningen.md)"),
        arg("--event", metavar="DATE", help="one earthquake of the catalogue, like 2012-08-16, instead of a life: a "
            "record scaled to its median PGV at the address; with --life to the PGV drawn there"),
        arg("--life", type=number_from(1, MOST_SEED, int), metavar="N", help="number of the life: by it motions are "
            "drawn and, where --strength-cov is given, the joints' strengths")),
    "the wall's past": (
        file_arg("--continue", "FILE.h5", "start from the end of this run of the same wall, as if it had continued; in "
                 "YADE one with --checkpoint"),
        file_arg("--cracked", "CRACKS.csv", "joints along these cracks have no bond from the start "
                 "(docs/reference/crack-format.md; the last load level; widths are not used)"),
        arg("--tolerance-mm", type=number_from(1e-3, 1000), metavar="MM", help="how far from a joint a crack of "
            "--cracked may be drawn (default: half a brick's length)"))}
"""{title: arguments} of the groups of a run's options that every solver has."""
_NO_EFFECT = {"reference": [("--step", ("fast", "plain"), "there is one time step")],
              "yade": [("--joints", ("face",), "joints keep their face's normal")]}
"""{solver: [(option, its values, why it has no effect any more)]}."""


def _model_arguments(solver):
    of_reference = [] if solver != "reference" else [
        arg("--rayleigh", nargs=3, type=float, metavar=("RATIO", "F1_HZ", "F2_HZ"),
            help="mass- and stiffness-proportional damping with this ratio at two frequencies"),
        arg("--relaxation", default="adaptive", choices=RELAXATIONS, help="damping of the static stage and of a pushed "
            "top: adaptive (default), or local as in YADE"),
        *_settings("settling", "mass_scaling")]
    return [*model_arguments(*(one.name for one in fields(ModelOptions))), *_settings("beta_s"), *of_reference,
            *_settings("perturb_m", "scatter", "seed", "members"), ACCEPTING]


def _run_arguments(solver):
    free = "fall freely" if solver == "reference" else "collide with sharper corners; half a height's fall ends the run"
    of_yade = [] if solver != "yade" else [
        *_settings("past_collapse_s"), flag("--view", "with a screen: the 3D view"),
        arg("--console", nargs="?", const="after", choices=("before", "after"), help="YADE's prompt before or after "
            "(default) the run, with O, wall, run, scene, and history after it")]
    return [
        file_arg("--out", "FILE.h5", "history file (default: a free name below results/)"),
        flag("--overwrite", "replace an existing FILE.h5 and its pictures in FILE"),
        flag("--stresses", "keep normal and shear stress of all joints at every sample (docs/guides/reading-results.md)"
             "; the run says first how large they are"),
        arg("--point", nargs=2, type=number_from(-1000, 1000), action="append", metavar=("X_M", "Z_M"),
            help="keep the displacement of this point of the wall at every sample; repeatable"),
        arg("--checkpoint", type=number_from(1e-3, 1e5), metavar="MINUTES", help="keep the state in FILE.checkpoint, "
            "each time after so many minutes of computing, in YADE at the end, too (default: at an interruption)"),
        file_arg("--resume", "FILE.h5", "continue this run, which was interrupted or killed, from its last checkpoint; "
                 "the other options as they were. A checkpoint of YADE can execute code: continue runs of your own "
                 "only"),
        *_settings("rest_s", "time_step_s"),
        arg("--no-pictures", dest="pictures", action="store_false", help="write the history only"),
        flag("--quiet", "print warnings and errors only"),
        flag("--new-contacts", "bricks whose joints have ended fall, collide and come to rest; the run ends with the "
             f"first fallen brick (default: they {free})"),
        flag("--after-fall", "with --new-contacts: follow the bricks until the wall rests, "
             f"{AFTER_FALL_S:g} s at most (default: end with the first fallen brick)"),
        *(arg(option, choices=choices, help=f"of no effect since {why}; accepted in this version")
          for option, choices, why in _NO_EFFECT.get(solver, ())),
        *of_yade]


def parse_run(arguments, prog, solver):
    """RunSettings from a command line (a list of words) of `solver`, "yade" or "reference"."""
    parsed = make_parser(prog, solver).parse_args(arguments)
    life, model = _life_of(parsed), model_of(parsed)
    if parsed.life is not None and model.strength_cov:  # strengths are drawn by the number of a life, too
        model = replace(model, strength_seed=parsed.life)
    alpha_1_s, beta_s = _damping(parsed)
    return RunSettings(**_fields_of(RunSettings, parsed) | _motion(parsed) | {
        "life": life, "settlement": settlement_of(parsed), "cracked": _surveyed(parsed), "model": model,
        "continued": getattr(parsed, "continue") and str(getattr(parsed, "continue")), "alpha_1_s": alpha_1_s,
        "checkpoint_s": math.inf if parsed.checkpoint is None else 60 * parsed.checkpoint,
        "points": tuple(map(tuple, parsed.point or ())),
        "resumed": parsed.resume and str(parsed.resume), "out": parsed.out or parsed.resume,
        "beta_s": beta_s, "command": f"{prog} {shown_command(arguments)}".strip()})


@lru_cache(maxsize=4)  # a study asks for one for each of its runs
def make_parser(prog, solver):
    """The parser of a run's command line."""
    parser = OneLineParser(prog=prog, allow_abbrev=False, examples=_EXAMPLES.get(solver, ()), description=(
        f"Shake one wall ({solver} solver) and write its history, summary and pictures. {WALLS_ARE_CODE}"))
    for title, arguments in (_GROUPS | {"model": _model_arguments(solver), "run": _run_arguments(solver)}).items():
        group(title, *arguments)(parser)
    return parser


def words_of(options, solver, call):
    """Command line, a list of words, for options of a solver by their names in Python; call: the function that took
    them.  Raises InputError for an unknown name."""
    actions = {action.dest: action for action in make_parser("", solver)._actions if action.dest != "help"}
    unknown = [name for name in options if name not in actions]
    if unknown:
        raise InputError(f"{call}({unknown[0]}=...): expected one of {', '.join(actions)}"
                         f"{did_you_mean(unknown[0], actions)}")
    return [word for name, value in options.items() for word in _option(actions[name], name, value)]


def _option(action, name, value):
    """Words of one option on the command line; none where its value is None or the default of a flag."""
    if value is None:
        return []
    option = action.option_strings[0]
    if action.nargs == 0:
        if not isinstance(value, bool):
            raise InputError(f"{name} = {value!r}: expected True or False; give one of them")
        return [option] if value is action.const else []
    if isinstance(action, argparse._AppendAction):
        try:
            rows = np.reshape(np.array(value, float), (-1, action.nargs)).tolist()
        except (TypeError, ValueError):
            raise InputError(f"{name} = {value!r:.80}: expected {' '.join(action.metavar)}, or a list of these; "
                             "correct it") from None
        return [word for one in rows for word in (option, *map(str, one))]
    values = list(value) if isinstance(value, (tuple, list, np.ndarray)) else [value]
    words = [repr(float(one)) if isinstance(one, np.floating) else str(one) for one in values]
    return [option, *words] if action.nargs else [option, ",".join(words)]


def _surveyed(parsed):
    tolerance_mm = parsed.tolerance_mm
    if parsed.cracked is None:
        if tolerance_mm is not None:
            raise InputError("--tolerance-mm belongs to --cracked; give both")
        return None
    return Surveyed.read(parsed.cracked, None if tolerance_mm is None else tolerance_mm * MILLIMETRE)


def settlement_of(parsed):
    """The Settlement of parsed options, None without one."""
    drawn = parsed.life is not None and read_address(parsed.address).settlement(parsed.life)
    if drawn and parsed.settle is not None:
        raise InputError(f"--settle {parsed.settle} and {parsed.address}, whose lives draw the settlement: expected "
                         "one of them; leave --settle or the key settle out")
    if parsed.settle is None:
        if parsed.distortion is not None:
            raise InputError("--distortion belongs to --settle; give both")
        return drawn or None
    if str(parsed.settle) in PROFILES:
        given = parsed.distortion
        return Settlement(str(parsed.settle), USUAL_DISTORTION if given is None else given)
    if parsed.settle.suffix.lower() != ".csv":
        raise InputError(f"--settle {parsed.settle}: expected one of {', '.join(PROFILES)}, or a CSV file; correct it")
    if parsed.distortion is not None:
        raise InputError("--distortion beside a profile from a file: the file says how far the ground settles; leave "
                         "it out")
    return read_profile(parsed.settle)


def _fields_of(kind, parsed):
    """{name: value} of the fields of a record for which options were offered."""
    given = ((one.name, (one.metadata.get("option") or one.name).replace("-", "_")) for one in fields(kind))
    return {name: getattr(parsed, option) for name, option in given if option in parsed}


def model_of(parsed):
    """The ModelOptions of parsed options, defaults where an option was not offered."""
    return ModelOptions(**_fields_of(ModelOptions, parsed))


_LONGEST_STEM = 200  # bytes; a character has up to four
_READ = "unit", "sample_step"
_BELONGS = {"cycles": ("harmonic", "cyclic"),
            **dict.fromkeys(("boundary", "top_rotation", "speed", "damping"), ("pushover", "cyclic")),
            "sequence": ("harmonic", "record"),
            **dict.fromkeys((*_READ, "scale", "window", "vertical", "across", "baseline", "band"), ("record",))}


def _motion(parsed):
    if parsed.event is not None:
        return _event(parsed)
    if parsed.life is not None:
        return _events(events_of(read_address(parsed.address).life(parsed.life), parsed.rest))
    if not (parsed.sequence or "").lower().endswith(".csv"):
        factors = (1.0,) if parsed.sequence is None else _numbers("--sequence", parsed.sequence, "factors", "1,0.5,0.4")
        return {"loading": _loading(parsed), "sequence": factors}
    owned = (*_MOTIONS, *_READ, "cycles", "scale", "window", "vertical", "across")
    if given := [name for name in owned if getattr(parsed, name) is not None]:
        raise InputError(f"--sequence {parsed.sequence} and --{given[0].replace('_', '-')}: expected one of them, as "
                         "the file has the records, their scales and windows; leave the other out")
    events = read_sequence(check_path(parsed.sequence), parsed.rest, **_given(
        baseline_order=parsed.baseline, band_hz=parsed.band and tuple(parsed.band)))
    return _events(events)


def _event(parsed):
    """The fields of RunSettings that are about --event: the motion of a record, scaled."""
    draws = read_address(parsed.address)
    table = draws.event(parsed.event, parsed.life)
    (motion,), (row,) = events_of(table, parsed.rest), table.to_dict("records")
    return {"loading": replace(motion.loading, scale=motion.factor), "sequence": (1.0,),
            "event": row | {"life": parsed.life, **draws.as_dict()}}


def _events(events):
    return {"loading": strongest(events).loading, "sequence": tuple(event.factor for event in events), "events": events}


def _life_of(parsed):
    """What decides the life of parsed options, fit for JSON; None without one, or for one event.  Raises InputError
    where an option does not go with it."""
    asked = "event" if parsed.event is not None else "life"
    if (parsed.address is None) != (getattr(parsed, asked) is None):
        raise InputError("--address ADDRESS.toml and --life N, or --event DATE: expected both; give the other one, too")
    if parsed.address is None:
        return None
    others = (*_MOTIONS, *_READ, "sequence", "cycles", "scale", "window", "vertical", "across", "baseline", "band")
    if given := [name for name in others if getattr(parsed, name) is not None]:
        raise InputError(f"--{asked} and --{given[0].replace('_', '-')}: expected one of them, as the address decides "
                         "the motions; leave the other out")
    return None if asked == "event" else {"number": parsed.life, **read_address(parsed.address).as_dict()}


_MOTIONS = ("harmonic", "record", "free_vibration", "pushover", "cyclic")


def _loading(parsed):
    """The loading that the motion options ask for, or InputError where they contradict each other."""
    chosen = [name for name in _MOTIONS if getattr(parsed, name) is not None]
    if len(chosen) > 1:
        raise InputError(f"--{' and --'.join(chosen)} given together: choose one motion".replace("_", "-"))
    motion = chosen[0] if chosen else "harmonic" if parsed.settle is None or parsed.cycles is not None else "at_rest"
    for option, owners in _BELONGS.items():
        if getattr(parsed, option) is not None and motion not in owners:
            raise InputError(f"--{option.replace('_', '-')} belongs to --{' or --'.join(owners)}, not to "
                             f"--{motion.replace('_', '-')}; leave it out")
    return {"harmonic": _harmonic, "at_rest": lambda parsed: AtRest(), "record": recorded,
            "free_vibration": lambda parsed: FreeVibration(),
            "pushover": _pushed, "cyclic": _pushed}[motion](parsed)


def _damping(parsed):
    """(alpha [1/s], beta [s]) of --beta or --rayleigh, beta None where neither is given."""
    if getattr(parsed, "rayleigh", None) is None:
        return 0.0, parsed.beta
    if parsed.beta:
        raise InputError("--beta and --rayleigh given together: choose one kind of damping")
    return rayleigh_factors(*parsed.rayleigh)


def _harmonic(parsed):
    return Harmonic(*(parsed.harmonic or (0.2, 0.05)), **_given(cycles=parsed.cycles))


def _given(**options):
    """The options that were given; of the others the loading has its own default."""
    return {name: value for name, value in options.items() if value is not None}


def _numbers(option, words, what, example):
    try:
        return tuple(float(word) for word in words.split(","))
    except ValueError as error:
        raise InputError(f"{option} {words}: expected {what} with commas between, like {example}") from error


def _pushed(parsed):
    more = _given(boundary=parsed.boundary, speed_m_s=parsed.speed, local_damping=parsed.damping,
                  top_rotation=parsed.top_rotation)
    if parsed.pushover is not None:
        return TopDisplacement((parsed.pushover,), cycles=0, **more)
    if parsed.cycles is not None and parsed.cycles < 1:
        raise InputError(f"--cycles {parsed.cycles}: expected at least one cycle at each drift; correct it")
    return TopDisplacement(_numbers("--cyclic", parsed.cyclic, "drifts in percent", "0.05,0.1,0.2"),
                           **_given(cycles=parsed.cycles), **more)


def recorded(parsed):
    """The Recorded motion of parsed options: `record`, those of PREPARATION, and `vertical` where offered."""
    given = {"unit": None if parsed.unit == BY_FILE else parsed.unit, "sample_step_s": parsed.sample_step}
    record, vertical = read_record(parsed.record, **given), getattr(parsed, "vertical", None)
    window = parsed.window and tuple(parsed.window)
    across = parsed.across and on_axis_of(read_record(parsed.across, **given), record, window)
    return Recorded(
        record, vertical=aligned_with(read_record(vertical, **given), record) if vertical else None, across=across,
        **_given(scale=parsed.scale, window_s=window, baseline_order=parsed.baseline,
                 band_hz=parsed.band and tuple(parsed.band)))


def free_name(wall, settings, solver, folder="results"):
    """A path for the history that does not exist yet: WALL_MOTION_SOLVER.h5, then _2, _3, ..."""
    settled = [f"settle-{settings.settlement.name}"] if settings.settlement else []
    parts = [wall.name, *settled, settings.loading.name, solver, *settings.model.tags()]
    if settings.events:
        parts[1 + len(settled):2 + len(settled)] = [f"sequence-of-{len(settings.events)}", settings.loading.name]
    elif settings.sequence != (1.0,):
        parts.append("sequence-" + "-".join(f"{factor:g}" for factor in settings.sequence))
    stem, count = "_".join(parts), 1
    if len(os.fsencode(stem)) > _LONGEST_STEM:
        stem = f"{stem[:_LONGEST_STEM // 4 - 9]}_{hashlib.sha256(stem.encode()).hexdigest()[:8]}"
    while True:
        path = Path(folder) / f"{stem}{'' if count == 1 else f'_{count}'}.h5"
        if not path.exists() and not (settings.pictures and pictures_folder(path).exists()):
            return path
        count += 1


def pictures_folder(path):
    """Folder for the pictures of a run whose history is FILE.h5: FILE beside it."""
    return path.with_suffix("")
