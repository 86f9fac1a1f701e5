"""What a client that watches receives: values with their ages, nothing where nothing is known."""

import json
import math
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.cell.bench import bench_of
from catseye.app.cell.model import Cell, FurtherDevice, Material
from catseye.app.protocol.bench import OpticsStatus
from catseye.app.service.watching.bench_facts import BenchFacts, facts_of
from catseye.app.service.watching.bench_status import bench_status
from catseye.app.service.watching.latest_values import LatestValues
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotStatus
from catseye.procedures.scara.bench import ScaraBench
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.app.service.manual.benches import bench_from_template, cell_from_template
from tests.unit.app.tui.serial.scripted_arm import CELL

STATUS = RobotStatus(True, False, True, False, False, 10.0, 0, "")
BEAM = BeamStatus(True, False, False, True, 0.8, "800 mV")


@cache
def facts() -> BenchFacts:
    return facts_of(cell_from_template(), bench_from_template())


def message_of(
    latest: LatestValues, *, moving: bool = False, simulated: bool | None = None
) -> dict[str, Any]:
    status = bench_status(facts(), latest, moving=moving, simulated=simulated, free_bytes=1000)
    return status.json_object()


def test_a_silent_bench_is_described_from_its_cell_file() -> None:
    message = message_of(LatestValues(ManualClock()))
    assert [message[name] for name in ("robot", "beam", "air", "door_closed", "simulated")] == [None] * 5
    cell = cell_from_template()
    robot = {"name": "robot", "endpoint": cell.robot.endpoint, "driver": cell.robot.driver}
    assert message["devices"][0] == {
        **robot,
        "moves_arm": True,
        "link": "closed",
        "identity": None,
        "error": None,
        "age_s": None,
    }
    assert [device["name"] for device in message["devices"]] == [
        "robot",
        "interferometer",
        "environment",
        "tracker",
    ]  # fmt: skip - a list
    layout = message["layout"]
    assert (layout["link1_mm"], layout["limits_deg"]["j1"], layout["aim"]) == (325.0, [-170.0, 170.0], None)
    assert [place["name"] for place in layout["reflectors"]] == [r.name for r in cell.reflector]
    assert (message["cell"], message["disk_free_bytes"], message["missed"]) == (cell.name, 1000, 0)


def test_further_devices_have_the_names_of_the_cell_file() -> None:
    cell: Cell = cell_from_template()
    steel = FurtherDevice(name="steel", driver="modbus-air", endpoint="tcp://127.0.0.1:1")
    cell = cell.model_copy(update={"device": [steel], "material": Material(sensor="steel", cte_per_k=1e-5)})
    found = facts_of(cell, bench_from_template())
    assert (found.devices[-1].name, found.material) == ("steel", "steel")


def test_a_group_of_values_has_its_oldest_parts_age() -> None:
    clock = ManualClock()
    latest = LatestValues(clock)
    latest.take_status(STATUS)
    latest.take_displacement(12.5)
    clock.advance(2.0)
    latest.take_joints((1.0, 2.0, 3.0, 4.0))
    latest.take_beam(BEAM)
    clock.advance(1.0)
    message = message_of(latest)
    assert message["robot"]["age_s"] == message["beam"]["age_s"] == 3.0
    latest.take_status(replace(STATUS, running=True))
    assert message_of(latest)["robot"]["age_s"] == 1.0
    assert (message["robot"]["moving"], message_of(latest)["robot"]["moving"]) == (False, True)
    assert message["robot"]["joints"] == [1.0, 2.0, 3.0, 4.0]
    assert (message["robot"]["override_percent"], message["robot"]["override_cap_percent"]) == (10.0, 20.0)
    beam = message["beam"]
    assert (beam["signal_native"], beam["displacement_mm"], beam["spread_um"]) == ("800 mV", 12.5, None)


def test_the_run_overrides_whether_moving_and_simulated() -> None:
    latest = LatestValues(ManualClock())
    latest.take_status(STATUS)
    latest.connected("robot", Identity("m", "f", "s", simulated=True))
    assert message_of(latest)["simulated"] is True
    assert message_of(latest, moving=True)["robot"]["moving"] is True
    assert message_of(latest, simulated=False)["simulated"] is False
    latest.connected("environment", Identity("m", "f", "s", simulated=False))
    assert message_of(latest)["simulated"] is False


def test_mean_and_spread_of_the_last_second_are_published() -> None:
    latest = LatestValues(ManualClock())
    for value_mm in (1.0, 1.001, 1.002):
        latest.take_displacement(value_mm)
    latest.take_beam(BEAM)
    assert message_of(latest)["beam"]["spread_um"] == pytest.approx(1.0)
    assert message_of(latest)["beam"]["mean_mm"] == pytest.approx(1.001)


