"""The words of the sheet, from words.toml, and numbers in a language's notation."""

import tomllib
from functools import cache
from pathlib import Path

LANGUAGES = "en", "nl"


@cache
def all_words():
    """{key: {language: text}}."""
    return tomllib.loads((Path(__file__).parent / "words.toml").read_text(encoding="utf-8"))


def words(language, key, **values):
    """The text of a key with its values."""
    return all_words()[key][language].format(**values)


def number(language, value, digits=2):
    """A number with so many significant digits; a dash for None."""
    if value is None:
        return "-"
    text = f"{float(f'{value:.{digits}g}'):.10g}"
    return text.replace(".", ",") if language == "nl" else text
