"""Translate what a claim prints beside its sheet: `dutch.toml` has the Dutch of English sentences
with names in braces, and of terms."""

import re
import sys
import tomllib
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path

from damage.errors import InputError


@cache
def _table():
    """({term: term in Dutch}, [(pattern of a sentence, sentence in Dutch)]), the sentences with the
    longest text between their names first: shorter ones would take a part of it for a name."""
    file = Path(__file__).with_name("dutch.toml")
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    sentences = sorted(
        table["sentences"].items(), key=lambda pair: -len(re.sub(r"\{\w+\}", "", pair[0]))
    )
    return table["terms"], [(_pattern(english), dutch) for english, dutch in sentences]


def _pattern(sentence):
    """The expression of an English sentence, a group for each of its names."""
    return re.compile(re.sub(r"\\{(\w+)\\}", r"(?P<\1>.+?)", re.escape(sentence)), re.DOTALL)


def in_language(language, text):
    """A sentence in a language; as it is where that is English, or it is not known.

    >>> in_language("nl", "error: the computation is running already; stop it first")
    'fout: de berekening loopt al; stop die eerst'
    """
    if language != "nl":
        return text
    terms, sentences = _table()
    if text in terms:
        return terms[text]
    for pattern, dutch in sentences:
        if match := pattern.fullmatch(text):
            names = match.groupdict()
            translated = {name: in_language(language, part) for name, part in names.items()}
            return dutch.format(**{name: _decimal(part) for name, part in translated.items()})
    return text


def _decimal(text):
    """A text with the decimals of its numbers behind commas, and lists of numbers with semicolons.

    >>> _decimal("(0.5, 12) m, wall_2.5/a.csv, 1.2.3")
    '(0,5; 12) m, wall_2.5/a.csv, 1.2.3'
    """
    listed = re.sub(r"(?<=\d), (?=-?\d)", "; ", text)
    return re.sub(r"(?<![\w./-])(-?\d+)\.(\d+)(?![\w/]|\.\w)", r"\1,\2", listed)


class _Translated:
    """A stream that translates the lines written to it."""

    def __init__(self, stream, language):
        self._stream = stream
        self._language = language
        self._unfinished = ""

    def write(self, text):
        *lines, self._unfinished = (self._unfinished + text).split("\n")
        for line in lines:
            self._stream.write(f"{in_language(self._language, line)}\n")
        return len(text)

    def __getattr__(self, name):
        return getattr(self._stream, name)


@contextmanager
def translated_to(language):
    """While this lasts, translate what is printed, and what is raised as InputError."""
    with ExitStack() as stack:
        if language != "en":
            stack.enter_context(redirect_stdout(_Translated(sys.stdout, language)))
            stack.enter_context(redirect_stderr(_Translated(sys.stderr, language)))
        try:
            yield
        except InputError as error:
            raise InputError(in_language(language, str(error))) from error
