"""A cell file that says nothing of what only open-loop tracking needs."""

import re
import tomllib
from datetime import UTC, datetime
from pathlib import Path

import pytest

from catseye.app.cell import arm
from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.axes import axes_of
from catseye.app.cell.bench import bench_of, scara_bench_of, system_of
from catseye.app.cell.described import Shipped
from catseye.app.cell.load import LoadedCell, load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.plausible import implausible
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cell.templates import RESOLUTION, TEMPLATES
from catseye.app.engine.gate import require_in_range
from catseye.app.engine.walked.register import geometry_digest
from catseye.app.errors import ConfigError, LimitError
from catseye.app.protocol.installed import procedure_names
from catseye.app.protocol.procedures import bases, load_procedure
from catseye.app.results.readiness.cell_runs import runs_of_cell
from catseye.app.results.readiness.needs import needs_of
from catseye.app.service.running import plan_run
from catseye.app.service.watching.cell_devices import cell_devices
from catseye.app.service.watching.latest_values import LatestValues
from catseye.drivers.roles.pose import Axis
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.system import System
from catseye.procedures.scara.bench import ScaraBench
from tests.unit.app.engine.fakes import ManualClock

NODES = r"^theta\d_deg = .*?$"
REFLECTORS = r"^\[\[reflector\]\].*?(?=^\[|^# What)"
MEASUREMENT = r"^\[measurement\].*?(?=^# The error budget)"
OPTICS = r"^\[(optics|alignment)\].*?(?=^\[)"
LINKS = r"^link\d_mm = .*?$"
COUNTER = r"^\[interferometer\].*?(?=^\[)"
SENSOR = r"^\[environment\].*?(?=^\[)"
SENSOR_AND_CONDITIONS = r"^\[(environment|conditions)\].*?(?=^\[)"

ROBOT_ALONE = """
format = "catseye-cell/1"
name = "arm-1"

[robot]
endpoint = "tcp://127.0.0.1:10001"
"""


def without(folder: Path, *patterns: str) -> LoadedCell:
    """Return the template's cell without what matches."""
    text = TEMPLATE
    for pattern in patterns:
        text, count = re.subn(pattern, "", text, flags=re.MULTILINE | re.DOTALL)
        assert count
    path = folder / "cell.toml"
    path.write_text(text, "utf-8")
    return load_cell(path)


@pytest.mark.parametrize(
    ("pattern", "missing"),
    [
        (REFLECTORS, ["[[reflector]]"]),
        (MEASUREMENT, ["[measurement] theta1_deg", "[measurement] theta2_deg"]),
        (NODES, ["[measurement] theta1_deg", "[measurement] theta2_deg"]),
        (LINKS, ["[robot] link1_mm", "[robot] link2_mm"]),
        (COUNTER, ["[interferometer]"]),
        (SENSOR_AND_CONDITIONS, ["[environment]"]),
        (f"{COUNTER}|{REFLECTORS}", ["[[reflector]]", "[interferometer]"]),
    ],
)
@pytest.mark.parametrize("name", ["open-loop", "beam-level"])
def test_open_loop_procedures_demand_their_sections(
    tmp_path: Path, pattern: str, missing: list[str], name: str
) -> None:
    loaded, procedure = without(tmp_path, pattern), load_procedure(name)
    with pytest.raises(ConfigError) as refused:
        plan_run(loaded, procedure, procedure.params_type(), tmp_path / "runs", "auto")
    assert str(refused.value).startswith(
        f"{name} needs {', '.join(missing)}: add them to the cell file lab-1"
    )


def test_everything_else_does_without_them(tmp_path: Path) -> None:
    cell = without(tmp_path, REFLECTORS, MEASUREMENT, OPTICS, LINKS).cell
    bench = bench_of(cell)
    assert type(bench) is Bench
    assert type(system_of(bench)) is System
    assert [axis.name for axis in bench.arm.axes] == ["J1", "J2", "J3", "J4"]
    assert bench.arm.axes[2].range == (40.0, 60.0)
    assert bench.timing.readings == 10
    assert implausible(cell) == []
    assert geometry_digest(cell) != geometry_digest(without(tmp_path, REFLECTORS).cell)
    with pytest.raises(ConfigError, match=r"open-loop tracking needs \[robot\] link1_mm"):
        scara_bench_of(cell)


def test_ranges_and_speeds_hold_without_open_loop_tracking(tmp_path: Path) -> None:
    speeds = "speed_deg_s = [500.0, 800.0, 3500.0]\nj3_speed_mm_s = 1500.0\n"
    text = re.sub(REFLECTORS, "", TEMPLATE, flags=re.MULTILINE | re.DOTALL)
    path = tmp_path / "cell.toml"
    path.write_text(text.replace("j3_mm = 50.0", f"{speeds}j3_mm = 50.0"), "utf-8")
    bench = bench_of(load_cell(path).cell)
    assert type(bench) is Bench
    assert [axis.speed for axis in bench.arm.axes] == [500.0, 800.0, 1500.0, 3500.0]
    with pytest.raises(LimitError, match="J3 = 61 mm is outside 40 … 60 mm"):
        require_in_range(bench.arm.axes, (0.0, 0.0, 61.0, 0.0))


