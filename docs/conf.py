"""How Sphinx makes a site of these documents: `bash scripts/site.sh`.

The documents are written to be read as they are, too: their links to files of the repository, which a site does not
have, become the files' names; docstrings are plain text, and shown so.
"""

import re
import sys
from itertools import groupby
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.__main__ import COMMANDS  # noqa: E402, of this repository
from damage.version import VERSION  # noqa: E402

project = "masonry-damage"
author = copyright = "the authors of masonry-damage"  # noqa: A001, Sphinx's name
release = version = VERSION
extensions = ["myst_parser", "sphinx.ext.autodoc"]
exclude_patterns = ["README.md", "tables"]
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
html_theme = "furo"
html_title = f"masonry-damage {VERSION}"
html_copy_source = html_show_copyright = False
autodoc_preserve_defaults = True
autodoc_default_options = {"members": True, "member-order": "bysource"}
nitpicky = False

_LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)#\s:]+)(#[^)]*)?\)")


def only_what_is_here(app, name, source):
    """Turn links to files that are no pages of the site into their names."""
    folder = (Path(app.srcdir) / name).parent

    def without_link(match):
        words, path = match[1], (folder / match[2]).resolve()
        page = path.suffix == ".md" and path.is_relative_to(app.srcdir) and path.name != "README.md"
        return match[0] if page or not path.exists() else f"{words} (`{path.relative_to(ROOT)}`)"

    source[0] = _LINK.sub(without_link, source[0])


def as_plain_text(app, what, name, obj, options, lines):
    """Show a docstring as it is written: paragraphs as such, what is indented or a session as it stands."""
    shown = []
    for is_blank, some in groupby(lines, key=lambda line: not line.strip()):
        group = list(some)
        if is_blank:
            shown.append("")
        elif any(line.startswith((" ", ">>>", "+-", "- ")) for line in group):
            shown += ["::", "", *(f"    {line}" for line in group)]
        else:
            shown += [re.sub(r"`([^`]+)`", r"``\1``", re.sub(r"([\\*|]|_\b)", r"\\\1", line)) for line in group]
    lines[:] = [*shown, ""]


class Commands(Directive):
    """A table of the commands of `python3 -m damage` and what they do."""

    def run(self):
        items = nodes.definition_list()
        for name, (_, purpose, _) in COMMANDS.items():
            items += nodes.definition_list_item("", nodes.term("", "", nodes.literal("", name)),
                                                nodes.definition("", nodes.paragraph("", purpose)))
        return [items]


def setup(app):
    app.connect("source-read", only_what_is_here)
    app.connect("autodoc-process-docstring", as_plain_text)
    app.add_directive("commands", Commands)
