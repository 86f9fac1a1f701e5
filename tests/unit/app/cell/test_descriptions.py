"""Descriptions of arms and tools: what the shipped ones say, files of one's own, and what is refused."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from catseye.app import cell as room
from catseye.app.cell.arm import ArmDescription, arm_description, shipped_arm, shipped_arms
from catseye.app.cell.axes import arm_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.serial_arm import chain_of, loads_of, point_of, tool_frame
from catseye.app.cell.tool import read_tool
from catseye.app.errors import ConfigError
from catseye.calibration.kinematics.bodies import Capsule, Gaps, Scene
from catseye.calibration.kinematics.gravity import Load

POSITIONS_DEG = (
    (-175.0, -90.0, 0.0, 90.0, 175.0),
    (-130.0, -100.0, -70.0, -40.0, -15.0),
    (-110.0, -25.0, 60.0, 90.0, 145.0),
    (-180.0, -90.0, 0.0, 90.0, 180.0),
    (-110.0, -55.0, 0.0, 55.0, 110.0),
    (-180.0, -90.0, 0.0, 90.0, 180.0),
)
"""K1...K5 of A1...A6: Table 2 of the paper on motion resolution."""

ARM = """
format = "catseye-arm/1"
name = "two"
convention = "modified-dh"

[[joint]]
name = "A1"
type = "revolute"
alpha_deg = 0.0
a_mm = 0.0
theta_offset_deg = 10.0
d_mm = 5.0
sign = -1
low_deg = -90.0
high_deg = 90.0
speed_deg_s = 10.0
gear_ratio = 256.86
encoder_bits = 18

[[joint]]
name = "Z"
type = "prismatic"
alpha_deg = 180.0
a_mm = 100.0
theta_offset_deg = 0.0
d_mm = 0.0
sign = 1
low_mm = 0.0
high_mm = 50.0
speed_mm_s = 10.0

[[link]]
mass_kg = 4.0
centre_mm = [1.0, 2.0, 3.0]

[[link]]
mass_kg = 2.0
centre_mm = [0.0, 0.0, -3.0]
"""
TOOL = """
format = "catseye-tool/1"
name = "plate"
mass_kg = 1.5
centre_mm = [0.0, 0.0, 40.0]

[[target]]
name = "T1"
x_mm = 50.0
y_mm = -10.0
z_mm = 80.0
normal = [1.0, 0.0, 0.0]
"""
CELL = """
format = "catseye-cell/1"
name = "arm-1"

