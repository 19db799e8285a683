"""Walls as data, materials and formats by name, the preview."""

import math
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import pytest
from conftest import REPOSITORY, written
from numpy.testing import assert_allclose

from damage import Brick, Floor, Joint, ModelOptions, Opening, Wall, load_wall, masonry
from damage.__main__ import main
from damage.draw.preview import wall_preview
from damage.files import json_text
from damage.house.plausible import implausible
from damage.wall.file import wall_from, wall_schema
from damage.wall.geometry import body_table, joint_table
from damage.wall.layout import lay_out
from damage.wall.materials import MATERIALS
from damage.wall.parameters import ENERGIES

TEXT = """
name = "house"
length = 4.4
height = 4.2
precompression = 0
outline = [[0, 2.7], [2.2, 4.2], [4.4, 2.7]]
masonry = { material = "clay-standard", format = "waalformaat", wythes = 2 }
[joint]
tensile_strength = 0.1e6
[[openings]]
left = 1.1
width = 0.88
height = 2.1
[[floors]]
level = 2.7
mass = 900
kind = "concrete"
"""
HOUSE = Wall(
    "house",
    4.4,
    4.2,
    [Opening(1.1, 0.88, 2.1)],
    0.0,
    outline=[(0, 2.7), (2.2, 4.2), (4.4, 2.7)],
    floors=[Floor(2.7, 900.0, kind="concrete")],
    **masonry("clay-standard", "waalformaat", wythes=2, tensile_strength=0.1e6),
)


@pytest.fixture
def house(tmp_path):
    return written(tmp_path / "house.toml", TEXT, encoding="utf-8")


class TestData:
    def test_a_file_is_the_wall_that_python_makes(self, house):
        assert load_wall(house) == HOUSE

    def test_brick_and_joint_by_tables(self):
        made = wall_from(
            {
                "name": "w",
                "length": 2,
                "height": 1,
                "brick": {"length": 0.3},
                "joint": {"cohesion": 1e5},
            }
        )
        assert made == Wall("w", 2, 1, brick=Brick(length=0.3), joint=Joint(cohesion=1e5))

    def test_masonry_of_a_modulus_beside_bricks_and_joints(self):
        """1/E = 1/E_brick + 1/(k_n h), G = 0.4 E; friction and rules as `damage.Joint` has them."""
        table = {
            "name": "w",
            "length": 2,
            "height": 1,
            "masonry": {"young_modulus": 4.9e9},
            "brick": {"height": 0.06},
            "joint": {
                "friction": 0.55,
                "cohesion": 0.15e6,
                "tensile_strength": 0.13e6,
                "compressive_strength": 11e6,
                **dict.fromkeys(ENERGIES, "rule"),
            },
        }
        joint = wall_from(table).joint
        brick = wall_from(table).brick
        across = [
            1 / (1 / modulus + 1 / (stiffness * 0.06))
            for modulus, stiffness in (
                (brick.young_modulus, joint.normal_stiffness),
                (brick.shear_modulus, joint.shear_stiffness),
            )
        ]
        assert_allclose(across, [4.9e9, 0.4 * 4.9e9])
        assert_allclose(
            [math.tan(joint.friction_angle), joint.compressive_fracture_energy],
            [0.55, 1.6e-3 * 11e6],
        )
        assert_allclose(
            [joint.mode_i_fracture_energy, joint.mode_ii_fracture_energy],
            [25 * 0.26**0.7, 250 * 0.26**0.7],
        )
        jsonschema = pytest.importorskip("jsonschema")
        jsonschema.validate(table, wall_schema())
        named = masonry("clay", "waalformaat", young_modulus=4.9e9, tensile_strength=0.13e6)[
            "brick"
        ]
        assert_allclose(named.young_modulus, brick.young_modulus)

    def test_a_byte_order_mark_and_dots_in_words_are_read(self, house):
        house.write_text(
            TEXT.replace("height = 4.2", f"height = 4.2 # {'.' * 200}"), encoding="utf-8-sig"
        )
        assert house.read_bytes().startswith(b"\xef\xbb\xbf") and load_wall(house) == HOUSE

    def test_the_schema_that_ships_is_the_codes(self):
        shipped = (REPOSITORY / "walls/wall.schema.json").read_text(encoding="utf-8")
        assert shipped.rstrip() == json_text(wall_schema(), indent=1)

    def test_the_schema_takes_the_file_and_refuses_others(self):
        jsonschema = pytest.importorskip("jsonschema")
        import tomllib

        table = tomllib.loads(TEXT)
        jsonschema.validate(table, wall_schema())
        for wrong in (
            {"lenght": 1},
            {"length": "4"},
            {"floors": [{"level": 1}]},
            {"masonry": {"material": "mud"}},
        ):
            with pytest.raises(jsonschema.ValidationError):
                jsonschema.validate(table | wrong, wall_schema())


class TestMaterials:
    @pytest.mark.parametrize("name", MATERIALS)
    def test_masonry_has_the_modulus_and_friction_of_its_source(self, name):
        found = MATERIALS[name]
        given = {} if found.tensile_strength else {"tensile_strength": 0.1e6}
        made = masonry(name, "waalformaat", **given)
        brick = made["brick"]
        joint = made["joint"]
        across = 1 / (1 / brick.young_modulus + 1 / (joint.normal_stiffness * brick.height))
        assert_allclose(
            (across, math.tan(joint.friction_angle)), (found.young_modulus, found.friction)
        )
        assert joint.cohesion == found.cohesion
        assert not implausible(Wall("w", 2.0, 1.0, **made))

    def test_bricks_have_their_share_of_mortar(self):
        made = masonry("clay-weak", "waalformaat", mortar=0.012, wythes=2)["brick"]
        assert_allclose((made.length, made.height, made.thickness), (0.222, 0.062, 0.212))
        # bricks to the square metre of the format's source
        assert_allclose(1 / (0.22 * 0.06), 75, rtol=0.02)


class TestPreview:
    def test_it_names_piers_and_spandrels_and_weighs_floors(self):
        layout = lay_out(HOUSE, ModelOptions(lintel="1"))
        figure = wall_preview(layout.plan, body_table(layout), joint_table(layout), layout.supports)
        said = [text.get_text() for text in figure.axes[0].texts]
        assert said == ["0.9 t (8.83 kN)", "0.88 x 2.1", "P1", "P2", "S1"]

    @pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
    def test_the_command_writes_it(self, house, tmp_path, output_of, ending):
        path = tmp_path / f"house.{ending}"
        assert output_of("draw", house, "--out", path).strip() == str(path)
        first = path.read_bytes()
        assert main(["draw", str(house), "--out", str(path)]) == 0
        assert path.read_bytes() == first
        if ending == "svg":
            assert ElementTree.fromstring(first).tag.endswith("svg")


def test_every_wall_finds_the_package_where_its_file_is_said_to_be_yade():
    """YADE executes a wall with its own program as `__file__` and the wall as the first
    argument."""
    program = """
import sys
given = [path for path in sys.path if path]
for wall in sys.argv[1:]:
    sys.argv, sys.path = [wall], given[:]
    for name in [name for name in sys.modules if name.split(".")[0] in ("damage", "walls")]:
        del sys.modules[name]
    code = compile(open(wall).read(), wall, "exec")
    exec(code, {"__file__": "/usr/bin/yade", "__name__": "wall"})
"""
    walls = [
        str(path)
        for path in REPOSITORY.glob("walls/**/*.py")
        if path.name not in ("changed.py", "__init__.py")
    ]
    assert len(walls) > 15
    done = subprocess.run(
        [sys.executable, "-c", program, *walls], cwd="/", capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
