"""What stands in the room: the frames of its things, and what hides them."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.serial_arm import chain_of
from catseye.calibration.kinematics.rotations import rotation_of
from catseye.simulators.config import SerialBody
from catseye.simulators.errors import BenchError
from catseye.simulators.survey import Mark, Place, SurveyConfig
from catseye.simulators.world.serial.frames import frames_of, inverse, placed
from catseye.simulators.world.serial.sight import clear, in_cone
from tests.unit.simulators.world.serial.surveyed import EXACT, FORWARD, TARGETS, exact_but, surveyed

NOW = np.zeros(1)


def test_frames_turn_as_files_have_it() -> None:
    angles_deg = np.random.default_rng(1).uniform(-180.0, 180.0, (20, 3))
    frames = frames_of(np.ones((20, 3)), np.deg2rad(angles_deg))
    np.testing.assert_allclose(frames[:, :3, :3], rotation_of(angles_deg), atol=1e-12)
    np.testing.assert_allclose(inverse(frames) @ frames, np.tile(np.eye(4), (20, 1, 1)), atol=1e-12)


def test_nests_stand_where_the_kinematics_put_them() -> None:
    flange = chain_of(shipped_arm("irb120")).flange(np.array([FORWARD]))[0]
    places = surveyed().room.places_mm([target.name for target in TARGETS], NOW)[:, 0]
    expected = [(flange @ [*target.place_mm, 1.0])[:3] for target in TARGETS]
    np.testing.assert_allclose(places, expected, atol=1e-6)


def test_warm_links_are_longer_in_proportion() -> None:
    bench = surveyed(exact_but(growth_ppm=200.0))
    cold = bench.room.frames_at(np.array([0.0]))[0, -1]
    bench.follow(np.array([36_000.0]), np.array([[FORWARD[0] + 1e-6, *FORWARD[1:]]]))
    bench.advance(36_000.0)
    warm = bench.room.frames_at(np.array([bench.time_s]))[0, -1]
    # A drive that hardly moves heats half as much as one at full speed.
    np.testing.assert_allclose(warm[:3, 3], cold[:3, 3] * 1.0001, atol=1e-4)
    np.testing.assert_allclose(warm[:3, :3], cold[:3, :3], atol=1e-6)


def test_the_base_wanders_slowly_against_the_table() -> None:
    bench = surveyed(exact_but(base_drift_um=20.0, base_drift_urad=20.0))
    times_s = np.linspace(0.0, 6 * 3600.0, 50)
    tool, table = bench.room.places_mm(["nest1", "world1"], times_s)
    assert 0.005 < np.linalg.norm(tool - tool[0], axis=1).max() < 0.3
    assert np.linalg.norm(tool[1] - tool[0]) < 0.03
    np.testing.assert_array_equal(table, np.broadcast_to(table[0], table.shape))


def test_nests_are_off_their_drawing_by_the_seed() -> None:
    drawn = surveyed().room.nests["nest1"].place_mm
    made = [surveyed(exact_but(u_target_mm=0.05), seed).room.nests["nest1"].place_mm for seed in (1, 2)]
    assert 0.01 < np.linalg.norm(made[0] - drawn) < 0.3
    assert np.linalg.norm(made[0] - made[1]) > 0.01


def test_two_nests_of_one_name_are_refused() -> None:
    with pytest.raises(BenchError, match="two nests have one name"):
        surveyed(SurveyConfig(targets=(TARGETS[0], Mark("nest1", (0.0, 0.0, 0.0)))))


def test_instruments_see_base_and_nests_about_where_cells_say() -> None:
    seen: tuple[Place, Place] = ((2000.0, -400.0, -300.0), (1.0, -2.0, 120.0))
    nest = Mark("corner", (2300.0, -350.0, -280.0))
    for seed in range(5):
        bench = surveyed(replace(EXACT, base_seen=seen, nests=(nest,)), seed)
        into = bench.tracker.station.into_at(NOW)
        # The room's frame is that of the base: three coordinates of 3 mm, and 0.1 deg at two metres.
        assert np.linalg.norm(into[0, :3, 3] - seen[0]) < 25.0
        assert np.abs(into[0, :3, :3] - rotation_of(np.array(seen[1]))).max() < 0.01
        corner = placed(into, bench.room.places_mm(["corner"], NOW)[0])[0]
        assert 0.1 < np.linalg.norm(corner - nest.place_mm) < 30.0


def test_a_cone_ends_at_its_half_angle() -> None:
    angles = np.deg2rad([29.9, 30.1])
    stations = np.column_stack([np.sin(angles), 0.0 * angles, np.cos(angles)])
    found = in_cone(np.zeros((2, 3)), np.tile([0.0, 0.0, 1.0], (2, 1)), stations, 30.0)
    assert found.tolist() == [True, False]


@pytest.mark.parametrize(("offset_mm", "free"), [(0.0, False), (49.0, False), (51.0, True)])
def test_a_capsule_hides_what_is_behind_it(offset_mm: float, free: bool) -> None:
    body = SerialBody(0, (500.0, offset_mm, -100.0), (500.0, offset_mm, 100.0), 50.0)
    frames = np.eye(4)[None, None]
    assert clear([body], frames, np.zeros((1, 3)), np.array([[1000.0, 0.0, 0.0]]))[0] == free


def test_a_body_around_a_nest_does_not_hide_it() -> None:
    body = SerialBody(0, (0.0, 0.0, -10.0), (0.0, 0.0, 10.0), 50.0)
    assert clear([body], np.eye(4)[None, None], np.zeros((1, 3)), np.array([[1000.0, 0.0, 0.0]]))[0]


def test_the_arm_hides_a_nest_of_the_table_behind_it() -> None:
    room = surveyed(EXACT).room
    station = np.array([[600.0, -600.0, 20.0]])
    assert not room.seen("world3", station, NOW)[0]
    assert room.seen("world1", station, NOW)[0]


def test_a_loose_nest_shifts_with_each_motion() -> None:
    bench = surveyed()
    before = bench.room.places_mm(["nest1"], NOW)[0, 0]
    bench.room.named("nest1").loose_mm = 0.5
    there = bench.room.places_mm(["nest1"], NOW)[0, 0]
    bench.move_to((5.0, *FORWARD[1:]))
    bench.advance(10.0)
    bench.move_to(FORWARD)
    bench.advance(10.0)
    back = bench.room.places_mm(["nest1"], np.array([bench.time_s]))[0, 0]
    assert np.linalg.norm(there - before) > 0.05
    assert np.linalg.norm(back - there) > 0.05


def test_the_scale_bar_has_its_true_length() -> None:
    bench = surveyed()
    bench.room.set_up_bar((700.0, 0.0, 300.0), 40.0)
    one, other = bench.room.places_mm(["bar1", "bar2"], NOW)[:, 0]
    assert np.linalg.norm(one - other) == pytest.approx(1000.0, abs=1e-9)
