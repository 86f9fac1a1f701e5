"""Places of targets that are not where the tool's file has them, and are taken as exact."""

from dataclasses import replace

import numpy as np

from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.identification import identify_arm
from catseye.calibration.serial_arm.tool_places import contradicted_places
from tests.unit.calibration.serial_arm.nominal import irb120, measured
from tests.unit.calibration.serial_arm.true_arm import TrueArm, random_poses

OFF_MM = np.array([[0.6, -0.6, 0.5], [-0.7, 0.5, 0.5], [0.5, 0.7, -0.5]])


def off_by(share: float, u_mm: float = 0.0) -> SerialArm:
    arm = irb120()
    moved = [
        replace(one, place_mm=tuple(np.add(one.place_mm, share * off).tolist()), u_mm=u_mm)
        for one, off in zip(arm.targets, OFF_MM, strict=True)
    ]
    return arm.with_targets(tuple(moved))


def said(arm: SerialArm, true: TrueArm | None = None) -> str | None:
    rows = measured(random_poses(60, 1), 1, true)
    return contradicted_places(arm, identify_arm(arm, rows, "geometric+compliance"))


def test_places_wrong_by_a_millimetre_are_named() -> None:
    text = said(off_by(1.0))
    assert text is not None
    assert "State u_mm of the targets in the tool's file" in text


def test_right_places_are_not_doubted() -> None:
    assert said(irb120()) is None


def test_places_with_an_uncertainty_are_not_doubted() -> None:
    assert said(off_by(1.0, u_mm=1.0)) is None


def test_waves_of_joints_are_no_wrong_places() -> None:
    assert said(irb120(), TrueArm(wave_deg=np.full(6, 0.03))) is None
