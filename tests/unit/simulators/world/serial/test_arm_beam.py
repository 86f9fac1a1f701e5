"""Angular and linear optics on a KR 210: what they show of its motion, and when they lose the beam."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.simulators.config import ArmOptics, EmulationConfig, ErrorBudget
from catseye.simulators.errors import BenchError
from catseye.simulators.world.optics import NOBODY
from catseye.simulators.world.serial.arm_beam import ArmBeam
from catseye.simulators.world.serial.driven_arm import DrivenArm
from catseye.simulators.world.serial.truth import draw_joint_truth
from tests.unit.simulators.world.serial.arms import TOOL, serial_arm

ARM = serial_arm("kr210-r2700", TOOL)
TRUTHS = draw_joint_truth(ARM, 3).joints
START = (0.0, -90.0, 90.0, 0.0, 0.0, 0.0)
STILL = ArmOptics(tripod_urad=0.0, tripod_um=0.0, turbulence_nm=0.0, noise_nm=0.0, resolution_nm=0.0)
PERFECT = replace(STILL, u_spacing_mm=0.0, hand_tilt_mrad=0.0)


class Stand:
    """An arm with optics on bench time that the test sets."""

    def __init__(self, optics: ArmOptics = PERFECT, seed: int = 1) -> None:
        self.time_s = 0.0
        config = EmulationConfig(reflectors=(), seed=seed, budget=ErrorBudget.none(), arm_optics=optics)
        self.arm = DrivenArm(ARM, TRUTHS, START, seed)
        self.beam = ArmBeam(self.arm, config, lambda _time_s: 1.00027, lambda: self.time_s)

    def go(self, pose: tuple[float, ...], wait_s: float = 60.0, speed_fraction: float = 0.1) -> None:
        self.beam.observe()
        self.arm.move_to(pose, self.time_s, speed_fraction)
        self.beam.plan_looks()
        self.beam.observe_until(self.time_s + wait_s)
        self.time_s += wait_s

    def shift(self, joint: int, by_deg: float) -> None:
        self.go(tuple(value + by_deg * (k == joint) for k, value in enumerate(self.arm.motion.end)))

    def angle_deg(self, spacing_mm: float = 30.0) -> float:
        return float(np.rad2deg(np.arcsin(self.beam.read().displacement_mm / spacing_mm)))

    def turned_deg(self, joint: int, before: tuple[float, ...]) -> float:
        return self.arm.true_joints(self.time_s)[joint] - before[joint]

    def level(self) -> float:
        return self.beam.read().level


def on_joint(joint: int, optics: ArmOptics = PERFECT, offset_mm: float = 0.0) -> Stand:
    stand = Stand(optics)
    stand.beam.mount_angular(joint + 1, offset_mm=offset_mm)
    assert stand.beam.zero()
    return stand


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("by_deg", [3.0, -5.0])
def test_angular_optics_show_the_turn_of_their_joint(joint: int, by_deg: float) -> None:
    stand = on_joint(joint)
    before = stand.arm.true_joints(stand.time_s)
    stand.shift(joint, by_deg)
    shown_deg = abs(stand.angle_deg())
    # Links before the joint give way a little under the shifted weight: the optics see that too.
    assert shown_deg == pytest.approx(abs(stand.turned_deg(joint, before)), abs=2e-3)


def test_angular_optics_count_as_the_joint_does() -> None:
    for joint in (0, 1):
        stand = on_joint(joint)
        stand.shift(joint, 1.0)
        assert stand.angle_deg() > 0.9


def test_true_spacing_differs_from_the_nominal_within_its_uncertainty() -> None:
    spacings = [Stand(ArmOptics(), seed).beam.spacing_mm for seed in range(200)]
    assert np.mean(spacings) == pytest.approx(30.0, abs=0.003)
    assert np.std(spacings) == pytest.approx(0.01, rel=0.2)


def test_a_joint_that_carries_nothing_shows_nothing() -> None:
    stand = on_joint(1)
    stand.shift(5, 20.0)
    assert stand.angle_deg() == pytest.approx(0.0, abs=1e-4)


def test_another_joint_below_shows_in_the_angle() -> None:
    stand = on_joint(2)
    stand.shift(1, 0.5)
    assert stand.angle_deg() == pytest.approx(0.5, abs=0.05)


def test_signal_falls_with_the_angle_until_the_beam_is_lost() -> None:
    stand = on_joint(0)
    levels = []
    for _ in range(4):
        stand.shift(0, 2.0)
        levels.append(stand.level())
    assert levels == sorted(levels, reverse=True)
    assert not stand.beam.read().beam_lost
    stand.shift(0, 4.0)
    assert not stand.beam.read().returns
    assert stand.beam.read().beam_lost
    stand.shift(0, -8.0)
    # The beam is back, and its count is worth nothing until it is zeroed.
    assert stand.beam.read().returns
    assert stand.beam.read().beam_lost


@pytest.mark.parametrize(("offset_mm", "kept_deg", "lost_deg"), [(28.0, 4.5, 8.0), (200.0, 0.5, 1.5)])
def test_a_retroreflector_beside_its_plane_loses_the_beam_early(
    offset_mm: float, kept_deg: float, lost_deg: float
) -> None:
    stand = on_joint(1, offset_mm=offset_mm)
    stand.shift(1, kept_deg)
    assert not stand.beam.read().beam_lost
    stand.shift(1, lost_deg - kept_deg)
    assert stand.beam.read().beam_lost


def test_screws_lead_a_misaligned_beam_to_the_full_signal() -> None:
    stand = on_joint(0, replace(PERFECT, hand_tilt_mrad=2.0))
    levels = [stand.level()]
    for screw in ("pitch", "yaw"):
        trials = {}
        for turns in (-0.25,) * 12 + (0.25,) * 24:
            stand.beam.turn_screw(screw, turns)
            trials[stand.level()] = stand.beam.screws[screw].turns
        stand.beam.turn_screw(screw, trials[max(trials)] - stand.beam.screws[screw].turns)
        levels.append(stand.level())
    assert levels[0] < 0.9 < levels[-1]


def test_a_tilted_beam_shortens_the_angle_by_its_cosine() -> None:
    straight, aslant = on_joint(0), on_joint(0)
    aslant.beam.turn_screw("pitch", 3.0)
    assert aslant.beam.zero()
    for stand in (straight, aslant):
        stand.shift(0, 3.0)
    ratio = aslant.beam.read().displacement_mm / straight.beam.read().displacement_mm
    assert ratio == pytest.approx(np.cos(3e-3), abs=1e-7)


def test_there_is_no_screw_of_another_name() -> None:
    with pytest.raises(BenchError, match="no screw 'stage'; there are pitch, yaw"):
        Stand().beam.turn_screw("stage", 1.0)


def test_nothing_returns_before_anything_is_mounted() -> None:
    stand = Stand()
    assert not stand.beam.read().returns
    assert not stand.beam.zero()


@pytest.mark.parametrize(("direction", "sense"), [((1.0, 0.0, 0.0), 1.0), ((-1.0, 0.0, 0.0), -1.0)])
def test_linear_optics_show_the_way_along_their_axis(
    direction: tuple[float, float, float], sense: float
) -> None:
    stand = Stand()
    stand.beam.mount_linear(direction)
    assert stand.beam.zero()
    before = stand.arm.screws.frames(np.array([stand.arm.true_joints(stand.time_s)]))[0, -1, 0, 3]
    stand.shift(1, 0.1)
    after = stand.arm.screws.frames(np.array([stand.arm.true_joints(stand.time_s)]))[0, -1, 0, 3]
    assert abs(after - before) > 0.5
    assert stand.beam.read().displacement_mm == pytest.approx(sense * (after - before), abs=1e-9)


def test_a_way_across_the_beam_walks_it_off() -> None:
    stand = Stand()
    stand.beam.mount_linear((1.0, 0.0, 0.0))
    assert stand.beam.zero()
    # 1765 mm of reach: 0.1° are 3.1 mm across.
    stand.shift(0, 0.05)
    assert not stand.beam.read().beam_lost
    stand.shift(0, 0.1)
    assert stand.beam.read().beam_lost


def test_a_dead_path_carries_the_change_of_the_air() -> None:
    stand = Stand()
    index = [1.00027]
    config = EmulationConfig(reflectors=(), budget=ErrorBudget.none(), arm_optics=PERFECT)
    beam = ArmBeam(stand.arm, config, lambda _time_s: index[0], lambda: stand.time_s)
    beam.mount_linear((1.0, 0.0, 0.0))
    assert beam.zero()
    index[0] += 1e-6
    # 250 mm of dead path, 1 ppm.
    assert beam.read().vacuum_mm == pytest.approx(250e-6, rel=0.01)


def test_a_minute_of_standstill_shows_noise_and_drift() -> None:
    stand = on_joint(0, ArmOptics())
    stand.time_s = 30.0
    shown = []
    for _ in range(6000):
        stand.time_s += 0.01
        shown.append(stand.beam.read().displacement_mm)
    minute = np.array(shown)
    white_nm = 1e6 * np.std(np.diff(minute)) / np.sqrt(2.0)
    means_nm = 1e6 * minute.reshape(60, 100).mean(axis=1)
    assert white_nm == pytest.approx(2.0, rel=0.2)
    # Means of a hundred readings would scatter by 0.2 nm if that were all.
    assert 0.5 < np.std(means_nm) < 50.0


def test_looks_do_not_depend_on_each_other() -> None:
    stand = on_joint(4, ArmOptics())
    stand.shift(4, 0.5)
    times_s = np.linspace(0.0, 60.0, 301)
    single = [float(stand.beam.look(np.array([t])).length_mm[0]) for t in times_s]
    np.testing.assert_allclose(stand.beam.look(times_s).length_mm, single, rtol=0.0, atol=1e-12)
    assert np.all(stand.beam.look(times_s).index != NOBODY)


def test_remounting_breaks_the_beam() -> None:
    stand = on_joint(0)
    stand.beam.mount_angular(1)
    assert stand.beam.read().beam_lost
    assert stand.beam.read().returns
