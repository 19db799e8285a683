"""How Sphinx makes a site of these documents: `bash scripts/site.sh`.

The documents are written to be read as they are, too: their links to files of the repository, which
a site does not have, become the files' names; docstrings are plain text, and shown so.  The site
also works when it is opened from a file: browsers refuse requests for other files there, so that no
page makes one.
"""

import json
import re
import sys
from itertools import groupby, starmap
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.applications import GROUPS  # noqa: E402, of this repository
from damage.arguments import OneLineParser  # noqa: E402
from damage.commands.table import COMMANDS, PROGRAMS, examples_of  # noqa: E402
from damage.run.options import make_parser  # noqa: E402
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
# Sphinx's own asks for each page; docs/_static/search_context.js does not
html_show_search_summary = False
html_search_scorer = str(Path(__file__).with_name("search_scorer.js"))
html_static_path = ["_static"]
html_css_files = ["narrow.css"]
html_favicon = "_static/brick.svg"
autodoc_preserve_defaults = True
# what is inherited is described once; of an array it would be numpy's own
autodoc_inherit_docstrings = False
autodoc_default_options = {"member-order": "bysource"}
add_module_names = False
smartquotes = False  # they make a dash of two, as options have them
nitpicky = False

_BLOCK = re.compile(r"^```{(modules|menu|readme)}(.*?)\n(.*?)```$", re.DOTALL | re.MULTILINE)


def write_out(app, name, source):
    """Replace three blocks of Markdown: `readme FILE` by that file, with the picture that moves;
    `modules` by a section a line; `menu README.md` by the toctrees of the pages that its table
    links, a part each, and the reference of all modules."""

    def written(block):
        if block[1] == "readme":
            text = (Path(app.srcdir) / block[2].strip()).read_text(encoding="utf-8")
            text = re.sub(r"\]\((?!https?:|#)", "](../", text).replace("](../docs/", "](")
            return text.replace("pictures/readme.png", "pictures/cracking.webp")
        if block[1] == "menu":
            return _menu((Path(app.srcdir) / block[2].strip()).read_text(encoding="utf-8"))
        return "\n\n".join(map(_module, re.split(r"\n(?! )", block[3].strip())))

    source[0] = _BLOCK.sub(written, source[0])


def _module(line):
    """The section of a module, whose line is `MODULE: NAME CLASS(METHOD ...) ...`: the docstrings
    of the module and of these names; of a class with parentheses these methods alone."""
    module, _, names = line.partition(":")
    shown = re.findall(r"(\w+)(\([^)]*\))?", names)
    whole = [name for name, methods in shown if not methods]
    directives = [_directive(f"automodule:: {module}", whole)]
    directives += [
        _directive(f"autoclass:: {module}.{name}", methods.strip("()").split())
        for name, methods in shown
        if methods
    ]
    return "\n".join([f"## {module}\n\n```{{eval-rst}}", *directives, "```"])


def _directive(what, members):
    shown = f"   :members: {', '.join(members)}\n" if members else ""
    return f".. {what}\n{shown}"


def _menu(text):
    """A toctree for each part of the table of docs/README.md."""
    part = ""
    parts = {}
    for cells in (line.split("|") for line in text.splitlines() if line.startswith("|")):
        part = cells[1].strip() or part  # an empty cell: as in the row before
        parts[part] = parts.get(part, []) + re.findall(r"\(([\w/-]+)\.md\)", cells[2])
    parts["reference"].append("api/index")
    return "\n\n".join(
        f"```{{toctree}}\n:caption: {part.capitalize()}\n:maxdepth: 1\n\n"
        + "\n".join(pages)
        + "\n```"
        for part, pages in parts.items()
        if pages
    )


_LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)#\s:]+)(#[^)]*)?\)")


def only_what_is_here(app, name, source):
    """Turn links to files that are no pages of the site into their names."""
    folder = (Path(app.srcdir) / name).parent

    def without_link(match):
        words = match[1]
        path = (folder / match[2]).resolve()
        page = path.suffix == ".md" and path.is_relative_to(app.srcdir) and path.name != "README.md"
        return match[0] if page or not path.exists() else f"{words} (`{path.relative_to(ROOT)}`)"

    source[0] = _LINK.sub(without_link, source[0])


_ARGUMENTS = re.compile(r"([*\w]+(?:, [*\w]+)*)((?: \[[^\]]*\])?[:;,] )")


