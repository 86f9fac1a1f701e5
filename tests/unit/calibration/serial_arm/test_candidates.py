"""Candidates of a pose selection keep their rules, checked by an arm that is computed by screws."""

import numpy as np
import pytest

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.bodies import capsules_of
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.bodies import Capsule, Point, Scene
from catseye.calibration.serial_arm.design.candidates import (
    Candidates,
    Rules,
    Sight,
    draw_candidates,
)
from catseye.calibration.serial_arm.design.pose_rows import pose_rows
from catseye.calibration.serial_arm.sight import View
from tests.unit.calibration.serial_arm.nominal import irb120
from tests.unit.calibration.serial_arm.true_arm import DRAWN, HIGH, LOW

STATION: Point = (1800.0, 300.0, 500.0)
NORMALS: tuple[Point | None, ...] = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def scene() -> Scene:
    chain = irb120().chain
    return Scene(chain, capsules_of(shipped_arm("irb120").body, chain))


def seen_angles_deg(found: Candidates) -> Floats:
    """Return the angle between where each nest looks and the station."""
    flange = DRAWN.flange(found.joints)
    towards = np.array(STATION) - DRAWN.nests(found.joints, found.targets[:, 0])
    looks = np.einsum("nij,nj->ni", flange[:, :3, :3], np.array(NORMALS)[found.targets[:, 0]])
    cosine = np.einsum("ni,ni->n", looks, towards) / np.linalg.norm(towards, axis=1)
    return np.asarray(np.rad2deg(np.arccos(cosine)))


def test_joints_and_their_approach_stay_within_limits() -> None:
    found = draw_candidates(irb120(), Rules(low=LOW, high=HIGH), 300, 1)
    own = np.array([joint.low for joint in irb120().chain.joints])
    assert (found.joints >= np.maximum(LOW, own + 5.0)).all()
    assert (found.joints <= HIGH).all()
    assert np.bincount(found.targets[:, 0]).tolist() == [100, 100, 100]


def test_every_target_looks_at_the_station_within_its_cone() -> None:
    found = draw_candidates(irb120(), Rules(sight=Sight(View(STATION, 30.0), NORMALS)), 200, 2)
    assert seen_angles_deg(found).max() <= 30.0
    assert found.drawn > 1000


def test_nothing_of_the_arm_is_in_the_line_of_sight() -> None:
    column = Capsule("column", 0, (300.0, -2000.0, 0.0), (300.0, 2000.0, 0.0), 250.0)
    view = View((1800.0, 0.0, -600.0), bodies=(column,))
    found = draw_candidates(irb120(), Rules(sight=Sight(view, (None,) * 3)), 50, 3)
    for place in DRAWN.nests(found.joints, found.targets[:, 0]):
        along = place + np.linspace(0.0, 1.0, 400)[:, None] * (np.array([1800.0, 0.0, -600.0]) - place)
        apart = np.hypot(along[:, 0] - 300.0, along[:, 2])
        assert apart[0] <= 250.0 or apart.min() > 249.0


def test_bodies_that_would_meet_are_left_out() -> None:
    free = draw_candidates(irb120(), Rules(scene(), gap_mm=10.0), 200, 4)
    assert free.drawn >= 5000
    crowded = Rules(scene(), gap_mm=1e4)
    with pytest.raises(InsufficientPointsError, match="bodies come too near"):
        draw_candidates(irb120(), crowded, 1, 4)


def test_rows_are_slopes_of_the_nest_by_its_parameters() -> None:
    found = draw_candidates(irb120(), Rules(), 30, 5)
    shown = pose_rows(irb120(), found.joints, found.targets, "geometric")
    rows, names = shown.rows, shown.names
    assert rows.shape == (30, 3, 26)
    # d6 shifts the nest along the flange's z axis, a millimetre per millimetre.
    along = DRAWN.flange(found.joints)[:, :3, 2]
    assert rows[:, :, names.index("J6.d_mm")] == pytest.approx(along, abs=1e-9)
    turned = np.cross([0.0, 0.0, 1.0], DRAWN.nests(found.joints, found.targets[:, 0])) * np.deg2rad(1.0)
    assert rows[:, :, names.index("base.rz_deg")] == pytest.approx(turned, abs=1e-9)


def test_frames_bring_three_angles_beside_three_coordinates() -> None:
    found = draw_candidates(irb120(), Rules(targets_per_pose=2), 60, 6)
    shown = pose_rows(irb120(), found.joints, found.targets, "geometric", frames=True)
    assert shown.rows.shape[:2] == (60, 12)
    points = pose_rows(irb120(), found.joints, found.targets, "geometric")
    turned = [shown.names.index(name) for name in ("base.x_mm", "base.rz_deg")]
    alike = [points.names.index(name) for name in ("base.x_mm", "base.rz_deg")]
    assert shown.rows[:, [0, 1, 2, 6, 7, 8]][:, :, turned] == pytest.approx(points.rows[:, :, alike])


def test_targets_that_are_not_seen_bring_no_rows() -> None:
    found = draw_candidates(irb120(), Rules(), 20, 7)
    targets = np.column_stack([found.targets[:, 0], np.full(20, -1)])
    shown = pose_rows(irb120(), found.joints, targets, "frames")
    assert (shown.rows[:, 3:] == 0.0).all()
    assert np.any(shown.rows[:, :3] != 0.0, axis=-1).all()


def test_maps_are_weighed_by_the_spread_among_arms() -> None:
    found = draw_candidates(irb120(), Rules(), 200, 8)
    shown = pose_rows(irb120(), found.joints, found.targets, "maps")
    nodes = np.array([".map_" in name or ".cos" in name or ".sin" in name for name in shown.names])
    assert nodes.sum() > 40
    # 0.04 mm of a coordinate against 0.02 deg of an amplitude.
    assert shown.known == pytest.approx(np.where(nodes, (0.04 / 0.02) ** 2, 0.0))
