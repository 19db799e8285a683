"""A wall file of one's own, made of one that ships: `python3 -m damage new-wall FILE.py`."""

import ast
import re

from damage.checks import check_path
from damage.errors import InputError, did_you_mean
from damage.files import shipped_files, write_text

_OF_YADE = {"sys", "pathlib"}
"""Modules that the shipped files import only so that YADE finds the repository."""


def new_wall(path, source="symmetric"):
    """Write a wall file that makes the wall `source`, one that ships, under the file's name; returns its path.

    path: of the new file, .py added where it has no ending.  Raises InputError where it exists, and for an unknown
    source.
    """
    path, named = check_path(path), shipped_files("walls", ".py")
    path = path if path.suffix else path.with_suffix(".py")
    if path.suffix != ".py":
        raise InputError(f"{path}: expected a name that ends in .py; give it one")
    if path.exists():
        raise InputError(f"{path} exists: expected the name of a new file; give another, or delete it")
    if source not in named:
        raise InputError(f"--from {source}: expected a wall that ships: {', '.join(named)}"
                         f"{did_you_mean(source, named)}")
    return write_text(path, _text(named[source].read_text(encoding="utf-8"), source, path))


def _text(shipped, source, path):
    """The text of the new file: imports, constants and functions of the shipped one, without what is for YADE."""
    tree = ast.parse(shipped)
    title = ast.get_docstring(tree).splitlines()[0]
    kept = [node for node in tree.body if isinstance(node, (ast.FunctionDef, ast.Assign, ast.Import, ast.ImportFrom))
            and not _OF_YADE & _imported(node)]
    parts = [_segment(shipped, node) for node in kept]
    text = "".join(f"\n\n{part}\n" if isinstance(node, ast.FunctionDef) else f"{part}\n"
                   for node, part in zip(kept, parts))
    # its name in files and tables; a quote or backslash in it would end the string
    name = re.sub(r"""["'\\]""", "-", path.stem)
    head = _HEAD.format(path=path, source=source, title=title)
    return head + text.replace(f'name="{source}"', f'name="{name}"', 1)


_HEAD = '''"""A copy of the wall {source}: change its numbers.  Lengths in m, stresses in Pa, angles in radians.

{source}: {title}

    python3 -m damage modes {path}                              look at it, before anything shakes it
    python3 -m damage reference {path} --harmonic 0.2 0.05      a harmonic motion, 0.2 s, 0.05 g
    python3 -m damage reference {path} --record FILE            a recorded ground motion
"""

'''


def _imported(node):
    """Names of the modules that a node imports; none of another node."""
    return {alias.name for alias in node.names} if isinstance(node, ast.Import) else (
        {node.module} if isinstance(node, ast.ImportFrom) else set())


def _segment(text, node):
    """The lines of a node, with the comments inside of it."""
    return "\n".join(text.splitlines()[node.lineno - 1:node.end_lineno])
