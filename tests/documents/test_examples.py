"""The examples: short, and they do what they say, in the reference solver on small walls."""

import json
import re
import sys

import pytest
from conftest import REPOSITORY, run_command
from numpy.testing import assert_allclose

import damage
from examples.opened_length import opened_length
from scripts.notebook import run_cells


def run_example(name, *words):
    """The lines that an example prints, run as its docstring says."""
    done = run_command(sys.executable, "-m", f"examples.{name}", *words, status=0)
    return done.stdout.splitlines()


@pytest.fixture(scope="module")
def two_windows(tmp_path_factory):
    """What the example prints, and the history that it leaves."""
    folder = tmp_path_factory.mktemp("examples")
    return run_example("two_windows", folder), folder / "two_windows.h5"


def test_a_wall_with_two_windows_is_damaged_by_the_record(two_windows):
    lines, path = two_windows
    history = damage.read_history(path)
    assert history.complete and history.collapsed_at_s is None
    index = history.index()
    assert 0.05 < index.DI.max() < 0.3
    assert lines[-1] == f"maximum DI {index.DI.max():.3f}, left at the end {index.DI.iloc[-1]:.3f}"


def test_the_opened_length_is_that_of_the_index(two_windows):
    history = damage.read_history(two_windows[1])
    length = opened_length(history)
    assert list(length) == ["bed_m", "head_m"]
    share = length.sum(axis=1).to_numpy() / history.joint_length_m.sum()
    assert_allclose(share, history.index().DI_open, atol=1e-12)


@pytest.mark.long
def test_the_notebook_holds_what_its_cells_show():
    """The same kinds of outputs, words and, within the last digit that is printed, numbers."""
    path = REPOSITORY / "examples" / "thesis_figures.ipynb"
    kept = json.loads(path.read_text(encoding="utf-8"))["cells"]
    made = run_cells(
        [cell | {"outputs": []} if "outputs" in cell else cell for cell in kept], path.parent
    )
    assert path.stat().st_size < 300_000 and sum(len(cell.get("outputs", ())) for cell in kept) >= 7
    for old, new in zip(kept, made, strict=True):
        for one, other in zip(old.get("outputs", ()), new.get("outputs", ()), strict=True):
            kinds = [{*of.get("data", ()), of["output_type"]} for of in (one, other)]
            assert kinds[0] == kinds[1]
            words, numbers = zip(*map(words_and_numbers, (one, other)))
            assert words[0] == words[1]
            assert_allclose(*numbers, rtol=1e-6, atol=1e-3)


def words_and_numbers(output):
    """The text of an output without its numbers, and these."""
    text = "".join(output.get("text", output.get("data", {}).get("text/plain", ())))
    number = r"\d+(?:\.\d+)?"
    return re.sub(rf"\s*{number}", " #", text), [float(one) for one in re.findall(number, text)]
