"""Mistakes in measured orientations are named: rotations made by hand from the arm's own kinematics."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import angles_of, rotation_of
from catseye.calibration.serial_arm.measurements import MeasuredOrientations, Measurements
from catseye.calibration.serial_arm.orientations import orientation_mistake
from catseye.calibration.serial_arm.plausibility import ImplausibleError, require_plausible
from catseye.calibration.serial_arm.stated_errors import far_more_certain
from tests.unit.calibration.serial_arm.nominal import irb120, measured
from tests.unit.calibration.serial_arm.true_arm import random_poses

ON_TOOL = rotation_of(np.array([20.0, -30.0, 70.0]))


def rows(change: Callable[[Floats], Floats] = lambda r: r) -> Measurements:
    """Return places, and orientations of the first nest's frame, the instrument in the frame of the base."""
    found = measured(random_poses(40, 1), 1)
    base = base_of(found)
    flange = irb120().chain.flange(found.commands.joints)[:, :3, :3]
    count = len(flange)
    turned = MeasuredOrientations(
        np.arange(count), np.zeros(count, dtype=np.int64), change(base @ flange @ ON_TOOL)
    )
    return replace(found, orientations=turned)


def base_of(found: Measurements) -> Floats:
    """Return the rotation of the base by the nominal places of the nests (Kabsch)."""
    arm, points = irb120(), found.points
    flange = arm.chain.flange(found.commands.joints)[points.pose]
    nests = np.array([target.place_mm for target in arm.targets])[points.target]
    own = np.einsum("nij,nj->ni", flange[:, :3, :3], nests) + flange[:, :3, 3]
    left, _, right = np.linalg.svd((points.place_mm - points.place_mm.mean(0)).T @ (own - own.mean(0)))
    return np.asarray((left * [1.0, 1.0, np.linalg.det(left @ right)]) @ right)


def about(angles_deg: Floats, axis: int) -> Floats:
    return np.asarray(rotation_of(angles_deg * np.eye(3)[axis]))


def angles_of_moved_axes(rotation: Floats) -> Floats:
    """Return the angles of R = Rx·Ry·Rz, from the elements of that product."""
    x = np.arctan2(-rotation[:, 1, 2], rotation[:, 2, 2])
    z = np.arctan2(-rotation[:, 0, 1], rotation[:, 0, 0])
    angles: Floats = np.rad2deg(np.column_stack([x, np.arcsin(rotation[:, 0, 2]), z]))
    return angles


def test_orientations_of_the_arm_pass() -> None:
    assert orientation_mistake(irb120(), rows()) == ""
    require_plausible(irb120(), rows())


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda r: rotation_of(np.deg2rad(angles_of(r))), "in rad"),
        (lambda r: r.transpose(0, 2, 1), "those of the instrument in the frame of the target"),
        (lambda r: rotation_of(angles_of_moved_axes(r)), "angles of R = Rx·Ry·Rz"),
        (lambda r: rotation_of(angles_of(r)[:, ::-1]), "exchanged"),
        (lambda r: rotation_of(-angles_of(r)), "opposite sign"),
    ],
)
def test_mistake_of_orientations_is_named(change: Callable[[Floats], Floats], named: str) -> None:
    with pytest.raises(ImplausibleError, match=named):
        require_plausible(irb120(), rows(change))


def test_orientations_of_nothing_are_refused_with_what_is_expected() -> None:
    wild = rotation_of(np.random.default_rng(1).uniform(-180.0, 180.0, (40, 3)))
    with pytest.raises(ImplausibleError, match="how the instrument's program states them"):
        require_plausible(irb120(), rows(lambda r: wild[: len(r)]))


def test_angles_that_are_stated_in_rad_are_doubted() -> None:
    u_deg = np.where(np.arange(40) == 6, np.deg2rad(0.01), 0.01)
    stated = replace(rows(), orientations=replace(rows().orientations, u_deg=u_deg))
    said = far_more_certain(stated)
    assert said is not None
    assert "1 rows (the first: pose 'pose 7', 0.00017 deg)" in said
    assert "Are they in rad? Correct their u_deg" in said
