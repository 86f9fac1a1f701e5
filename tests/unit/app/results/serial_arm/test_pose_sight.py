"""Poses that select-poses proposes in a cell are seen by the procedure, and by rays walked point by point."""

import tomllib
from copy import deepcopy
from typing import Any, cast

import numpy as np
import pytest

from catseye.app.cell.bench import bench_of
from catseye.app.cell.model import Cell
from catseye.app.cell.six_axis.template import BY_ARM
from catseye.app.results.serial_arm.pose_setup import Asked, setup_of_cell
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.serial_arm.design.candidates import Candidates, draw_candidates
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.pose_plan import PoseFinder

DEMO: dict[str, Any] = tomllib.loads(BY_ARM["irb120"])
BOX = {"name": "cabinet", "min_mm": [900.0, -250.0, 250.0], "max_mm": [1000.0, -50.0, 650.0]}
POST = {
    "name": "post",
    "joint": "base",
    "from_mm": [1000.0, -150.0, 0.0],
    "to_mm": [1000.0, -150.0, 800.0],
    "radius_mm": 80.0,
}
POSES, TARGETS = 300, 3


def boxed() -> dict[str, Any]:
    made = deepcopy(DEMO)
    made.setdefault("workspace", {}).setdefault("keep_out", []).append(BOX)
    return made


def posted() -> dict[str, Any]:
    made = deepcopy(DEMO)
    made.setdefault("body", []).append(POST)
    return made


def faced() -> dict[str, Any]:
    made = deepcopy(boxed())
    made["tracker"] |= {"driver": "file", "endpoint": "file:cmm.csv", "face_deg": 15.0}
    return made


def drawn(data: dict[str, Any], measured: str | None = None) -> tuple[SerialBench, Candidates, PoseFinder]:
    cell = Cell.model_validate(data)
    wanted = cast("Any", measured)
    asked = Asked(POSES, measured=wanted, targets_per_pose=TARGETS)
    setup = setup_of_cell(cell, asked)
    bench = cast("SerialBench", bench_of(cell))
    finder = PoseFinder(bench, bench.targets, wanted or "points", asked.approach, (0.0,) * 6)
    return bench, draw_candidates(setup.arm, setup.rules, POSES, 1), finder


def hidden_by_hand(bench: SerialBench, joints: Floats, target: int) -> bool:
    """Return whether a point of the ray from a target to the instrument lies in a body or a box."""
    frames = bench.workspace.chain.frames(joints[None])[:, 0]
    place = (frames[-1] @ [*bench.targets[target].place_mm, 1.0])[:3]
    ray = place + np.linspace(0.0, 1.0, 1500)[:, None] * (bench.instrument.station_mm - place)

    def within(points: Floats, start: Floats, end: Floats, radius_mm: float) -> Bools:
        along = end - start
        share = np.clip((points - start) @ along / max(float(along @ along), 1e-9), 0.0, 1.0)
        return np.asarray(np.linalg.norm(points - start - share[:, None] * along, axis=1) < radius_mm)

    for body in bench.workspace.bodies:
        start, end = ((frames[body.frame] @ [*at, 1.0])[:3] for at in (body.start_mm, body.end_mm))
        if within(ray, start, end, body.radius_mm - 0.01).any() and not within(
            ray[:1], start, end, body.radius_mm
        ):
            return True
    return any(
        bool(((ray > np.array(box.low_mm)) & (ray < np.array(box.high_mm))).all(axis=1).any())
        for box in bench.workspace.keep_out
    )


CELLS = pytest.mark.parametrize(
    ("data", "measured"),
    [(DEMO, None), (boxed(), None), (posted(), None), (faced(), "poses")],
    ids=["demo", "keep-out box", "post", "optical CMM"],
)


@CELLS
def test_selected_poses_are_seen_by_the_procedure(data: dict[str, Any], measured: str | None) -> None:
    bench, found, finder = drawn(data, measured)
    assert finder.all_seen(found.joints, TARGETS).tolist() == found.targets.tolist()
    names = [target.name for target in bench.targets]
    for joints, targets in zip(found.joints.tolist(), found.targets.tolist(), strict=True):
        assert finder.seen_at(tuple(joints), TARGETS) == tuple(names[k] for k in targets if k >= 0)


@CELLS
def test_nothing_stands_in_the_rays_of_selected_poses(data: dict[str, Any], measured: str | None) -> None:
    bench, found, _ = drawn(data, measured)
    for joints, targets in zip(found.joints, found.targets.tolist(), strict=True):
        assert not any(hidden_by_hand(bench, joints, k) for k in targets if k >= 0)


@pytest.mark.parametrize("data", [boxed(), posted()], ids=["keep-out box", "post"])
def test_box_and_post_hide_poses_of_the_open_cell(data: dict[str, Any]) -> None:
    _, found, _ = drawn(DEMO)
    bench, _, finder = drawn(data)
    seen = finder.all_seen(found.joints, TARGETS)
    hidden = [
        hidden_by_hand(bench, joints, targets[0])
        for joints, targets in zip(found.joints, found.targets.tolist(), strict=True)
    ]
    assert 5 < sum(hidden) < POSES
    first = [k in own for k, own in zip(found.targets[:, 0].tolist(), seen.tolist(), strict=True)]
    assert first == [not one for one in hidden]


def test_faces_are_seen_within_their_angle_from_both_sides() -> None:
    bench, found, _ = drawn(faced(), "poses")
    flange = bench.workspace.chain.flange(found.joints)
    signs = []
    for frame, targets in zip(flange, found.targets.tolist(), strict=True):
        target = bench.targets[targets[0]]
        normal = np.array(target.normal) / np.linalg.norm(np.array(target.normal))
        sight = bench.instrument.station_mm - (frame @ [*target.place_mm, 1.0])[:3]
        signs.append(float(frame[:3, :3] @ normal @ sight / np.linalg.norm(sight)))
    assert np.min(np.abs(signs)) >= np.cos(np.deg2rad(15.0)) - 1e-12
    assert min(signs) < 0.0 < max(signs)