def test_links_say_how_they_fare() -> None:
    clock = ManualClock()
    latest = LatestValues(clock)

    def robot() -> dict[str, Any]:
        device: dict[str, Any] = message_of(latest)["devices"][0]
        return {name: device[name] for name in ("link", "error", "age_s")}

    latest.connecting("robot")
    assert robot() == {"link": "connecting", "error": None, "age_s": None}
    latest.connected("robot", Identity("RH", "A1", "7", simulated=False))
    clock.advance(3.0)
    latest.lost("robot", "no cable")
    latest.closed("robot")
    assert robot() == {"link": "lost", "error": "no cable", "age_s": 3.0}
    latest.connecting("robot")
    assert robot() == {"link": "connecting", "error": "no cable", "age_s": 3.0}
    latest.answered("robot")
    assert robot() == {"link": "ok", "error": None, "age_s": 0.0}
    latest.closed("robot")
    assert robot()["link"] == "closed"
    latest.taken("robot")
    assert robot() == {"link": "raw", "error": None, "age_s": None}
    assert message_of(latest)["devices"][0]["identity"] == {
        "model": "RH",
        "firmware": "A1",
        "serial": "7",
        "simulated": False,
    }  # fmt: skip - a table


def test_air_is_published_with_its_index_if_any() -> None:
    latest = LatestValues(ManualClock())
    latest.take_air(AirSample(20.0, 1013.25, 50.0, 0.0))
    air = message_of(latest)["air"]
    # Of ref-index 1.0 and AstroAtmosphere 1.6 at 450 ppm CO2 and 632.9908 nm.
    assert air["refractive_index"] == pytest.approx(1.0002713729, abs=1e-10)
    assert (air["formula"], air["temperature_c"]) == ("ciddor", 20.0)
    for lacking in (AirSample(20.0, None, 50.0, 0.0), AirSample(math.nan, 1013.0, 50.0, 0.0)):
        latest.take_air(lacking)
        assert message_of(latest)["air"]["refractive_index"] is None
        assert "NaN" not in json.dumps(message_of(latest))


def test_what_is_no_number_is_published_as_none() -> None:
    """JSON of other languages has no NaN."""
    latest = LatestValues(ManualClock())
    latest.take_status(STATUS)
    latest.take_joints((math.nan, 2.0, math.inf, 4.0))
    latest.take_beam(replace(BEAM, signal=math.nan))
    latest.take_displacement(math.nan)
    message = message_of(latest)
    json.dumps(message, allow_nan=False)
    assert message["robot"]["joints"] == [None, 2.0, None, 4.0]
    assert (message["beam"]["signal"], message["beam"]["displacement_mm"]) == (None, None)
    assert latest.columns.take(1.0).count == []


@given(theta1_deg=st.floats(-170.0, 170.0), theta2_deg=st.floats(-145.0, 145.0), number=st.integers(0, 2))
def test_the_aim_is_the_reflector_the_beam_points_to(
    theta1_deg: float, theta2_deg: float, number: int
) -> None:
    layout = facts().bench
    assert isinstance(layout, ScaraBench)
    one, both = math.radians(theta1_deg), math.radians(theta1_deg + theta2_deg)
    x_mm = 325.0 * math.cos(one) + 225.0 * math.cos(both)
    y_mm = 325.0 * math.sin(one) + 225.0 * math.sin(both)
    goal = layout.reflectors[number]
    world_rad = math.atan2(goal.y_mm - y_mm, goal.x_mm - x_mm)
    latest = LatestValues(ManualClock())

    def aim(off_rad: float) -> object:
        joints: Pose = (theta1_deg, theta2_deg, 0.0, math.degrees(world_rad + off_rad - both))
        latest.take_joints(joints)
        return message_of(latest)["layout"]["aim"]

    assert aim(0.0) == goal.name
    assert aim(math.pi) != goal.name


def test_an_arm_without_a_layout_has_posture_and_ranges() -> None:
    latest = LatestValues(ManualClock())
    latest.take_joints((10.0, -90.0, 90.0, 0.0, 0.0, 0.0))
    status = bench_status(facts_of(CELL, bench_of(CELL)), latest, moving=False, simulated=None, free_bytes=1)
    assert (status.layout, len(status.posture.joints_mm if status.posture else ())) == (None, 7)
    assert [(axis.name, axis.low, axis.high) for axis in status.axes[:2]] == [
        ("A1", -185.0, 185.0),
        ("A2", -140.0, -5.0),
    ]


def test_a_scara_has_a_layout_and_no_posture() -> None:
    latest = LatestValues(ManualClock())
    latest.take_joints((10.0, 20.0, 50.0, 0.0))
    message = message_of(latest)
    assert (message["posture"], message["layout"] is None) == (None, False)


def test_torques_are_published_while_they_are_new() -> None:
    clock = ManualClock()
    latest = LatestValues(clock)
    latest.take_status(STATUS)
    latest.take_torques((1.5, math.nan, -2.0))
    assert message_of(latest)["robot"]["torques_nm"] == [1.5, None, -2.0]
    clock.advance(20.0)
    latest.take_status(STATUS)
    assert "torques_nm" not in message_of(latest)["robot"]


def test_optics_of_the_cell_file_are_published() -> None:
    with_optics = CELL.model_dump(mode="json", exclude_unset=True) | {"angular_optics": {"spacing_mm": 32.61}}
    cell = Cell.model_validate(with_optics)
    latest = LatestValues(ManualClock())
    status = bench_status(facts_of(cell, bench_of(cell)), latest, moving=False, simulated=None, free_bytes=1)
    assert status.optics == OpticsStatus(spacing_mm=32.61, linear=False)
    assert "optics" not in message_of(latest)
