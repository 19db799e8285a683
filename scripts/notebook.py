"""Runs the code cells of a notebook and keeps what they show in it, as Jupyter does, without
Jupyter.

    python3 scripts/notebook.py examples/thesis_figures.ipynb

Cells run in one namespace, in the notebook's folder.  An output is what a cell prints, figures of
pyplot that are open at its end, and the value of its last line: figures as PNG, tables as HTML,
others as text.
"""

import ast
import base64
import io
import json
import sys
from contextlib import chdir, redirect_stdout
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from damage.files import write_text

DPI = 75


def run_cells(cells, folder):
    """The cells with their outputs, run from the first to the last in a folder; a list of new
    cells."""
    names = {"__name__": "__main__"}
    done = []
    count = 0
    with chdir(folder):
        for cell in cells:
            if cell["cell_type"] == "code":
                count += 1
                ran = {
                    "outputs": outputs_of("".join(cell["source"]), names, count),
                    "execution_count": count,
                }
                done.append(cell | ran)
            else:
                done.append(cell)
    return done


def outputs_of(source, names, count=1):
    """What a cell shows, a list of outputs of nbformat 4; count: number of the cell among those
    that ran."""
    body = ast.parse(source).body
    printed = io.StringIO()
    value = None
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    with redirect_stdout(printed):
        exec(compile(ast.Module(body, []), "<cell>", "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), "<cell>", "eval"), names)
    outputs = [
        {"output_type": "stream", "name": "stdout", "text": printed.getvalue().splitlines(True)}
    ] * bool(printed.getvalue())
    if value is not None and not source.rstrip().endswith(";"):  # as in IPython
        outputs.append(
            {
                "output_type": "execute_result",
                "execution_count": count,
                "metadata": {},
                "data": shown(value),
            }
        )
    for number in plt.get_fignums():
        outputs.append(
            {"output_type": "display_data", "data": shown(plt.figure(number)), "metadata": {}}
        )
    plt.close("all")
    return outputs


def shown(value):
    """{MIME type: content} of a value."""
    if isinstance(value, Figure):
        png = io.BytesIO()
        value.savefig(png, format="png", dpi=DPI, metadata={"Software": None})
        size = "x".join(f"{inches * DPI:.0f}" for inches in value.get_size_inches())
        return {
            "image/png": base64.b64encode(png.getvalue()).decode() + "\n",
            "text/plain": [f"<Figure size {size}>"],
        }
    html = getattr(value, "_repr_html_", lambda: None)()
    return ({"text/html": html.splitlines(True)} if html else {}) | {
        "text/plain": repr(value).splitlines(True)
    }


if __name__ == "__main__":
    for path in map(Path, sys.argv[1:]):
        notebook = json.loads(path.read_text(encoding="utf-8"))
        notebook["cells"] = run_cells(notebook["cells"], path.resolve().parent)
        print(write_text(path, json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"))
