"""What a claim says beside its sheet, in Dutch: sentences of English are looked up in
`dutch.toml`."""

import re
import sys
import tomllib
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path

from damage.errors import InputError


def _most_words(sentence):
    return -len(re.sub(r"\{\w+\}", "", sentence[0]))


@cache
def _table():
    """({term: term in Dutch}, [(pattern of a sentence, sentence in Dutch)]), the patterns of most
    words first: others hold a part of a sentence for a name."""
    file = Path(__file__).with_name("dutch.toml")
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    sentences = [
        (re.compile(re.sub(r"\\{(\w+)\\}", r"(?P<\1>.+?)", re.escape(english)), re.DOTALL), dutch)
        for english, dutch in sorted(table["sentences"].items(), key=_most_words)
    ]
    return table["terms"], sentences


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
            return dutch.format(
                **{
                    name: _decimal(in_language(language, part))
                    for name, part in match.groupdict().items()
                }
            )
    return text


def _decimal(text):
    """A text with the decimals of its numbers behind commas, and lists of numbers with semicolons.

    >>> _decimal("(0.5, 12) m, wall_2.5/a.csv, 1.2.3")
    '(0,5; 12) m, wall_2.5/a.csv, 1.2.3'
    """
    listed = re.sub(r"(?<=\d), (?=-?\d)", "; ", text)
    return re.sub(r"(?<![\w./-])(-?\d+)\.(\d+)(?![\w/]|\.\w)", r"\1,\2", listed)


class _Said:
    """A stream that has its lines in a language."""

    def __init__(self, stream, language):
        self._stream = stream
        self._language = language
        self._begun = ""

    def write(self, text):
        *lines, self._begun = (self._begun + text).split("\n")
        for line in lines:
            self._stream.write(f"{in_language(self._language, line)}\n")
        return len(text)

    def __getattr__(self, name):
        return getattr(self._stream, name)


@contextmanager
def said_in(language):
    """While this lasts, what is printed and raised as InputError is in a language."""
    with ExitStack() as stack:
        if language != "en":
            stack.enter_context(redirect_stdout(_Said(sys.stdout, language)))
            stack.enter_context(redirect_stderr(_Said(sys.stderr, language)))
        try:
            yield
        except InputError as error:
            raise InputError(in_language(language, str(error))) from error
