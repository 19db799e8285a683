"""Exceptions that are printed in one line, and warnings."""

import sys
from contextlib import contextmanager, suppress
from contextvars import ContextVar

from damage.retired import retired

# characters that are shown of a message's beginning and, where it is longer, of its end
_LONGEST = 1200, 300


def one_line(text):
    r"""A text on one line: what would move or colour a terminal is escaped, what is long is cut in
    the middle.

    >>> one_line("a name with a \x1b[31m and a line\nfeed")
    'a name with a \\x1b[31m and a line\\nfeed'
    """
    return _cut(
        "".join(
            c if c.isprintable() else c.encode("unicode_escape").decode() for c in _cut(str(text))
        )
    )


def _cut(text):
    first, last = _LONGEST
    return text if len(text) <= first + last else f"{text[:first]} ... {text[-last:]}"


def did_you_mean(word, known):
    """Return the end of a message about a word that is not among the known ones: that it was
    removed and what to use instead (`damage.retired`), the nearest of the known ones, or nothing.

    >>> did_you_mean("symetric", ["solid", "symmetric"]), did_you_mean("x", ["solid"])
    ('; did you mean symmetric?', '')
    """
    from difflib import get_close_matches  # no command needs it before something is wrong

    if gone := retired(word):
        return f"; {gone.sentence}"
    near = get_close_matches(str(word), list(known), n=1)
    return f"; did you mean {near[0]}?" if near else ""


def some_of(items, most=5):
    """The first words of a list, and how many more there are.

    >>> some_of(["a", "b", "c"], most=2), some_of(["a"])
    ('a, b and 1 more', 'a')
    """
    return ", ".join(items[:most]) + (f" and {len(items) - most} more" if len(items) > most else "")


class Warned(str):  # noqa: FURB189, printed and written as any text
    """The text of a warning; code: a word by which programs know it (docs/reference/ranges.md).

    >>> Warned("courses", "a height of 0.3 m"), Warned("courses", "a height of 0.3 m").code
    ('a height of 0.3 m', 'courses')
    """

    def __new__(cls, code, text):
        made = super().__new__(cls, text)
        made.code = code
        return made

    def __getnewargs__(self):  # of copies and other processes
        return self.code, str(self)


_HEARD = ContextVar("heard", default=None)


@contextmanager
def heard():
    """While this lasts, collect warnings in the list that it yields, and print none."""
    texts = []
    before = _HEARD.set(texts)
    try:
        yield texts
    finally:
        _HEARD.reset(before)


def warn(*texts, code="run"):
    """Print warnings, a line each; where standard error takes nothing, as on a full disk, nothing
    ends for it.

    code: of those that are not Warned.
    """
    if _HEARD.get() is not None:
        _HEARD.get().extend(
            text if isinstance(text, Warned) else Warned(code, text) for text in texts
        )
        return
    with suppress(OSError):
        for text in texts:
            print(f"warning: {text}", file=sys.stderr, flush=True)


def of_locale(name):
    """Return the message about the name of a file that the locale's encoding has no letters for."""
    return (
        f"path {name!r}: the locale's encoding is {sys.getfilesystemencoding()}; expected UTF-8, in"
        " which this name is: set LC_ALL=C.UTF-8, and do not set PYTHONUTF8=0"
    )


class _OneLine(Exception):
    """An exception whose message is one line."""

    def __init__(self, message=""):
        super().__init__(one_line(message))


class InputError(_OneLine, ValueError):
    """Bad input: its one-line message says what was given, what was expected and how to correct
    it."""


class RunError(_OneLine, RuntimeError):
    """A run that cannot continue or whose result is not credible: its message is one line; code:
    by which a history says why a run was repeated."""

    code = "failure"


class RunWarning(UserWarning):
    """A condition under which results of `damage.run` are doubtful."""


class WriteError(OSError):
    """A history could not be written any further, as on a full disk: its message is one line."""
