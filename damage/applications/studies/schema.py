"""The JSON Schema of study files, made of their one definition: keys and limits of
`damage.applications.studies.definition`, options of the parsers of a run.

Editors with a TOML language server (Taplo, Even Better TOML) complete and check a study whose first
line is `#:schema ./study.schema.json`.  The schema knows keys, types, choices and what goes
together; whether files are there and values make sense is for `load_study` to say, which every
command calls.
"""

from itertools import combinations

from damage.applications.studies import definition
from damage.arguments import Rows, file_path
from damage.run.options import options_of_a_run
from damage.toml_file import DRAFT

_NUMBER = r"^-?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$"
_NAME = {"type": "string", "pattern": f"^{definition.ID.pattern}$"}
_VARIED = r"\{[A-Za-z_][A-Za-z0-9_]*\}"


def study_schema():
    """The schema, a dictionary fit for JSON."""
    return {
        "$schema": DRAFT,
        "title": "A study of masonry-damage",
        "type": "object",
        "additionalProperties": False,
        "required": ["name"],
        "anyOf": [{"required": ["runs"]}, {"required": ["grid"]}],
        "properties": _described(
            definition.KEYS,
            {
                "name": _NAME,
                "title": {"type": "string"},
                "pictures": {"enum": list(definition.PICTURES)},
                "conclusion": {"type": "string", "pattern": f"^{definition.CONCLUSION.pattern}$"},
                "states": {"type": "array", "items": {"type": "string", "pattern": ">"}},
                "intensity": {"type": "string"},
                "runs": {"type": "array", "items": _entry(grid=False)},
                "grid": {"type": "array", "items": _entry(grid=True)},
            },
        ),
    }


def _varied(schema):
    """A value may be the name of a varied one of a grid, too: a string with a name in braces."""
    if "enum" in schema:
        return {"anyOf": [schema, {"type": "string", "pattern": _VARIED}]}
    types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    if "string" in types:
        return schema | (
            {"pattern": f"{schema['pattern']}|{_VARIED}"} if "pattern" in schema else {}
        )
    # of strings, as all that follows is of its type
    return schema | {"type": [*types, "string"], "pattern": _VARIED}


def _entry(grid):
    """A table of one point, or of a grid."""
    whole = _varied({"type": "integer", "minimum": 1, "maximum": definition.MOST_MEMBERS})
    positive = _varied({"type": "number", "exclusiveMinimum": 0})
    entry = {
        "type": "object",
        "additionalProperties": False,
        "required": ["wall"],
        "properties": _described(
            definition.ENTRY_KEYS,
            {
                "id": _varied(_NAME | {"maxLength": definition.LONGEST_ID}),
                "wall": {"type": "string"},
                "options": _options(),
                "solvers": {
                    "type": "array",
                    "items": {"enum": list(definition.SOLVERS)},
                    "minItems": 1,
                },
                "members": whole,
                "scatter": positive,
                "samples": whole,
                "lives": whole,
            },
        ),
        "dependencies": {"scatter": ["members"]},
        "not": {
            "anyOf": [
                {"required": list(pair)}
                for pair in combinations(("members", "samples", "lives"), 2)
            ]
        },
    }
    if grid:
        values = {
            "type": ["array", "object"],
            "minItems": 1,
            "required": ["from", "to"],
            "additionalProperties": False,
            "properties": {key: {"type": "integer"} for key in ("from", "to")},
        }
        entry["anyOf"] = [{"required": [name]} for name in definition.GRID_KEYS]
        entry["properties"] |= _described(
            definition.GRID_KEYS,
            {
                "vary": {"type": "object", "minProperties": 1, "additionalProperties": values},
                "rows": {"type": "string"},
            },
        )
    return entry


def _described(meanings, schemas):
    """Schemas with what each is for; one for each of the meanings, or it is a fault of this
    module."""
    return {name: {"description": meaning, **schemas[name]} for name, meaning in meanings.items()}


def _options():
    """A table of a run's options, those of either solver, or a list of words."""
    properties = {
        action.option_strings[0].removeprefix("--"): {
            "description": action.help,
            **_varied(_option(action)),
        }
        for name, action in options_of_a_run().items()
        if name not in definition.RESERVED_OPTIONS
    }
    return {
        "type": ["object", "array"],
        "properties": properties,
        "additionalProperties": False,
        "items": {"type": ["string", "number"]},
    }


def _option(action):
    if action.nargs == 0:
        return {"type": "boolean"}
    item = _word(action)
    if isinstance(action, Rows):  # one row of numbers, or a list of rows
        row = {"type": "array", "items": item}
        return {"type": "array", "items": {"anyOf": [item, row]}, "minItems": 1}
    if isinstance(action.nargs, int):
        return {
            "type": "array",
            "items": _varied(item),
            "minItems": action.nargs,
            "maxItems": action.nargs,
        }
    if action.type is file_path:  # a list: the first of them that is there
        return {"type": ["string", "array"], "items": item, "minItems": 1}
    return item


def _word(action):
    """The schema of one word of an option; TOML's numbers may be written as words, too."""
    if action.choices is not None:
        return {"enum": list(action.choices)}
    kind = {float: "number", int: "integer"}.get(action.type)
    if kind is None:
        return {"type": "string" if action.type is file_path else ["string", "number"]}
    return {"type": [kind, "string"], "pattern": _NUMBER}
