"""The beam on its mount: miss and length of a beam that is beside, tilted or too high, and its screws."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.simulators.config import ErrorBudget, Screws
from catseye.simulators.errors import BenchError
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.mount import Mount, Screw
from tests.unit.simulators.benches import QUIET, go, quiet_bench

EXACT = replace(QUIET, screws=Screws(setting_turns=0.0, play_turns=0.0))
DRAWN = replace(QUIET, beam_offset_mm=None, beam_pitch_mrad=None)

# The straight arm along +X stands at 550 mm and looks at P2, at 680 mm.
D_MM = 130.0


def test_a_tilted_beam_misses_and_shortens_by_the_cosine() -> None:
    bench = quiet_bench(replace(QUIET, beam_pitch_mrad=5.0))
    insight = bench.true_state()
    assert insight.miss_mm == pytest.approx(0.65, abs=1e-5)
    assert insight.length_mm == pytest.approx(D_MM - 130.0 * 0.005**2 / 2.0, abs=1e-7)


def test_the_miss_of_a_tilted_beam_grows_with_the_distance() -> None:
    bench = quiet_bench(replace(QUIET, beam_pitch_mrad=-1.0))
    go(bench, (60.0, -120.0, 0.0, 60.0))
    # 325 cos 60 + 225 cos -60 = 275 mm and 325 sin 60 - 225 sin 60 = 86.6 mm: turn back to P2 at J1 + J2 + J4.
    way = complex(680.0 - 275.0, -100.0 * math.sin(math.radians(60.0)))
    go(bench, (60.0, -120.0, 0.0, 60.0 + math.degrees(math.atan2(way.imag, way.real))))
    assert bench.true_state().miss_mm == pytest.approx(1e-3 * abs(way), rel=1e-5)


def test_height_and_tilt_combine_with_the_lateral_miss() -> None:
    bench = quiet_bench(replace(QUIET, beam_pitch_mrad=5.0, beam_height_mm=10.0, beam_offset_mm=0.3))
    for j3_mm, above_mm in ((10.0, 0.65), (9.35, 0.0), (9.0, -0.35), (10.2, 0.85)):
        go(bench, (0.0, 0.0, j3_mm, 0.0))
        assert bench.true_state().miss_mm == pytest.approx(math.hypot(above_mm, 0.3), abs=1e-4)
    # A lift by 1 mm shortens a beam that rises by 5 mrad by 5 µm.
    high_mm = bench.true_state().length_mm
    go(bench, (0.0, 0.0, 9.2, 0.0))
    assert high_mm - bench.true_state().length_mm == pytest.approx(-0.005, abs=1e-6)


def test_a_screw_loses_its_play_at_each_reversal() -> None:
    screw = Screw(np.random.default_rng(0), setting_turns=0.0, play_turns=0.02)
    moved = [screw.turn(turns) for turns in (1.0, -1.0, -1.0, 0.01, 1.0, 0.5)]
    assert moved == pytest.approx([1.0, -0.98, -1.0, 0.0, 0.99, 0.5])
    assert screw.turns == pytest.approx(0.51)


def test_a_hand_sets_a_turn_to_a_fiftieth() -> None:
    screw = Screw(np.random.default_rng(0), setting_turns=0.02, play_turns=0.0)
    turns = np.array([screw.turn(1.0) for _ in range(4000)])
    assert np.mean(turns) == pytest.approx(1.0, abs=0.002)
    # 4000 draws: the standard deviation is known to 1.1 %.
    assert np.std(turns) == pytest.approx(0.02, rel=0.04)
    assert screw.turn(0.0) == 0.0


def test_the_stage_shifts_the_beam_without_changing_length() -> None:
    bench = quiet_bench(EXACT)
    assert bench.beam.zero()
    bench.beam.turn_screw("stage", 1.5)
    assert bench.beam.mount.offset_mm == pytest.approx(0.75)
    assert bench.true_state().miss_mm == pytest.approx(0.75)
    assert bench.beam.read().displacement_mm == pytest.approx(0.0, abs=1e-9)
    assert not bench.beam.read().beam_lost
    bench.beam.turn_screw("stage", 0.6)
    assert bench.true_state().miss_mm == pytest.approx(1.05)
    assert bench.beam.read().beam_lost


def test_the_level_screw_tilts_until_the_beam_is_lost() -> None:
    bench = quiet_bench(EXACT)
    assert bench.beam.zero()
    bench.beam.turn_screw("level", 2.5)
    # 5 mrad up, and 40 mm in front of the pivot the beam is 0.2 mm higher.
    assert 1e3 * bench.beam.mount.pitch_rad == pytest.approx(5.0)
    assert bench.true_state().miss_mm == pytest.approx(0.85, abs=1e-5)
    assert bench.beam.read().displacement_mm == pytest.approx(-130.0 * 0.005**2 / 2.0 - 0.2 * 0.005, abs=1e-7)
    assert not bench.beam.read().beam_lost
    # 7 mrad · 130 mm + 0.28 mm = 1.19 mm.
    bench.beam.turn_screw("level", 1.0)
    assert not bench.beam.read().returns
    assert bench.beam.read().beam_lost


def test_a_mount_turned_round_acts_the_other_way() -> None:
    bench = quiet_bench(replace(EXACT, screws=EXACT.screws.reversed()))
    bench.beam.turn_screw("stage", 1.0)
    bench.beam.turn_screw("level", 0.1)
    assert bench.beam.mount.offset_mm == pytest.approx(-0.5)
    assert 1e3 * bench.beam.mount.pitch_rad == pytest.approx(-0.2)


def test_there_are_two_screws() -> None:
    with pytest.raises(BenchError, match="'knob'; there are stage, level"):
        quiet_bench().beam.turn_screw("knob", 1.0)


def test_a_good_alignment_leaves_little() -> None:
    mounts = [Mount(replace(DRAWN, seed=seed), 0.0) for seed in range(500)]
    assert np.std([mount.offset_mm for mount in mounts]) == pytest.approx(0.1, rel=0.12)
    assert 1e3 * np.std([mount.pitch_rad for mount in mounts]) == pytest.approx(0.05, rel=0.12)
    assert {mount.height_mm for mount in mounts} == {QUIET.start_joints[2]}


def test_an_unaligned_beam_has_offset_pitch_and_height_errors() -> None:
    mounts = [Mount(replace(DRAWN, seed=seed, unaligned=True), 0.0) for seed in range(200)]
    offsets = np.array([mount.offset_mm for mount in mounts])
    pitches = 1e3 * np.array([mount.pitch_rad for mount in mounts])
    heights = np.array([mount.height_mm for mount in mounts])
    assert 0.4 <= np.abs(offsets).min() < 0.42 < 0.88 < np.abs(offsets).max() <= 0.9
    assert 0.6 <= np.abs(pitches).min() < 0.64 < 1.46 < np.abs(pitches).max() <= 1.5
    assert -1.5 <= heights.min() < -1.4 < 1.4 < heights.max() <= 1.5
    # All four quarters are met.
    assert {(a > 0, b > 0) for a, b in zip(offsets, pitches, strict=True)} == {
        (False, False),
        (False, True),
        (True, False),
        (True, True),
    }


SCATTERING = replace(QUIET, budget=replace(ErrorBudget.none(), repeatability_um=10.0))


def axis(bench: Bench) -> tuple[float, float]:
    return bench.true_state().axis_mm


def test_turning_j4_or_lifting_draws_no_new_arrival() -> None:
    bench = quiet_bench(SCATTERING)
    go(bench, (0.001, 0.0, 0.0, 0.0))
    here = axis(bench)
    for target in ((0.001, 0.0, 0.0, 0.05), (0.001, 0.0, 5.0, 0.05), (0.001, 0.0, 0.0, -30.0)):
        go(bench, target)
        assert axis(bench) == pytest.approx(here, abs=1e-12)


@pytest.mark.parametrize("joint", [0, 1])
def test_any_travel_of_j1_or_j2_draws_a_new_arrival(joint: int) -> None:
    bench = quiet_bench(SCATTERING)
    places = []
    for turn in range(400):
        target = [0.0, 0.0, 0.0, 0.0]
        target[joint] = 1e-7 * (turn % 2)
        go(bench, (target[0], target[1], target[2], target[3]))
        places.append(complex(*axis(bench)) - 550.0)
    assert np.std(np.real(places)) == pytest.approx(0.010, rel=0.12)
    assert abs(np.corrcoef(np.imag(places)[:-1], np.imag(places)[1:])[0, 1]) < 0.15


def test_the_offset_slope_is_unaffected_by_robot_scatter() -> None:
    bench = quiet_bench(replace(SCATTERING, beam_offset_mm=0.05))
    x_mm, y_mm = axis(bench)
    # The beam meets P2 when it is turned by what the offset and the place of the axis ask for.
    centred = math.atan2(-y_mm, 680.0 - x_mm) - math.asin(0.05 / math.hypot(680.0 - x_mm, y_mm))
    lengths = []
    for turn in (-2e-3, 2e-3):
        go(bench, (0.0, 0.0, 0.0, math.degrees(centred + turn)))
        lengths.append(bench.true_state().length_mm)
    # One new arrival, of 10 µm, between the two would be 2.5 mm/rad.
    assert (lengths[1] - lengths[0]) / 4e-3 == pytest.approx(0.05, rel=1e-3)


def test_a_stream_draws_one_arrival_at_first_travel() -> None:
    bench = quiet_bench(SCATTERING)
    start = axis(bench)
    for k in range(1, 6):
        bench.glide((0.0, 0.0, 0.0, 0.01 * k), 0.007)
        bench.advance(0.007)
    assert axis(bench) == pytest.approx(start, abs=1e-12)
    seen = []
    for k in range(1, 6):
        bench.glide((1e-6 * k, 0.0, 0.0, 0.05), 0.007)
        bench.advance(0.007)
        seen.append(axis(bench))
    assert abs(complex(*seen[0]) - complex(*start)) > 1e-4
    assert np.array(seen) == pytest.approx(np.array([seen[0]] * 5), abs=1e-4)
