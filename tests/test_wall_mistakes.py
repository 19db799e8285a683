"""Beginner's mistakes with outlines, openings, floors, materials and walls as data: one clear line each."""

import re

import pytest

GOOD = {"name": '"house"', "length": "4.4", "height": "4.2", "precompression": "0",
        "masonry": '{ material = "clay-standard", format = "waalformaat" }',
        "outline": "[[0, 2.7], [2.2, 4.2], [4.4, 2.7]]"}
MISTAKES = {
    "material misspelt": ({"masonry": '{ material = "clay-standart", format = "waalformaat" }'},
                          r"expected one of .* did you mean clay-standard\?"),
    "format unknown": ({"masonry": '{ material = "clay", format = "brick" }'}, "format 'brick': expected one of waal"),
    "no tensile strength": ({"masonry": '{ material = "clay", format = "waalformaat" }'}, "give tensile_strength="),
    "mortar in mm": ({"masonry": '{ material = "clay-weak", format = "waalformaat", mortar = 10 }'},
                     r"mortar \[m\] = 10: expected a number from 0 to 0.05"),
    "half a wythe": ({"masonry": '{ material = "clay-weak", format = "waalformaat", wythes = 1.5 }'},
                     "whole number from 1"),
    "no format": ({"masonry": '{ material = "clay-weak" }'}, "give one of these"),
    "brick and masonry": ({"+": "[brick]\nlength = 0.2"}, "leave one out"),
    "outline starts late": ({"outline": "[[0.5, 2.7], [2.2, 4.2], [4.4, 2.7]]"}, "the first at x = 0"),
    "outline ends early": ({"outline": "[[0, 2.7], [2.2, 4.2]]"}, "the last at x = 4.4 m"),
    "outline runs back": ({"outline": "[[0, 2.7], [3.2, 4.2], [2.2, 3], [4.4, 2.7]]"}, "from left to right"),
    "outline too high": ({"height": "3.9"}, "Wall.height = 3.9 m at the highest point"),
    "outline in mm": ({"outline": "[[0, 2700], [2.2, 4200], [4.4, 2700]]"}, "expected a number from -1000 to 1000"),
    "outline no points": ({"outline": "[2.7, 4.2, 2.7]"}, r"expected points \(x, z\)"),
    "outline below ground": ({"outline": "[[0, -1], [2.2, 4.2], [4.4, 2.7]]"}, "expected 0 or more"),
    "precompression on a gable": ({"precompression": "0.1e6"}, "masses by Wall.floors"),
    "a door over all": ({"+": "[[openings]]\nleft = 1.1\nwidth = 1.1\nheight = 4.2",
                         "outline": "[[0, 4.2], [4.4, 4.2]]"}, "cuts the wall in two: expected .* give it a sill"),
    "a window in the slope": ({"+": "[[openings]]\nleft = 2.2\nwidth = 1.54\nheight = 0.6\nsill = 2.7"},
                              "has nothing below it"),
    "a window beside the wall": ({"+": "[[openings]]\nleft = 4.0\nwidth = 1.1\nheight = 1"}, "outside the wall"),
    "a floor in the air": ({"+": "[[floors]]\nlevel = 9\nmass = 100"}, "expected a level with a course below it"),
    "a slab on the ground": ({"+": '[[floors]]\nlevel = 0.1\nmass = 900\nkind = "concrete"'}, "a course below it"),
    "a floor on a quarter": ({"+": "[[floors]]\nlevel = 2.7\nmass = 100\nleft = 4.35"}, "expected half a brick"),
    "a floor too long": ({"+": "[[floors]]\nlevel = 2.7\nmass = 100\nright = 9"}, "correct left and right"),
    "a floor over a hole": ({"+": "[[openings]]\nleft = 1.1\nwidth = 1.1\nheight = 2.1\n[[floors]]\nlevel = 1.2\n"
                                  "mass = 9\nleft = 1.2\nright = 2"}, "has no brick below it"),
    "a slab without a bearing": ({"+": "[[openings]]\nleft = 1.1\nwidth = 1.1\nheight = 2.1\n[[floors]]\nlevel = 1.2\n"
                                       'mass = 9\nleft = 1.2\nright = 3\nkind = "concrete"'}, "has nothing below it"),
    "two slabs in one place": ({"+": '[[floors]]\nlevel = 2.4\nmass = 900\nkind = "concrete"\n' * 2}, "floors apart"),
    "a floor of steel": ({"+": '[[floors]]\nlevel = 2.7\nmass = 100\nkind = "steel"'},
                         "expected one of timber, concrete"),
    "a floor without mass": ({"+": "[[floors]]\nlevel = 2.7"}, "without a mass: expected mass"),
    "a floor in tonnes": ({"+": "[[floors]]\nlevel = 2.7\nmass = 0.9"}, "0.9 t is 0.9e3 kg"),
    "a heavy floor in tonnes": ({"+": "[[floors]]\nlevel = 2.7\nmass = 12"},
                                "Floor.mass over its length = 2.72727 kg/m, expected 20 to 100000 kg/m"),
    "a wall in centimetres": ({"length": 440, "height": 420, "outline": None},
                              r"Wall.length = 440 m, expected 0.1 to 200 m: .*440 cm is 440e-2 m; Wall.height = 420 m"),
    "a wall in millimetres": ({"length": 4400, "height": 4200, "outline": None},
                              "Wall.length = 4400: expected a number from 0.001 to 1000; correct it: 4400 mm is"),
    "too many floors": ({"+": "[[floors]]\nlevel = 2.7\nmass = 900\n" * 1001}, "1001 floors: expected up to 1000"),
    "a key of many dots": ({"+": "a." * 100_000 + "a = 1"}, "a key of more than 20 parts"),
    "a quoted key of many dots": ({"+": '"=".' * 20 + "a = 1"}, "a key of more than 20 parts"),
    "a key misspelt": ({"+": "[[floors]]\nlevl = 2.7\nmass = 100"}, r"did you mean level\?"),
    "single brackets": ({"+": "[floors]\nlevel = 2.7\nmass = 100"}, "double the brackets"),
    "a word for a number": ({"length": '"4.4 m"'}, "Wall.length = '4.4 m': expected a number"),
    "no length": ({"length": None}, "lacks length"),
    "no TOML": ({"name": "house"}, "no TOML .* line 1"),
}


def written(folder, changes):
    """The path of a wall as TOML: GOOD with other values, without those that are None, and "+" behind."""
    table = GOOD | {key: value for key, value in changes.items() if key != "+"}
    path = folder / "house.toml"
    path.write_text("\n".join([*(f"{key} = {value}" for key, value in table.items() if value is not None),
                               changes.get("+", "")]), encoding="utf-8")
    return path


def test_without_a_mistake(tmp_path, output_of):
    assert "mode 1" in output_of("modes", written(tmp_path, {}))


@pytest.mark.parametrize("mistake", MISTAKES)
def test_one_line_says_what_is_wrong(tmp_path, error_of, mistake):
    changes, message = MISTAKES[mistake]
    path = written(tmp_path, changes)
    line, = error_of("modes", path).splitlines()
    assert line.startswith("error: ") and "expected" in line
    assert re.search(message, line), line
