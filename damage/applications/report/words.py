"""Templates of pages, and words in English and Dutch, from page/words.toml."""

import tomllib
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

PAGE = Path(__file__).parent / "page"
"""Templates, styles, programs and words of pages."""
LANGUAGES = "en", "nl"


@cache
def environment():
    """What renders the templates of PAGE."""
    return Environment(
        loader=FileSystemLoader(PAGE),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


@cache
def all_words(page="pages"):
    """{key: {language: text}} of the sheet and of reports, or those of the page "app"."""
    pages = tomllib.loads((PAGE / "words.toml").read_text(encoding="utf-8"))
    app = pages.pop("app")
    return app if page == "app" else pages


def words(language, key, **values):
    """The text of a key with its values."""
    return all_words()[key][language].format(**values)


def number(language, value, digits=2):
    """A number with so many significant digits; a dash for None."""
    if value is None:
        return "-"
    text = f"{float(f'{value:.{digits}g}'):.10g}"
    return text.replace(".", ",") if language == "nl" else text


def of_hundred(row):
    """A share with its interval, {"share", "low", "high"}, of 100; a dash where there is none."""
    if row["share"] is None:
        return "-"
    share, low, high = (round(100 * row[name]) for name in ("share", "low", "high"))
    return f"{share} ({low}\u2011{high})"  # a hyphen at which no line breaks
