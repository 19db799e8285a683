"""Wall files: Python with a function `wall()` that returns a `damage.Wall`, or TOML, which is read
and not executed:

    #:schema ./wall.schema.json
    name = "shed"
    length = 3.08                       # keys and units of damage.Wall
    height = 2.7
    precompression = 0
    # Or tables [brick] and [joint]; beside them masonry = { young_modulus = 4.9e9 } replaces the
    # moduli of the bricks.
    masonry = { material = "clay-standard", format = "waalformaat" }
    lintel = "timber"                   # or a table, here and in [[openings]]

    [[openings]]
    left = 1.1
    width = 0.88
    height = 2.1

    [[floors]]
    level = 2.7
    mass = 800

    [[restraints]]                      # `damage.wall.restraints`
    side = "left"
"""

import re
import runpy
import traceback
from collections.abc import Callable
from dataclasses import MISSING, fields
from difflib import get_close_matches
from pathlib import Path

from damage.checks import check_path, check_range
from damage.elementary import atan
from damage.errors import InputError, did_you_mean
from damage.files import shipped_files
from damage.toml_file import DRAFT, read_toml
from damage.wall.floors import Floor
from damage.wall.lintels import KINDS_OF_LINTELS, Lintel
from damage.wall.materials import FORMATS, MATERIALS, masonry
from damage.wall.parameters import LISTS, NO_COHESION, Brick, Joint, Opening, Wall, brick_of_masonry

MOST_MB = 1
_NUMBER = {"type": "number"}
MASONRY_KEYS = {
    "material": {"enum": list(MATERIALS), "description": "name of a material"},
    "format": {"enum": list(FORMATS), "description": "name of a brick format"},
    "mortar": _NUMBER | {"description": "of joints [m]"},
    "wythes": {"type": "integer", "description": "bricks through the thickness"},
    "density": _NUMBER | {"description": "[kg/m3]"},
    "young_modulus": _NUMBER
    | {
        "description": "of masonry across its bed joints [Pa]; by itself, beside [brick] and"
        " [joint]"
    },
}
"""Schema of the keys of the table `masonry`, arguments of `damage.masonry`, which others of its
fields come from [joint]."""
FRICTION = "friction"
"""Key of [joint]: the friction coefficient, in place of the angle."""
_TABLES = {"brick": Brick, "joint": Joint}
_RECORDS = Wall, Opening, Floor, Lintel, Brick, Joint


def shipped_walls() -> dict[str, Path]:
    """{name: path} of the walls that ship, in Python and as data.

    >>> "symmetric" in shipped_walls()
    True
    """
    return shipped_files("walls", ".py") | shipped_files("walls", ".toml")


def shipped_houses() -> dict[str, Path]:
    """{name: path} of the houses that ship; beside them are files of their walls.

    >>> "terraced" in shipped_houses()
    True
    """
    files = shipped_files("houses", ".toml")
    return {name: path for name, path in files.items() if "[[walls]]" in path.read_text("utf-8")}


def wall_path(word: str | Path) -> Path:
    """Path of a file of a wall or a house, given by its path or by the name of one that ships, like
    symmetric; a file of that name comes first.  Raises InputError where there is neither.

    >>> wall_path("symmetric").name
    'symmetric.py'
    """
    path = check_path(word)
    named = shipped_walls() | shipped_houses()
    if path.is_file():
        return path
    if str(path) in named:
        return named[str(path)]
    beside = [str(path_) for ending in ("py", "toml") for path_ in path.parent.glob(f"*.{ending}")]
    meant = did_you_mean(path, beside) or did_you_mean(path.stem, named)
    raise InputError(
        f"{path}: no such wall file; expected the path of one, or the name of a wall or house that"
        f" ships: {', '.join(named)}{meant}"
    )


def load_wall(path: str | Path) -> Wall:
    """The wall of a file, by its path or the name of a wall that ships; InputError where the file
    is missing or makes no wall.

    >>> load_wall(wall_path("symmetric")).length
    4.05
    """
    path = wall_path(path)
    if path.suffix.lower() == ".toml":
        return wall_of(lambda: read_wall(path), path)

    def make():
        make_wall = runpy.run_path(str(path), run_name="wall_file").get("wall")
        return make_wall() if callable(make_wall) else None

    return wall_of(make, path)


