"""The gate of habits: one assignment a line, and docstrings that begin with what they are about.

    python3 scripts/habits.py [FILE ...]    # by default all Python files that git tracks

Prints a line for each place; the exit status is 1 if there is one.
"""

import ast
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WITHOUT_SUBJECT = re.compile(r"\s*(Of|(That|Those|As|The same) of|The same (in|as|for)) ")
"""Beginnings of a docstring without a subject."""


def places(text):
    r"""(line, what) of each habit in the text of a module, in the order of the lines.

    >>> places('LEAST, MOST = 1, 2\nlow, high = high, low\n"Of a wall."')
    [(1, 'parallel assignment'), (3, 'docstring without a subject')]
    """
    return sorted(
        (node.lineno, what)
        for node in ast.walk(ast.parse(text))
        for what, applies in HABITS.items()
        if applies(node)
    )


def _is_parallel(node):
    """Whether a node is `a, b = x, y`, but one whose right side reads what the left side sets."""
    if not (isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple)):
        return False
    (target, *_) = node.targets
    if not isinstance(target, ast.Tuple) or len(target.elts) != len(node.value.elts):
        return False
    set_here = {ast.unparse(part) for part in target.elts}
    read = {ast.unparse(part) for part in ast.walk(node.value) if isinstance(part, ast.expr)}
    return not set_here & read


def _has_no_subject(node):
    """Whether a node is a docstring without a subject."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        and WITHOUT_SUBJECT.match(node.value.value) is not None
    )


HABITS = {
    "parallel assignment": _is_parallel,
    "docstring without a subject": _has_no_subject,
}
"""{name of a habit: whether a node of the syntax tree has it}."""


def main(files):
    """Search files, or all that git tracks; returns 1 if a habit is found."""
    tracked = ["git", "-C", str(ROOT), "ls-files", "*.py"]
    paths = [Path(name) for name in files] or [
        ROOT / name
        for name in subprocess.run(
            tracked, capture_output=True, text=True, check=True
        ).stdout.split()
        if (ROOT / name).exists()
    ]
    faults = [
        f"{path}:{line}: {what}"
        for path in paths
        for line, what in places(path.read_text(encoding="utf-8"))
    ]
    print(*faults, sep="\n", end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
