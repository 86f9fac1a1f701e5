"""The emulated bench that a cell file asks for: its robot's emulator says which arm stands there."""

import tomllib
from pathlib import Path

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.instruments import robot_settings
from catseye.app.service.emulated_arm import emulation_config
from catseye.drivers.kuka.robot import KukaVarproxy
from catseye.drivers.roles.clock import SystemClock
from catseye.simulators.config import SerialLoad
from catseye.simulators.emulated_bench import served_bench

EXAMPLE = Path(__file__).parents[4] / "docs" / "examples" / "kuka.toml"
LEAST = """
format = "catseye-cell/1"
name = "arm"
[robot]
driver = "kuka-varproxy"
endpoint = "tcp://127.0.0.1:0"
arm = "kr210-r2700"
"""


def least_cell() -> Cell:
    return Cell.model_validate(tomllib.loads(LEAST))


def test_a_kuka_moves_the_arm_of_its_description() -> None:
    config = emulation_config(least_cell(), 1.0, 0, None)
    assert config.serial is not None
    assert [joint.name for joint in config.serial.joints] == ["A1", "A2", "A3", "A4", "A5", "A6"]
    a2 = config.serial.joints[1]
    assert (a2.low, a2.high, a2.a_mm, a2.sign, a2.speed) == (-140.0, -5.0, 350.0, 1, 115.0)
    # Masses of the shipped description: four links behind the base.
    assert [load.frame for load in config.serial.loads] == [0, 1, 2, 3, 4]
    assert config.start_joints[1] == -72.5


TOOL = """
format = "catseye-tool/1"
name = "gripper"
mass_kg = 20.0
centre_mm = [0.0, 0.0, 145.0]
[[target]]
name = "retroreflector"
x_mm = 10.0
y_mm = 20.0
z_mm = 300.0
"""


def test_the_tool_loads_the_flange_and_carries_the_retroreflector(tmp_path: Path) -> None:
    (tmp_path / "gripper.toml").write_text(TOOL)
    cell = tmp_path / "cell.toml"
    cell.write_text(LEAST + 'tool = "gripper.toml"\n')
    config = emulation_config(load_cell(cell).cell, 1.0, 0, None)
    assert config.serial is not None
    assert config.serial.loads[-1] == SerialLoad(6, 20.0, (0.0, 0.0, 145.0))
    assert config.arm_optics.target_mm == (10.0, 20.0, 300.0)


def test_emulated_optics_are_those_of_the_cell() -> None:
    sections = """
[angular_optics]
spacing_mm = 31.5
u_spacing_mm = 0.02
[linear_optics]
distance_mm = 400.0
"""
    optics = emulation_config(Cell.model_validate(tomllib.loads(LEAST + sections)), 1.0, 0, None).arm_optics
    assert (optics.spacing_mm, optics.u_spacing_mm, optics.distance_mm) == (31.5, 0.02, 400.0)


def test_a_melfa_moves_a_scara() -> None:
    assert emulation_config(Cell.model_validate(tomllib.loads(TEMPLATE)), 1.0, 0, None).serial is None


@pytest.mark.parametrize(("arm", "model"), [("kr210-r2700", ""), ("rh-3frh5515", "RH-3FRH5515")])
def test_the_model_that_is_expected_is_the_arms(arm: str, model: str) -> None:
    document = tomllib.loads(LEAST)
    document["robot"]["arm"] = arm
    assert Cell.model_validate(document).robot.expected_model == model


async def test_the_example_is_served_and_its_driver_recognises_it() -> None:
    cell = load_cell(EXAMPLE).cell
    free = cell.model_copy(update={"robot": cell.robot.model_copy(update={"endpoint": "tcp://127.0.0.1:0"})})
    async with served_bench(emulation_config(free, 1.0, 0, None)) as bench:
        served = {endpoint.device: endpoint for endpoint in bench.endpoints}
        assert served["robot"].protocol == "kuka-varproxy"
        settings = robot_settings(cell.robot, lambda _device, _direction, _data: None)
        robot = KukaVarproxy.at(served["robot"].endpoint, SystemClock(), **settings)
        assert (await robot.connect()).simulated
        await robot.close()