def as_plain_text(app, what, name, obj, options, lines):
    """Show a docstring as it is written: paragraphs and arguments as such, drawings, formulas and
    sessions as they stand."""
    shown = []
    for is_blank, some in groupby(lines, key=lambda line: not line.strip()):
        group = list(some)
        if is_blank:
            shown.append("")
        elif group[0].startswith((" ", ">>>")) or "----------" in group:  # a section
            shown += ["::", "", *(f"    {line}" for line in group)]
        elif any(line.startswith(" ") for line in group) or all(map(_ARGUMENTS.match, group)):
            shown += [
                (
                    f"  {_escaped(line.strip())}"
                    if line.startswith(" ") or not _ARGUMENTS.match(line)
                    else _ARGUMENTS.sub(r"- **\1**\2", _escaped(line), 1)
                )
                for line in group
            ]
        else:
            shown += map(_escaped, group)
    lines[:] = [*shown, ""]


def _escaped(line):
    """A line of plain text as reStructuredText, what is in backticks as code."""
    return re.sub(r"`([^`]+)`", r"``\1``", re.sub(r"([\\*|]|_\b)", r"\\\1", line))


class Commands(Directive):
    """A section for each command of `python3 -m damage`: what it does, and its options."""

    def run(self):
        parsers = {"reference": make_parser("reference", "reference")}
        parsers["reference"].description = PROGRAMS["reference"].purpose.partition(" (see")[0]
        for name in (name for names in GROUPS.values() for name in names if name in COMMANDS):
            parsers[name] = OneLineParser(
                description=COMMANDS[name].purpose, examples=examples_of(name)
            )
            for add in COMMANDS[name].arguments:
                add(parsers[name])
        return list(starmap(_command, parsers.items()))


def _command(name, parser):
    """The section of one command."""
    purpose = f"{parser.description[:1].upper()}{parser.description[1:]}."
    options = nodes.definition_list(classes=["options"])
    words = parser.formatter_class("")
    for action in parser._actions:
        if action.dest != "help":
            options += nodes.definition_list_item(
                "",
                nodes.term("", "", nodes.literal("", words._format_action_invocation(action))),
                nodes.definition(
                    "", nodes.paragraph("", words._expand_help(action) if action.help else "")
                ),
            )
    examples = nodes.literal_block("", "\n".join(parser.examples), language="sh")
    return nodes.section(
        "",
        nodes.title("", name),
        nodes.paragraph("", purpose),
        options,
        examples,
        ids=[f"command-{name}"],
        names=[name],
    )


def keep_texts(app, error):
    """Write the text of every page for the search, which shows what is around the words that it
    found."""
    if error:
        return
    texts = {}
    for name in sorted(app.env.found_docs):
        page = app.env.get_doctree(name)
        for comment in list(page.findall(nodes.comment)):
            comment.parent.remove(comment)
        texts[name] = " ".join(page.astext().split())
    text = f"const SEARCH_TEXTS = {json.dumps(texts, ensure_ascii=False)};\n"
    (Path(app.outdir) / "_static" / "search_texts.js").write_text(text, encoding="utf-8")


def make_whole(app, error):
    """Make one file each of Debian's furo.js and furo.css and what they import: from a file no
    module loads, and the stylesheet is sought in the root of a server.  Debian's has dark colours
    for the button alone, not for the screen's own choice."""
    if error:
        return
    static = Path(app.outdir) / "_static"
    script = static / "scripts" / "furo.js"
    style = static / "styles" / "furo.css"
    text = script.read_text(encoding="utf-8")
    if imported := re.match(r'import \w+ from "\./([\w-]+\.js)";', text):
        library = script.with_name(imported[1]).read_text(encoding="utf-8")
        # A page's element with the id "exports" is an object of that name, by which the library
        # takes it for Node.
        whole = f"((define, exports, global) => {{{library}\n{text[imported.end() :]}}})();\n"
        script.write_text(whole, encoding="utf-8")
    text = style.read_text(encoding="utf-8")
    if imported := re.match(r"@import url\(/javascript/([^)]+)\);", text):
        library = Path("/usr/share/javascript", imported[1]).read_text(encoding="utf-8")
        text = library + text[imported.end() :]
    if "prefers-color-scheme" not in text and (
        dark := re.search(r'body\[data-theme="dark"\] ({[^{}]*})', text)
    ):
        text += (
            '@media not print { @media (prefers-color-scheme: dark) { body[data-theme="auto"]'
            f" {dark[1]} }} }}\n"
        )
    style.write_text(text, encoding="utf-8")


def add_context(app, page, template, context, doctree):
    """Load the texts where they are needed."""
    if page == "search":
        app.add_js_file("search_texts.js")
        app.add_js_file("search_context.js", loading_method="defer")


def setup(app):
    app.connect("source-read", write_out)
    app.connect("source-read", only_what_is_here)
    app.connect("autodoc-process-docstring", as_plain_text)
    app.connect("html-page-context", add_context)
    app.connect("build-finished", keep_texts)
    app.connect("build-finished", make_whole)
    app.add_directive("commands", Commands)
