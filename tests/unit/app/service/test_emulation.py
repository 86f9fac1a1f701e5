"""The emulated bench of a cell file."""

import tomllib

import pytest

from catseye.app.cell.hands import hands_endpoint
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import ConfigError
from catseye.app.service.emulation import emulated_devices
from catseye.app.service.scara.emulation import emulation_config


def cell(alignment: str = "", optics: str = "") -> Cell:
    document = tomllib.loads(TEMPLATE)
    document["alignment"] = tomllib.loads(alignment)
    document["optics"] |= tomllib.loads(optics)
    return Cell.model_validate(document)


@pytest.mark.parametrize(
    ("senses", "stage", "level"),
    [
        ("", 0.25, 1.5),
        ('stage_clockwise = "-y"', -0.25, 1.5),
        ('level_clockwise = "down"', 0.25, -1.5),
    ],
)
def test_screws_act_as_the_cell_file_says(senses: str, stage: float, level: float) -> None:
    given = cell(f"stage_mm_per_turn = 0.25\nlevel_mrad_per_turn = 1.5\n{senses}")
    screws = emulation_config(given, 1.0, 0, None).screws
    assert (screws.stage_mm_per_turn, screws.level_mrad_per_turn) == (stage, level)
    turned = screws.reversed()
    assert (turned.stage_mm_per_turn, turned.level_mrad_per_turn) == (-stage, -level)


def test_one_reflector_is_carried_where_the_cell_file_says_so() -> None:
    assert not emulation_config(cell(), 1.0, 0, None).one_reflector
    assert emulation_config(cell(optics="one_reflector = true"), 1.0, 0, None).one_reflector


def with_tracker(driver: str, endpoint: str) -> Cell:
    document = tomllib.loads(TEMPLATE)
    document["tracker"] = {"driver": driver, "endpoint": endpoint}
    return Cell.model_validate(document)


def test_a_tracker_with_a_protocol_is_a_device() -> None:
    given = with_tracker("leica-emscon", "tcp://127.0.0.1:10700")
    (device,) = [device for device in emulated_devices(given) if device.name == "tracker"]
    assert (device.protocol, device.endpoint) == ("leica-emscon", "tcp://127.0.0.1:10700")
    assert emulation_config(given, 1.0, 0, None).control == "tcp://127.0.0.1:0"


@pytest.mark.parametrize(
    ("driver", "endpoint", "control"),
    [
        ("bench-tracker", "tcp://127.0.0.1:10099", "tcp://127.0.0.1:10099"),
        ("file", "file:///tmp/readings.csv", "tcp://127.0.0.1:0"),
    ],
)
def test_other_trackers_are_no_device_of_the_bench(driver: str, endpoint: str, control: str) -> None:
    given = with_tracker(driver, endpoint)
    assert all(device.name != "tracker" for device in emulated_devices(given))
    assert emulation_config(given, 1.0, 0, None).control == control


def test_hands_reach_the_bench_of_an_emulated_tracker() -> None:
    given = with_tracker("leica-emscon", "tcp://127.0.0.1:10700")
    assert hands_endpoint(given) is None
    reached = given.model_copy(
        update={
            "tracker": given.tracker and given.tracker.model_copy(update={"control": "tcp://127.0.0.1:7"})
        }
    )
    assert hands_endpoint(reached) == "tcp://127.0.0.1:7"
    assert emulation_config(reached, 1.0, 0, None).control == "tcp://127.0.0.1:7"


def test_an_unknown_tracker_cannot_be_emulated() -> None:
    with pytest.raises(ConfigError, match=r"\[tracker\] driver: no driver 'theodolite'"):
        emulated_devices(with_tracker("theodolite", "tcp://127.0.0.1:1"))
