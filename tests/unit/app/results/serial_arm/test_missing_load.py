"""Torques that lack the tool are remarked where they count."""

import pytest

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.tool import ToolDescription
from catseye.app.results.serial_arm.missing_load import calibrated_without_load, read_without_load
from catseye.app.results.serial_arm.result import SerialArmResult
from tests.unit.app.results.serial_arm.sample import sample_calibration

TOOL = ToolDescription.model_validate(
    {"format": "catseye-tool/1", "name": "plate", "mass_kg": 2.7, "centre_mm": [0.0, 0.0, 0.0]}
)


def rigid() -> SerialArmResult:
    plain = sample_calibration()
    return plain.model_copy(update={"parameters": [one for one in plain.parameters if one.unit == "mm"]})


@pytest.mark.parametrize(
    ("result", "calibrated", "read"),
    [
        (sample_calibration(), True, True),
        (sample_calibration().model_copy(update={"description": shipped_arm("irb120")}), True, False),
        (sample_calibration().model_copy(update={"tool": TOOL}), False, False),
        (rigid(), False, False),
    ],
)
def test_load_is_missed_only_where_it_counts(result: SerialArmResult, calibrated: bool, read: bool) -> None:
    assert (calibrated_without_load(result) is not None) == calibrated
    assert (read_without_load(result) is not None) == read