def wall_of(make_wall: Callable, path: str | Path, kinds: type[Wall] | tuple = Wall) -> Wall:
    """The wall that `make_wall()` returns, a function of the file at `path`; InputError, with the
    line, where it fails or returns none of these kinds."""
    try:
        wall = make_wall()
    except (Exception, SystemExit) as error:
        message = (
            str(error)
            if isinstance(error, InputError)
            else f"failed with {_message_of(error)}; correct the file"
        )
        where = "" if message.startswith(str(path)) else f"{path}{_line(error, path)}: "
        raise InputError(f"{where}{message}") from error
    if not isinstance(wall, kinds):
        raise InputError(
            f"{path} has no function wall() that returns a damage.Wall; start from the copy that"
            " the command new-wall writes"
        )
    return wall


def _message_of(error):
    """Message of an error in a wall file; for an unknown keyword also the known ones."""
    message = f"{type(error).__name__}: {error.msg if isinstance(error, SyntaxError) else error}"
    match = re.search(r"(\w+)\.__init__\(\) got an unexpected keyword argument '(\w+)'", message)
    kind = match and next((record for record in _RECORDS if record.__name__ == match[1]), None)
    if not kind:
        return message
    names = [attribute.name for attribute in fields(kind)]
    near = get_close_matches(match[2], names, n=1)
    if match[2] == "cohesion" and kind is Brick:
        return f"Brick(cohesion=...): {NO_COHESION}"
    return (
        f"{kind.__name__}({match[2]}=...): expected "
        + (f"{near[0]}; it has " if near else "one of ")
        + ", ".join(names)
    )


def _line(error, path):
    """The line of the file in which an error came up, " line 7", or nothing where it is not
    known."""
    if isinstance(error, SyntaxError):
        line = error.lineno
    else:
        lines = [
            frame.lineno
            for frame in traceback.extract_tb(error.__traceback__)
            if Path(frame.filename).name == path.name
        ]
        line = lines[-1] if lines else None
    return f" line {line}" if line else ""


# --- walls as data: TOML, and its JSON Schema -----------------------------------------------------


def read_wall(path: str | Path) -> Wall:
    """The damage.Wall of a TOML file; InputError for anything that makes none."""
    return wall_from(read_toml(path, "a wall as TOML", MOST_MB))


def wall_from(table: dict) -> Wall:
    """The damage.Wall of a table {key: value} as a TOML file has it.

    >>> wall_from({"name": "pier", "length": 0.9, "height": 1.5}).height
    1.5
    """
    given = dict(table)
    if "walls" in given:
        raise InputError(
            "[[walls]] are of a house: expected one wall; houses run by ./yade FILE.toml"
        )
    if "joint" in given:
        given["joint"] = _joint(given["joint"])
    made = _masonry(given) if "masonry" in given else {}
    for name, kind in _TABLES.items():
        if name in given:
            made[name] = user_record(f"[{name}]", kind, given.pop(name))
    for name, kind in LISTS.items():
        if name in given:
            if not isinstance(given[name], list):
                raise InputError(
                    f"{name} is no list: expected tables [[{name}]]; double the brackets"
                )
            made[name] = user_records(f"[[{name}]]", kind, given.pop(name))
    return user_record("the wall", Wall, given | made)


def _joint(table):
    """The table [joint] with the friction angle of a friction coefficient."""
    if not isinstance(table, dict):
        raise InputError("joint: expected a table [joint]; correct it")
    _refuse_unknown("[joint]", table, [*(attribute.name for attribute in fields(Joint)), FRICTION])
    if FRICTION not in table:
        return table
    if "friction_angle" in table:
        raise InputError(
            "[joint] has friction and friction_angle: expected one of them; leave one out"
        )
    check_range("[joint] friction", table[FRICTION], 0, 100)
    angle = float(atan(table[FRICTION]))
    return {key: value for key, value in table.items() if key != FRICTION} | {
        "friction_angle": angle
    }


def _masonry(given):
    """{"brick", "joint"} of the table `masonry`, which is taken out of the given ones with [joint]
    and [brick]."""
    chosen = given.pop("masonry")
    joint = given.pop("joint", {})
    if isinstance(chosen, dict):
        _refuse_unknown("masonry", chosen, MASONRY_KEYS)
    if isinstance(chosen, dict) and set(chosen) == {"young_modulus"}:
        return _of_modulus(chosen["young_modulus"], given.pop("brick", {}), joint)
    if not isinstance(chosen, dict) or not {"material", "format"} <= set(chosen):
        raise InputError(
            'masonry: expected { material = "...", format = "..." }, or { young_modulus = ... }'
            " beside [brick] and [joint]; give one of these"
        )
    if "brick" in given:
        raise InputError("[brick] beside masonry by name: expected one of them; leave one out")
    return masonry(
        chosen["material"],
        chosen["format"],
        **{key: value for key, value in chosen.items() if key not in ("material", "format")},
        **joint,
    )