def test_a_cell_may_have_nothing_but_a_robot(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(ROBOT_ALONE, "utf-8")
    cell, clock = load_cell(path).cell, ManualClock()
    assert list(cell.instruments) == ["robot"]
    assert implausible(cell) == []
    assert type(bench_of(cell)) is Bench
    made = cell_devices(cell, LatestValues(clock), clock, lambda *_: None)
    assert list(made.kept) == list(made.devices.named()) == ["robot"]


@pytest.mark.parametrize("pattern", [NODES, MEASUREMENT, LINKS, REFLECTORS, COUNTER])
def test_a_cell_is_read_as_a_run_stores_it(tmp_path: Path, pattern: str) -> None:
    cell = without(tmp_path, pattern).cell
    assert Cell.model_validate_json(cell.model_dump_json()) == cell


def test_one_node_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(f"{ROBOT_ALONE}\n[measurement]\ntheta1_deg = [3.0]\n", "utf-8")
    with pytest.raises(ConfigError, match="theta1_deg: a joint needs at least 2 nodes"):
        load_cell(path)


def test_conditions_of_the_air_need_its_sensor(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigError, match=r"\[conditions\] are those of the air: add the sensor, \[environment\]"
    ):
        without(tmp_path, SENSOR)


def test_readiness_names_what_is_missing(tmp_path: Path) -> None:
    cell = without(tmp_path, REFLECTORS).cell
    runs = runs_of_cell(tmp_path / "runs", cell.name, datetime(2026, 1, 1, tzinfo=UTC))
    bench = bench_of(cell)
    assert bases(bench) == []
    for name in procedure_names():
        (need,) = needs_of(load_procedure(name), cell, bench, {}, runs)
        assert (need.what, need.met) == ("cell file", "missing")
        needs = load_procedure(name).needs
        missing = f"[{needs.optics[0]}_optics]" if needs.optics else "[[reflector]]"
        if not (needs.optics or issubclass(needs.bench, ScaraBench)):
            missing = "base_mm in [tracker]"
        assert need.text.startswith(f"{name} needs {missing}")


def test_limits_that_the_cell_does_not_narrow_are_the_arms(tmp_path: Path) -> None:
    text = TEMPLATE.replace("j1 = [-170.0, 170.0]\n", "j1 = [-90.0, 90.0]\n").replace(
        "j2 = [-145.0, 145.0]\n", ""
    )
    path = tmp_path / "cell.toml"
    path.write_text(text, "utf-8")
    axes = bench_of(load_cell(path).cell).arm.axes
    assert [axis.range for axis in axes[:2]] == [(-90.0, 90.0), (-145.0, 145.0)]


SIX = """
format = "catseye-arm/1"
name = "six"
convention = "modified-dh"
""" + "".join(
    f"""
[[joint]]
name = "A{n}"
type = "revolute"
alpha_deg = 0.0
a_mm = 0.0
theta_offset_deg = 0.0
d_mm = 0.0
sign = 1
low_deg = -{100.0 + n}
high_deg = {100.0 + n}
speed_deg_s = 250.0
acceleration_deg_s2 = 1000.0
"""
    for n in range(1, 7)
)


def test_a_description_of_six_joints_gives_six_axes() -> None:
    description = ArmDescription.model_validate(tomllib.loads(SIX))
    axes = axes_of(description, {"a2": [0.0, 90.0]})
    assert [axis.name for axis in axes] == ["A1", "A2", "A3", "A4", "A5", "A6"]
    assert axes[1] == Axis("A2", "deg", 0.0, 90.0, 250.0, 1000.0)
    assert axes[5] == Axis("A6", "deg", -106.0, 106.0, 250.0, 1000.0)


def test_a_cell_of_six_axes_is_read_as_stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "six.toml").write_text(SIX.replace('"A', '"J'), "utf-8")
    monkeypatch.setattr(arm, "_SHIPPED", Shipped(arm.ArmDescription, "an arm", tmp_path))
    limits = "limits_deg = { j5 = [-10.0, 10.0] }"
    path = tmp_path / "cell.toml"
    path.write_text(f'{ROBOT_ALONE}arm = "six"\n{limits}\n', "utf-8")
    stored = Cell.model_validate_json(load_cell(path).cell.model_dump_json())
    ranges = [axis.range for axis in bench_of(stored).arm.axes]
    assert ranges[:2] == [(-101.0, 101.0), (-102.0, 102.0)]
    assert ranges[4] == (-10.0, 10.0)


def test_the_cell_of_motion_resolution_needs_nothing_of_a_scara(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(TEMPLATES[RESOLUTION].text, "utf-8")
    cell = load_cell(path).cell
    bench = bench_of(cell)
    assert type(bench) is Bench
    assert [axis.name for axis in bench.arm.axes] == ["A1", "A2", "A3", "A4", "A5", "A6"]
    assert (bench.angular_optics is None, bench.linear_optics is None) == (False, False)
    procedure = load_procedure("resolution")
    assert plan_run(
        load_cell(path), procedure, procedure.params_type(joints=["A3"]), tmp_path / "runs", "auto"
    ).plan.places
    assert bench_of(Cell.model_validate_json(cell.model_dump_json())) == bench
