"""Mistakes in tables of poses are named."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import Anchor
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.measurements import MeasuredDistances, Measurements
from catseye.calibration.serial_arm.plausibility import ImplausibleError, outside_ranges, require_plausible
from catseye.calibration.serial_arm.read_back import other_poses
from catseye.calibration.serial_arm.stated_errors import in_other_unit
from tests.unit.calibration.serial_arm.nominal import irb120, measured
from tests.unit.calibration.serial_arm.true_arm import TrueArm, random_poses

Change = Callable[[Measurements], Measurements]


def joints(change: Callable[[Floats], Floats]) -> Change:
    return lambda rows: replace(rows, commands=Commands.of(irb120(), change(rows.commands.joints)))


def places(change: Callable[[Floats], Floats]) -> Change:
    return lambda rows: replace(rows, points=replace(rows.points, place_mm=change(rows.points.place_mm)))


def renamed(rows: Measurements) -> Measurements:
    to = np.array([0, 2, 1])
    return replace(rows, points=replace(rows.points, target=to[rows.points.target]))


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (joints(np.deg2rad), "in rad, not in deg"),
        (joints(lambda q: q[:, ::-1]), "opposite order"),
        (joints(lambda q: q[:, [1, 0, 2, 3, 4, 5]]), "J1 and J2 are exchanged"),
        (joints(lambda q: q * np.array([1.0, 1.0, -1.0, 1.0, 1.0, 1.0])), "J3 has the opposite sign"),
        # Joints of a row that belong to the measurement in the row below it, and above it.
        (joints(lambda q: np.roll(q, -1, axis=0)), "if each row has the joints of the next pose"),
        (joints(lambda q: np.roll(q, 1, axis=0)), "if each row has the joints of the pose before"),
        (places(lambda x: x / 1000.0), "in m, not in mm"),
        (joints(lambda q: np.where(np.arange(6) == 2, np.deg2rad(q), q)), "J3 is in rad, not in deg"),
        (
            places(lambda x: np.where(np.arange(len(x))[:, None] % 7 == 3, x / 1000.0, x)),
            r"the places of \d+ rows are in m, not in mm \(the first: pose",
        ),
        (places(lambda x: x / 25.4), "in inches, not in mm"),
        (places(lambda x: x / 10.0), "coordinates are in cm, not in mm"),
        (
            places(lambda x: x * np.array([1.0, -1.0, 1.0]) / 1000.0),
            "coordinates are in m, not in mm, and the frame of the instrument is left-handed",
        ),
        (
            joints(lambda q: q * np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])),
            "J2 and J5 have the opposite signs",
        ),
        # Column by column the joints 3, 1, 2 and so on of the arm.
        (
            joints(lambda q: q[:, [2, 0, 1, 3, 5, 4]]),
            "if the joints stand in the order J3, J1, J2, J4, J6, J5:",
        ),
        (places(lambda x: x * np.array([1.0, -1.0, 1.0])), "left-handed"),
        (renamed, "nest2 is nest3"),
        (
            joints(lambda q: np.where(np.arange(len(q))[:, None] % 2, np.deg2rad(q), q)),
            r"the joints of 20 poses are in rad, not in deg \(the first: pose",
        ),
        (
            lambda rows: places(lambda x: x / 1000.0)(joints(np.deg2rad)(rows)),
            "the joints are in rad and the coordinates in m",
        ),
        (joints(lambda q: q + 90.0 * (np.arange(6) == 1)), "J2 counts from a zero -90 deg away"),
        (places(lambda x: np.where(np.arange(len(x))[:, None] == 7, 0.0, x)), "if 'pose 8' is left out"),
        (joints(lambda q: 0.0 * q + q[0]), "all 40 poses have the same joints"),
    ],
)
def test_mistake_is_named(change: Change, named: str) -> None:
    with pytest.raises(ImplausibleError, match=named):
        require_plausible(irb120(), change(measured(random_poses(40, 1), 1)))


@pytest.mark.parametrize("wrist", [(3, 4, 5), (4, 5), (3, 5)])
def test_joints_of_the_wrist_in_rad_are_named(wrist: tuple[int, ...]) -> None:
    """So small numbers are plausible as degrees."""
    in_rad = joints(lambda q: np.where(np.isin(np.arange(6), wrist), np.deg2rad(q), q))
    named = ", ".join(f"J{k + 1}" for k in wrist)
    with pytest.raises(ImplausibleError, match=f"if {named} are in rad, not in deg"):
        require_plausible(irb120(), in_rad(measured(random_poses(40, 1), 1)))


def test_poses_outside_the_ranges_are_named() -> None:
    a_turn = joints(lambda q: np.where((np.arange(len(q))[:, None] == 4) & (np.arange(6) == 3), q + 360.0, q))
    rows = measured(random_poses(40, 1), 1)
    assert outside_ranges(irb120(), rows) is None
    said = outside_ranges(irb120(), a_turn(rows))
    assert said is not None
    assert "1 of 40 poses are outside the ranges of the arm description (the first: pose 'pose 5', J4" in said
    assert "outside -160…160 deg" in said


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (np.deg2rad, "if the joints are in rad, not in deg"),
        (lambda q: np.where(np.arange(6) > 2, np.deg2rad(q), q), "if J4, J5, J6 are in rad, not in deg"),
        (lambda q: q[:, ::-1], "if the joints stand in the opposite order"),
        (lambda q: q * np.array([1.0, 1.0, -1.0, 1.0, 1.0, 1.0]), "if J3 has the opposite sign"),
        (lambda q: q * np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0]), "if J2 and J5 have the opposite signs"),
        (lambda q: q[:, [2, 0, 1, 3, 5, 4]], "if the joints stand in the order J3, J1, J2, J4, J6, J5"),
        (lambda q: np.roll(q, -1, axis=0), "if each row has the joints of the next pose"),
        (lambda q: np.roll(q, 1, axis=0), "if each row has the joints of the pose before"),
        (lambda q: q + 360.0 * (np.arange(6) == 5), "if J6 is whole turns away"),
        (lambda q: q + 90.0 * (np.arange(6) == 1), "if J2 counts from a zero -90 deg away"),
        (lambda q: random_poses(len(q), 2), "they are not those of these poses"),
    ],
)
def test_mistake_in_joints_read_back_is_named(change: Callable[[Floats], Floats], named: str) -> None:
    rows = measured(random_poses(40, 1), 1)
    read = rows.commands.joints + np.random.default_rng(3).normal(0.0, 0.03, (40, 6))
    require_plausible(irb120(), rows, read)
    with pytest.raises(ImplausibleError, match=f"^the joints read back differ .*{named}.*q1_read_deg"):
        require_plausible(irb120(), rows, change(read))


def test_single_poses_read_back_elsewhere_are_remarked() -> None:
    rows = measured(random_poses(40, 1), 1)
    commanded = rows.commands.joints
    read = commanded + np.random.default_rng(3).normal(0.0, 0.03, (40, 6))
    assert other_poses(irb120(), commanded, read, rows.names) is None
    read[1::3] = 0.0
    said = other_poses(irb120(), commanded, read, rows.names)
    assert said is not None
    assert "at 13 of 40 poses differ from the commanded ones by more than 1 deg" in said
    assert "all of them 0 there (the first: pose 'pose 2'" in said


def test_rows_that_are_far_more_certain_are_named() -> None:
    rows = measured(random_poses(40, 1), 1)
    assert rows.points.covariance_mm2 is not None
    in_m = np.where(np.isin(np.arange(40), (4, 9))[:, None, None], 1e-6, 1.0) * rows.points.covariance_mm2
    wrong = replace(rows, points=replace(rows.points, covariance_mm2=in_m))
    with pytest.raises(
        ImplausibleError,
        match=r"uncertainties of 2 rows \(the first: pose 'pose 5', 4e-05 mm\).*Are they in m",
    ):
        require_plausible(irb120(), wrong)


def test_a_finer_instrument_beside_a_coarse_one_passes() -> None:
    """A CMM that states 0.5 µm at some poses, and a tracker far away that states 0.12 mm."""
    rows = measured(random_poses(60, 1), 1)
    finer = np.arange(60) < 12

    def stated(finer_mm: float) -> Measurements:
        u_mm = np.where(finer, finer_mm, 0.12)
        return replace(rows, points=replace(rows.points, covariance_mm2=u_mm[:, None, None] ** 2 * np.eye(3)))

    assert in_other_unit(stated(0.0005)) is None
    require_plausible(irb120(), stated(0.0005))
    # The same instrument, whose 0.5 µm were written down in m.
    assert "Are they in m" in (in_other_unit(stated(0.5e-6)) or "")


def test_a_tool_in_another_unit_is_named() -> None:
    arm = irb120()
    x, y, z = np.array([one.place_mm for one in arm.targets]).T / 10.0
    small = [(a, b, c) for a, b, c in zip(x.tolist(), y.tolist(), z.tolist(), strict=True)]
    targets = tuple(replace(one, place_mm=place) for one, place in zip(arm.targets, small, strict=True))
    with pytest.raises(ImplausibleError, match="if the places of the tool's targets are in cm, not in mm"):
        require_plausible(replace(arm, targets=targets), measured(random_poses(40, 1), 1))


def distances(count: int, copied: int, digits: int = 6) -> Measurements:
    """Give rows of two distances each at poses; of some the second is the first."""
    rng, poses = np.random.default_rng(4), random_poses(count, 4)
    anchor = Anchor("cup", (400.0, 100.0, 300.0))
    away = np.linalg.norm(TrueArm().nests(poses, np.zeros(count, dtype=np.int64)) - anchor.place_mm, axis=1)
    first, second = (np.round(away + rng.normal(0.0, 0.005, count), digits) for _ in range(2))
    second[:copied] = first[:copied]
    pose, none = np.tile(np.arange(count), 2), np.zeros(2 * count, dtype=np.int64)
    rows = MeasuredDistances(pose, none, none, none - 1, np.concatenate([first, second]), anchors=(anchor,))
    return replace(measured(poses, 1), distances=rows)


def test_distances_that_stand_twice_are_named() -> None:
    with pytest.raises(ImplausibleError, match=r"^25 rows repeat others to the last digit"):
        require_plausible(irb120(), distances(40, 25))


def test_distances_that_agree_by_chance_pass() -> None:
    rows = distances(400, 0, digits=2)
    first, second = rows.distances.distance_mm.reshape(2, -1)
    assert 50 < np.count_nonzero(first == second) < 200
    require_plausible(irb120(), rows)


def visits(digits: int, noise_mm: float, copied: int = 0) -> Measurements:
    """Give three visits to each of 30 poses; the last visit to some of them is a copy of the first."""
    rng, poses = np.random.default_rng(6), np.tile(random_poses(30, 6), (3, 1))
    rows = measured(poses)
    points = replace(rows.points, target=np.tile(np.arange(30) % 3, 3))
    true = TrueArm().nests(poses, points.target)
    places = np.round(true + rng.normal(0.0, noise_mm, true.shape), digits)
    places[60 : 60 + copied] = places[:copied]
    return replace(rows, points=replace(points, place_mm=places))


@pytest.mark.parametrize(("digits", "noise_mm", "alike"), [(2, 0.007, 4), (3, 0.0005, 8), (6, 0.007, 0)])
def test_places_of_few_decimals_agree_by_chance(digits: int, noise_mm: float, alike: int) -> None:
    rows = visits(digits, noise_mm)
    first, second, third = rows.points.place_mm.reshape(3, 30, 3)
    again = [(one == other).all(axis=1) for one, other in ((first, second), (first, third), (second, third))]
    assert np.count_nonzero(again) == alike
    require_plausible(irb120(), rows)


@pytest.mark.parametrize(("digits", "noise_mm", "copied"), [(2, 0.007, 20), (4, 0.007, 2), (6, 0.04, 1)])
def test_copied_places_among_repeats_are_named(digits: int, noise_mm: float, copied: int) -> None:
    with pytest.raises(ImplausibleError, match="repeat others to the last digit"):
        require_plausible(irb120(), visits(digits, noise_mm, copied))


def test_poses_of_another_arm_are_refused() -> None:
    with pytest.raises(ImplausibleError, match="another arm, joints at other poses"):
        require_plausible(
            irb120(), joints(lambda q: random_poses(len(q), 2))(measured(random_poses(40, 1), 1))
        )


@pytest.mark.parametrize("seed", range(10))
def test_sound_measurements_pass(seed: int) -> None:
    rows = measured(random_poses(40, seed), seed)
    require_plausible(irb120(), rows)
    assert len(rows.points.pose) == 40