[robot]
endpoint = "tcp://127.0.0.1:10001"
arm = "{}"
"""


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, "utf-8")
    return path


def test_three_arms_are_shipped() -> None:
    assert shipped_arms() == ["irb120", "kr210-r2700", "rh-3frh5515"]


def test_the_kr210_has_the_gears_of_the_paper() -> None:
    arm = shipped_arm("kr210-r2700")
    assert [joint.gear_ratio for joint in arm.joint] == [256.86, 252.91, 236.37, 198.90, 209.67, 131.15]
    assert {joint.encoder_bits for joint in arm.joint} == {18}
    assert [joint.name for joint in arm.joint] == ["A1", "A2", "A3", "A4", "A5", "A6"]


@pytest.mark.parametrize(("name", "mass_kg"), [("kr210-r2700", 1068.08), ("irb120", 18.146)])
def test_links_add_up_to_what_the_arm_weighs(name: str, mass_kg: float) -> None:
    # Sums by hand of the public descriptions that the files name.
    assert sum(load.mass_kg for load in loads_of(shipped_arm(name))) == pytest.approx(mass_kg)


def test_the_kr210_is_clear_of_itself_at_the_papers_positions() -> None:
    arm = shipped_arm("kr210-r2700")
    bodies = tuple(
        Capsule(
            body.name,
            chain_of(arm).frame_of(body.joint),
            point_of(body.from_mm),
            point_of(body.to_mm),
            body.radius_mm,
        )
        for body in arm.body
    )
    poses = np.tile([0.0, -90.0, 90.0, 0.0, 0.0, 0.0], (30, 1))
    for row, (joint, angle) in enumerate((k, angle) for k in range(6) for angle in POSITIONS_DEG[k]):
        poses[row, joint] = angle
    assert Gaps(Scene(chain_of(arm), bodies)).at(poses).min() > 5.0


@pytest.mark.parametrize("name", ["kr210-r2700", "irb120"])
def test_a_file_of_ones_own_serves_like_a_name(tmp_path: Path, name: str) -> None:
    text = (Path(room.__file__).parent / "arms" / f"{name}.toml").read_text("utf-8")
    assert arm_description(str(written(tmp_path, "mine.toml", text))) == shipped_arm(name)


def test_links_without_joints_are_those_of_all_in_order(tmp_path: Path) -> None:
    arm = arm_description(str(written(tmp_path, "two.toml", ARM)))
    tool = read_tool(written(tmp_path, "tool.toml", TOOL))
    assert loads_of(arm, tool) == (
        Load(1, 4.0, (1.0, 2.0, 3.0)),
        Load(2, 2.0, (0.0, 0.0, -3.0)),
        Load(2, 1.5, (0.0, 0.0, 40.0)),
    )
    first, second = chain_of(arm).joints
    assert (first.sign, first.theta_offset_deg, first.d_mm, second.kind) == (-1.0, 10.0, 5.0, "prismatic")


def test_a_cell_finds_its_arm_beside_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written(tmp_path, "arms/two.toml", ARM)
    path = written(tmp_path, "cell.toml", CELL.format("arms/two.toml"))
    monkeypatch.chdir(tmp_path.parent)
    arm = arm_of(load_cell(path).cell.robot)
    assert [(axis.name, axis.range) for axis in arm.axes] == [("A1", (-90.0, 90.0)), ("Z", (0.0, 50.0))]


def test_a_stored_cell_keeps_the_description_of_its_arm(tmp_path: Path) -> None:
    file = written(tmp_path, "two.toml", ARM)
    cell = load_cell(written(tmp_path, "cell.toml", CELL.format("two.toml"))).cell
    file.unlink()
    stored = Cell.model_validate_json(cell.model_dump_json())
    assert arm_description(stored.robot.arm) == arm_description(cell.robot.arm)
    assert [axis.name for axis in arm_of(stored.robot).axes] == ["A1", "Z"]


def test_a_cell_of_a_kr210_needs_nothing_more(tmp_path: Path) -> None:
    arm = arm_of(load_cell(written(tmp_path, "cell.toml", CELL.format("kr210-r2700"))).cell.robot)
    assert arm.axes[1].range == (-140.0, -5.0)


def test_a_cell_whose_arm_is_missing_says_where_it_looked(tmp_path: Path) -> None:
    path = written(tmp_path, "cell.toml", CELL.format("gone.toml"))
    with pytest.raises(
        ConfigError, match=rf"cell.toml:7: robot.arm: {tmp_path}/gone.toml: there is no such file"
    ):
        load_cell(path)


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("sign = -1", "sign = 2", "joint[1].revolute.sign: Input should be 1 or -1, not 2"),
        ("low_deg = -90.0", "low_deg = 95.0", "[[joint]] A1: its range 95…90 deg is empty"),
        ('name = "Z"', 'name = "A1"', "two [[joint]] have one name"),
        ("mass_kg = 4.0", 'joint = "A9"\nmass_kg = 4.0', "[[link]] joint = 'A9' is none of base, A1, Z"),
        ("mass_kg = 4.0", 'joint = "A1"\nmass_kg = 4.0', "[[link]]: 1 of 2 say no joint"),
        ("mass_kg = 4.0", "mass_kg = -4.0", "link[1].mass_kg"),
        ("encoder_bits = 18", "encoder_bits = 0", "encoder_bits"),
        ("centre_mm = [1.0, 2.0, 3.0]", "centre_mm = [1.0, 2.0]", "link[1].centre_mm"),
        ("alpha_deg = 180.0\n", "", "joint[2].prismatic.alpha_deg: this key is missing"),
        ("theta_offset_deg = 10.0", "theta_deg = 10.0", "theta_deg: unknown key"),
    ],
)
def test_descriptions_that_cannot_be_are_refused(tmp_path: Path, old: str, new: str, part: str) -> None:
    assert old in ARM
    with pytest.raises(ConfigError) as caught:
        arm_description(str(written(tmp_path, f"{len(old)}.toml", ARM.replace(old, new, 1))))
    assert part in str(caught.value)
    assert str(tmp_path) in str(caught.value)


def test_a_name_that_is_not_shipped_lists_those_that_are() -> None:
    with pytest.raises(ValueError, match="there are irb120, kr210-r2700, rh-3frh5515"):
        arm_description("kr-9")


def test_a_target_is_a_frame_along_the_flange(tmp_path: Path) -> None:
    tool = read_tool(written(tmp_path, "tool.toml", TOOL))
    expected = np.eye(4)
    expected[:3, 3] = [50.0, -10.0, 80.0]
    assert tool_frame(tool, "T1") == pytest.approx(expected)
    with pytest.raises(ValueError, match="the tool plate has no target T2; it has T1"):
        tool_frame(tool, "T2")


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("mass_kg = 1.5", "mass_kg = -1.5", "mass_kg"),
        ("normal = [1.0, 0.0, 0.0]", "normal = [0.0, 0.0, 0.0]", "is not a direction"),
        ('"catseye-tool/1"', '"catseye-arm/1"', "format"),
        (
            "[[target]]",
            '[[target]]\nname = "T1"\nx_mm = 0.0\ny_mm = 0.0\nz_mm = 0.0\n\n[[target]]',
            "called T1",
        ),
    ],
)
def test_tools_that_cannot_be_are_refused(tmp_path: Path, old: str, new: str, part: str) -> None:
    assert old in TOOL
    with pytest.raises(ConfigError, match=part):
        read_tool(written(tmp_path, "tool.toml", TOOL.replace(old, new, 1)))


def test_whole_numbers_serve_as_lengths_and_angles() -> None:
    whole = ArmDescription.model_validate(tomllib.loads(ARM.replace(".0", "")))
    assert whole == ArmDescription.model_validate(tomllib.loads(ARM))
