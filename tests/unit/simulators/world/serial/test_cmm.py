"""The optical CMM of the bench: poses from the marks that it sees."""

import numpy as np
import pytest

from catseye.simulators.errors import BenchError
from catseye.simulators.survey import Mark, SurveyConfig
from catseye.simulators.world.serial.cmm import plate_marks
from catseye.simulators.world.serial.frames import inverse
from catseye.simulators.world.types import Floats
from tests.unit.simulators.world.serial.surveyed import TARGETS, exact_but, surveyed

FACING = (10.0, 10.0, -10.0, 70.0, -30.0, 40.0)
"""A face of the plate looks to the CMM."""


def test_a_plate_carries_nine_marks_on_either_side() -> None:
    marks = plate_marks(SurveyConfig(targets=TARGETS))
    normals = np.array([mark.normal for mark in marks])
    corners = np.array([target.place_mm for target in TARGETS])
    square = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    assert (normals @ square > 0.0).sum() == (normals @ square < 0.0).sum() == 9
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)


def test_base_and_tool_are_apart_as_in_the_room() -> None:
    bench = surveyed(start=FACING)
    bench.advance(1.0)
    base, tool = bench.cmm.pose("base", 1.0), bench.cmm.pose("tool", 1.0)
    assert base is not None
    assert tool is not None
    assert (base.of, tool.of) == (15, 18)
    assert 3 <= tool.visible <= 9
    true = inverse(bench.room.base_at(np.ones(1))) @ bench.room.frames_at(np.ones(1))[:, -1]
    np.testing.assert_allclose(inverse(base.frame) @ tool.frame, true[0], atol=1e-8)


def spread(places: list[Floats]) -> float:
    return float(np.linalg.norm(np.std(places, axis=0)))


def test_marks_scatter_and_the_volume_is_warped() -> None:
    frames = []
    bench = surveyed(exact_but(mark_um=60.0))
    for _ in range(40):
        bench.advance(1.0)
        pose = bench.cmm.pose("base", 0.05)
        assert pose is not None
        frames.append(pose.frame[:3, 3])
    warped = surveyed(exact_but(volume_um=50.0))
    warped.advance(1.0)
    seen, exact = warped.cmm.pose("base", 0.05), inverse(warped.cmm.station.frame_at(np.ones(1)))[0]
    assert seen is not None
    assert 0.005 < spread(frames) < 0.2
    assert 0.005 < np.linalg.norm((seen.frame - exact)[:3, 3]) < 0.2


def test_marks_that_look_away_are_not_seen() -> None:
    marks = tuple(
        Mark("", place, (-1.0, 0.0, 0.0)) for place in ((0.0, 0.0, 0.0), (0.0, 50.0, 0.0), (0.0, 0.0, 50.0))
    )
    bench = surveyed(SurveyConfig(targets=TARGETS, base_marks=marks))
    bench.advance(1.0)
    assert bench.cmm.pose("base", 0.1) is None


def test_somebody_in_the_way_hides_everything() -> None:
    bench = surveyed()
    bench.advance(1.0)
    bench.cmm.block(5.0)
    assert bench.cmm.pose("base", 0.1) is None
    bench.clear_faults()
    assert bench.cmm.pose("base", 0.1) is not None


def test_only_what_carries_marks_has_a_pose() -> None:
    with pytest.raises(BenchError, match="nothing called 'flange' carries marks; there are tool, base"):
        surveyed().cmm.pose("flange", 1.0)  # type: ignore[arg-type]  # what a wire may ask for
