"""Arm, bodies and workspace of a cell file: ranges, estimates, and what is hardly meant."""

from pathlib import Path

import pytest

from catseye.app.cell.arm import shipped_arm, shipped_arms
from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.plausible import implausible
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import ConfigError
from catseye.app.results.runs.run_source import cell_of_run
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Json
from tests.unit.procedures.benches import WORKSPACE

BODY = """
[[body]]
name = "interferometer head"
joint = "J4"
from_mm = [-40.0, 0.0, -60.0]
to_mm = [10.0, 0.0, -60.0]
radius_mm = 35.0
confirmed = true

[[body]]
name = "cable carrier"
joint = "J2"
from_mm = [0.0, 0.0, 500.0]
to_mm = [225.0, 0.0, 500.0]
radius_mm = 40.0
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "cell.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_shipped_arm_has_the_bodies_of_the_workspace(tmp_path: Path) -> None:
    assert "rh-3frh5515" in shipped_arms()
    bench = scara_bench_of(load_cell(written(tmp_path, TEMPLATE)).cell)
    assert bench.workspace.bodies == WORKSPACE.bodies
    assert bench.workspace.chain == WORKSPACE.chain


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("j1 = [-170.0, 170.0]", "j1 = [-1e9, 1e9]", ["robot:", "J1 of the RH-3FRH5515, -170…170 deg"]),
        ("j2 = [-145.0, 145.0]", "j2 = [-175.0, 145.0]", ["limits_deg.j2 = [-175, 145]", "-145…145"]),
        ("j4 = [-360.0, 360.0]", "j4 = [-360.0, 361.0]", ["limits_deg.j4", "a cell only narrows it"]),
        ("j3_mm = 50.0 ", "j3_mm = 5000 ", ["j3_mm = 5000", "J3 of the RH-3FRH5515, 0…150 mm"]),
        ("j3_range_mm = [40.0, 60.0]", "j3_range_mm = [40.0, 160.0]", ["j3_range_mm = [40, 160]"]),
        ("override_cap_percent = 20 ", "override_cap_percent = 31 ", ["is above 30", "override_cap_reason"]),
        ('expected_model', 'arm = "rh-9"\nexpected_model', ["robot.arm", f"there are {', '.join(shipped_arms())}"]),
        ("clearance_mm = 5.0", "clearance_mm = -1.0", ["workspace.clearance_mm"]),
        ("[measurement]", BODY.replace('"J2"', '"J7"') + "[measurement]", ["'J7' is none of base, J1, J2, J3, J4"]),
        ("[measurement]", BODY.replace('"J4"', '"base"') + "[measurement]", ["interferometer head", "rides on J4"]),
        ("[measurement]", BODY + BODY + "[measurement]", ["two [[body]] are called interferometer head"]),
    ],
)  # fmt: skip
def test_what_an_arm_cannot_be_is_refused(tmp_path: Path, old: str, new: str, parts: list[str]) -> None:
    assert old in TEMPLATE
    with pytest.raises(ConfigError) as caught:
        load_cell(written(tmp_path, TEMPLATE.replace(old, new, 1)))
    for part in parts:
        assert part in str(caught.value)


def test_a_box_with_no_inside_is_refused(tmp_path: Path) -> None:
    box = '[[workspace.keep_out]]\nname = "a"\nmin_mm = [0.0, 0.0, 0.0]\nmax_mm = [1.0, 0.0, 1.0]\n\n[measurement]'
    with pytest.raises(ConfigError, match="each of min_mm has to be below its max_mm"):
        load_cell(written(tmp_path, TEMPLATE.replace("[measurement]", box)))


def test_a_high_cap_with_a_reason_is_taken(tmp_path: Path) -> None:
    text = TEMPLATE.replace(
        "override_cap_percent = 20", 'override_cap_reason = "dry"\noverride_cap_percent = 60'
    )
    assert load_cell(written(tmp_path, text)).cell.robot.override_cap_percent == 60.0


def test_own_bodies_replace_and_add_and_end_the_doubt(tmp_path: Path) -> None:
    text = TEMPLATE.replace("[measurement]", BODY + "[measurement]")
    text = text.replace("z_mm = 0.0\nconfirmed = false", "z_mm = 0.0\nconfirmed = true")
    workspace = scara_bench_of(load_cell(written(tmp_path, text)).cell).workspace
    by_name = {body.name: body for body in workspace.bodies}
    assert by_name["interferometer head"].radius_mm == 35.0
    assert by_name["cable carrier"].frame == 2
    doubts = "; ".join(workspace.unconfirmed)
    assert "interferometer head" not in doubts
    assert "table" not in doubts
    assert "cable carrier (J2: radius 40 mm, (0, 0, 500) to (225, 0, 500) mm)" in doubts
    assert "link 1 (J1: radius 60 mm" in doubts
    assert "flange at J3 = 0 (z 200 mm)" in doubts


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("dwell_time_s = 0.5", "dwell_time_s = 408", "measurement.dwell_time_s = 408: seconds at each point"),
        ("link1_mm = 325.0", "link1_mm = 4775.0", "a reach of 5 m is no SCARA's"),
        ("link2_mm = 225.0", "link2_mm = 22.5", "robot.link2_mm = 22.5: the RH-3FRH5515 has 225 mm"),
        ("x_mm = 680.0", "x_mm = 68000.0", "reflector P2 is 68.0 m from the J1 axis"),
        ("x_mm = 680.0", "x_mm = 6.8", "reflector P2 stands inside the base column"),
        ("column_radius_mm = 110.0", "column_radius_mm = 90.0", "the body base column has 110 mm"),
        ("take_up_deg = 1.0", "take_up_deg = 15.0", "measurement.take_up_deg = 15"),
        ("spread_limit_um = 5.0", "spread_limit_um = 5000.0", "readings that scatter by a mm"),
        ("settle_time_s = 0.5", "settle_time_s = 200.0", "[measurement] waits for"),
    ],
)
def test_what_is_hardly_meant_is_flagged(tmp_path: Path, old: str, new: str, part: str) -> None:
    assert old in TEMPLATE
    assert any(
        part in text for text in implausible(load_cell(written(tmp_path, TEMPLATE.replace(old, new))).cell)
    )


def test_the_template_is_plausible(tmp_path: Path) -> None:
    assert implausible(load_cell(written(tmp_path, TEMPLATE)).cell) == []


def test_runs_of_faster_cells_can_still_be_evaluated(tmp_path: Path) -> None:
    values = load_cell(written(tmp_path, TEMPLATE)).cell.model_dump(mode="json")
    values["robot"] |= {"override_cap_percent": 80.0, "j3_mm": 400.0, "j3_range_mm": None}

    class Reader(RunReader):
        def __init__(self) -> None:
            self.path = tmp_path

        @property
        def meta(self) -> dict[str, Json]:
            return {"configuration": values}

    assert cell_of_run(Reader()).robot.override_cap_percent == 80.0


def test_every_joint_of_the_description_has_a_range() -> None:
    arm = shipped_arm("rh-3frh5515")
    assert [joint.range for joint in arm.joint] == [
        (-170, 170),
        (-145, 145),
        (0, 150),
        (-360, 360),
    ]
