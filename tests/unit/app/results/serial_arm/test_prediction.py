"""Places that are predicted for poses of a file, by the side that each joint comes from."""

from pathlib import Path

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.identified_arm import IdentifiedArm, identified_arm
from catseye.app.results.serial_arm.prediction import predict_places, read_asked
from catseye.app.results.serial_arm.result import ParameterPart, SerialArmResult
from tests.unit.app.results.serial_arm.sample import sample_calibration

BACKLASH_DEG = 0.1
JOINTS = ",".join(f"q{k}_deg" for k in range(1, 7))
SIDES = ",".join(f"direction{k}" for k in range(1, 7))


def result_with(*more: ParameterPart) -> SerialArmResult:
    """Return the identified parameters of the sample, and more of them."""
    plain = sample_calibration()
    parts = [*plain.parameters[:3], *more]
    correlation = np.eye(len(parts))
    correlation[:3, :3] = plain.correlation
    return plain.model_copy(update={"parameters": parts, "correlation": correlation.tolist()})


def arm() -> IdentifiedArm:
    """Return an arm whose second joint has play."""
    play = ParameterPart(
        name="J2.reversal_deg", value=BACKLASH_DEG, u=0.001, unit="deg", nominal=0.0, identified=True
    )
    return identified_arm(result_with(play))


def asked(path: Path, *lines: str) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_a_pose_from_above_stands_the_backlash_lower(tmp_path: Path) -> None:
    identified = arm()
    head = f"pose,{JOINTS},{SIDES}"
    below, above = "1,1,1,1,1,1", "1,-1,1,1,1,1"
    rows = read_asked(
        asked(tmp_path / "poses.csv", head, f"A,10,20,30,40,50,60,{above}", f"B,10,19.9,30,40,50,60,{below}"),
        identified,
    )
    assert rows.sided
    # From above at 20 deg J2 stands where it stands from below at 20 deg less its play, 0.5 mm at the flange.
    # Gravity's torque is that of the command: at another one the joint yields by some 0.3 um more or less.
    from_above, from_below = predict_places(identified, rows).places_mm
    assert from_above == pytest.approx(from_below, abs=1e-3)


def test_without_sides_the_joints_come_from_below(tmp_path: Path) -> None:
    identified = arm()
    plain = read_asked(asked(tmp_path / "plain.csv", f"pose,{JOINTS}", "A,10,20,30,40,50,60"), identified)
    assert not plain.sided
    assert plain.commands.approach.tolist() == [[1.0] * 6]
    assert identified.reverses
    assert not identified_arm(result_with()).reverses


def test_sides_are_stated_for_all_joints_or_none(tmp_path: Path) -> None:
    path = asked(tmp_path / "poses.csv", f"pose,{JOINTS},direction1", "A,10,20,30,40,50,60,1")
    with pytest.raises(UsageError, match="direction2 is missing: directions of approach are all or none"):
        read_asked(path, arm())