def _of_modulus(modulus, brick, joint):
    """{"brick", "joint"} of the tables [brick] and [joint] whose masonry has a modulus across its
    bed joints [Pa]."""
    made = {
        "brick": user_record("[brick]", Brick, brick),
        "joint": user_record("[joint]", Joint, joint),
    }
    if given := {"young_modulus", "shear_modulus"} & set(brick):
        raise InputError(
            f"[brick] {min(given)} beside masonry of young_modulus: expected one of them; leave"
            " one out"
        )
    return made | {"brick": brick_of_masonry(modulus, made["joint"], **brick)}


def user_records(what: str, kind: type, tables: list) -> list:
    """Records of tables, as of `user_record`, numbered from 1."""
    return [user_record(f"{what} {number}", kind, table) for number, table in enumerate(tables, 1)]


def user_record(what: str, kind: type, table: dict):
    """A record of a table; InputError for keys that it does not have, and for those that are
    missing."""
    if not isinstance(table, dict):
        raise InputError(f"{what} = {table!r}: expected a table of key = value lines; correct it")
    names = [attribute.name for attribute in fields(kind)]
    _refuse_unknown(what, table, [*names, *(["masonry"] if kind is Wall else [])])
    if isinstance(table.get("lintel"), dict):
        table = table | {"lintel": user_record(f"lintel of {what}", Lintel, table["lintel"])}
    missing = [name for name in _required(kind) if name not in table]
    if missing:
        raise InputError(f"{what} lacks {', '.join(missing)}: expected a value for each; give it")
    return kind(**table)


def _required(kind):
    """Names of the fields of a record that have no default."""
    return [
        attribute.name
        for attribute in fields(kind)
        if attribute.default is MISSING and attribute.default_factory is MISSING
    ]


def _refuse_unknown(what, table, known):
    if what == "[brick]" and "cohesion" in table:
        raise InputError(f"{what} has a cohesion: {NO_COHESION}")
    for name in table:
        if name not in known:
            raise InputError(
                f"{what} has the key {name}: expected one of {', '.join(known)}"
                f"{did_you_mean(name, known)}"
            )


def wall_schema() -> dict:
    """The JSON Schema of a wall as TOML, a dictionary fit for JSON: keys, types and choices;
    `read_wall` says what cannot be built."""
    special = {
        "name": {"type": "string", "pattern": "^[A-Za-z0-9_-]{1,100}$"},
        "outline": {
            "type": "array",
            "items": {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2},
        },
        "masonry": {
            "type": "object",
            "additionalProperties": False,
            "anyOf": [
                {"required": ["material", "format"]},
                {"required": ["young_modulus"], "maxProperties": 1},
            ],
            "properties": MASONRY_KEYS,
        },
        "lintel": {"anyOf": [{"enum": list(KINDS_OF_LINTELS)}, _object(Lintel, {})]},
        "brick": _object(Brick, {}),
        "joint": _object(Joint, {}, FRICTION),
    }
    special |= {
        name: {"type": "array", "items": _object(kind, special)} for name, kind in LISTS.items()
    }
    special["floors"]["items"]["anyOf"] = [
        {"required": ["mass"]},
        {"required": ["mass_per_area", "tributary_width"]},
    ]
    return {"$schema": DRAFT, "title": "A wall of masonry-damage"} | _object(
        Wall, special, "masonry"
    )


def _object(kind, special, *more):
    """Schema of a record: as its fields say, but for what is special; more: keys of numbers besides
    its fields."""
    properties = {
        attribute.name: special.get(attribute.name) or _schema_of(attribute.metadata)
        for attribute in fields(kind)
    }
    return {
        "type": "object",
        "additionalProperties": False,
        "required": _required(kind),
        "properties": properties | {key: special.get(key, _NUMBER) for key in more},
    }


def _schema_of(metadata):
    """Schema of a field by its metadata (`damage.fields`)."""
    if metadata["choices"]:
        return {"enum": list(metadata["choices"])}
    constants = [{"const": word} for word in metadata["words"]]
    return {"anyOf": [_NUMBER, *constants]} if constants else _NUMBER
