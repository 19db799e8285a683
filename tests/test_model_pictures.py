"""Pictures of modes and of two histories: what they show, and that the commands write them."""

import json

import numpy as np
from small_history import make_history, small_layout

from damage.__main__ import main
from damage.draw.compare import JOINTS, compare_picture, joint_agreement, run_labels
from damage.draw.preview import modes_picture
from damage.law.modes import natural_modes
from damage.wall.layout import lay_out
from damage.wall.parameters import Opening, Wall


def test_agreement_of_joints(tmp_path):
    layout = small_layout()
    pairs = list(zip(layout.contacts.first, layout.contacts.second))[:layout.n_joints]
    joints = [pairs.index(pair) for pair in sorted(set(pairs))[:4]]
    first = make_history(tmp_path / "a.h5", broken=joints[:3], opening={joints[1]: 1e-3})
    second = make_history(tmp_path / "b.h5", broken=[joints[0], joints[1], joints[3]])
    agreement = joint_agreement(first, second)
    for joint, expected in zip(joints, ("same", "other", "first", "second")):
        mine = [agreement[k] for k, pair in enumerate(pairs) if pair == pairs[joint]]
        assert set(mine) == {expected}
    assert set(agreement) == set(JOINTS)
    figure = compare_picture(first, second)
    assert len(figure.axes) == 2


def test_elastic_joints_are_drawn_as_such(tmp_path):
    layout = lay_out(Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses"))
    first, second = (make_history(tmp_path / f"{name}.h5", layout) for name in "ab")
    figure = compare_picture(first, second)
    drawn, = (lines for lines in figure.axes[1].collections if lines.get_label() == "elastic")
    n = int(first.joints["elastic"].sum())
    assert len(drawn.get_segments()) == n > 0 and drawn.get_linestyle()[0][1] is not None  # dashed
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert f"elastic, cannot fail: {n} points" in texts
    assert f"intact in both: {layout.n_joints - n} points" in texts


def test_two_runs_never_carry_one_label(tmp_path):
    (tmp_path / "other").mkdir()
    a, b, namesake = (make_history(tmp_path / name) for name in ("a.h5", "b.h5", "other/a.h5"))
    assert run_labels(a, b) == ["first: reference, a", "second: reference, b"]
    long, short = ("".join(label.split()) for label in run_labels(a, namesake))  # without the lines' ends
    assert (long, short) == (f"first:reference,{tmp_path.name}/a", "second:reference,other/a")
    legend, = compare_picture(a, b).legends
    assert [text.get_text() for text in legend.get_texts()][:2] == run_labels(a, b)


def test_every_mode_is_drawn_with_its_period():
    layout = small_layout()
    modes = natural_modes(layout, 4)
    titles = [ax.get_title() for ax in modes_picture(layout, modes).axes]
    assert titles == [f"mode {k + 1}: {period:.4f} s" for k, period in enumerate(modes.period_s)]


def test_commands_write_the_pictures(tmp_path, capsys):
    out = tmp_path / "pictures"
    assert main(["modes", "walls/solid.py", "--json", "--out", str(out)]) == 0
    assert len(json.loads(capsys.readouterr().out)["period_s"]) == 6
    for name in "ab":
        make_history(tmp_path / f"{name}.h5", drift=np.linspace(0, 1e-3, 21))
    assert main(["compare", str(tmp_path / "a.h5"), str(tmp_path / "b.h5"), "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {f"{n}.{e}" for n in ("modes", "compare") for e in ("png", "pdf")}
    (tmp_path / "file").touch()
    assert main(["modes", "walls/solid.py", "--out", str(tmp_path / "file")]) == 2
