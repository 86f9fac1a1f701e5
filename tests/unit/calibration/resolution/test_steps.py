"""Steps of staircases that are written down: measured, flagged, refused."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.moves import Moves, moves_of
from catseye.calibration.resolution.noise import LONGEST_S, standstill_before
from catseye.calibration.resolution.optics import AngularOptics
from catseye.calibration.resolution.plateaus import GUARD_S
from catseye.calibration.resolution.recording import Recording, recording_of
from catseye.calibration.resolution.same_run import require_same_run
from catseye.calibration.resolution.steps import Steps, steps
from tests.unit.calibration.resolution.staircase import DEG, STEPS_DEG, Bench

NOISE = 1e-5 * DEG
BENCH = Bench(noise=NOISE)
COMMAND = STEPS_DEG[:60] * DEG


def flagged(found: Steps, kind: str) -> tuple[int, ...]:
    return tuple(number for flag in found.flags if flag.kind == kind for number in flag.moves)


def staircase(done: Floats, command: Floats = COMMAND, bench: Bench = BENCH, seed: int = 1) -> Steps:
    moves = bench.moves(command)
    return steps(bench.recorded(moves, done, seed), moves)


def test_steps_are_measured_within_their_uncertainty() -> None:
    true = COMMAND * np.linspace(1.02, 0.7, 60)
    found = [staircase(true, seed=seed) for seed in range(10)]
    errors = np.array([(one.measured - true) / one.u for one in found])
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(1.0, abs=0.15)
    assert found[0].noise.step == pytest.approx(NOISE * math.sqrt(2.0 / 200.0), rel=0.35)
    assert found[0].flags == ()


def test_the_step_error_is_that_of_the_paper() -> None:
    quiet = staircase(COMMAND * 1.05, bench=replace(BENCH, noise=1e-9 * DEG))
    assert quiet.error_percent == pytest.approx(5.0, abs=1e-3)


def test_peaks_lie_in_the_middle_of_the_motion() -> None:
    found = staircase(COMMAND)
    assert found.peak_s[:30] == pytest.approx(found.moves.time_s[:30] + 0.4, abs=0.1)


def test_negative_moves_are_measured_alike() -> None:
    found = staircase(-0.9 * COMMAND, -COMMAND)
    assert found.error_percent[:30] == pytest.approx(-10.0, abs=0.5)


def test_a_stuck_step_is_measured_as_none_and_flagged() -> None:
    done = COMMAND.copy()
    done[20] = 0.0
    found = staircase(done)
    assert found.error_percent[20] == pytest.approx(-100.0, abs=1.0)
    assert flagged(found, "no-motion") == (21,)
    assert flagged(found, "merged") == ()


def test_two_moves_that_came_as_one_are_flagged() -> None:
    done = COMMAND.copy()
    done[21] += done[20]
    done[20] = 0.0
    assert flagged(staircase(done), "merged") == (21,)


def test_steps_that_end_too_early_are_flagged_to_the_end() -> None:
    done = np.where(np.arange(60) < 50, COMMAND, 0.0)
    found = staircase(done)
    assert flagged(found, "no-motion") == tuple(range(51, 61))
    assert any("fewer steps were driven" in flag.text for flag in found.flags)


def test_a_step_backwards_is_flagged() -> None:
    done = COMMAND.copy()
    done[30] *= -0.5
    assert flagged(staircase(done), "reversed") == (31,)


def test_steps_below_the_instrument_are_not_judged() -> None:
    found = staircase(STEPS_DEG * DEG, STEPS_DEG * DEG, replace(BENCH, noise=3e-4 * DEG))
    limit = 3.0 * found.noise.step
    assert found.judged.tolist() == (limit <= STEPS_DEG * DEG).tolist()
    assert 0 < len(flagged(found, "below-instrument")) < 109


def test_a_significant_drift_is_subtracted_and_flagged() -> None:
    found = staircase(COMMAND, bench=replace(BENCH, drift_per_s=1e-5 * DEG))
    assert [flag.kind for flag in found.flags] == ["drift"]
    assert np.abs(found.measured - COMMAND).max() < 4.0 * found.u.max()
    assert np.diff(found.position) == pytest.approx(found.measured)


def test_without_a_standstill_the_noise_is_that_of_plateaus() -> None:
    found = staircase(COMMAND, bench=replace(BENCH, lead_s=6.0))
    assert [flag.kind for flag in found.flags] == ["no-standstill"]
    assert found.noise.step == pytest.approx(NOISE * math.sqrt(2.0 / 200.0), rel=0.4)


@pytest.mark.parametrize("rate_hz", [100.0, 1000.0])
def test_white_noise_before_the_first_move_is_a_standstill(rate_hz: float) -> None:
    bench = Bench(rate_hz=rate_hz, noise=1e-8)
    moves = bench.moves(np.full(3, 1e-3))
    for seed in range(8):
        found = standstill_before(bench.recorded(moves, moves.command, seed), moves, GUARD_S)
        assert found is not None
        assert found.noise.size == pytest.approx(LONGEST_S * rate_hz, abs=1)


def test_noise_at_the_recordings_end_is_no_motion() -> None:
    bench = Bench(rate_hz=1000.0, noise=1e-8)
    moves = bench.moves(np.full(3, 1e-3))
    for seed in range(8):
        found = steps(bench.recorded(moves, np.array([1e-3, 1e-3, 0.0]), seed), moves)
        assert np.isnan(found.peak_s[-1])
        assert flagged(found, "no-motion") == (3,)
        assert not flagged(found, "late")


def test_a_run_in_before_the_first_move_is_no_standstill() -> None:
    moves = BENCH.moves(COMMAND)
    time_s, position = BENCH.samples(moves, COMMAND)
    position += 5.0 * DEG * np.clip((time_s - 10.0) / 20.0, 0.0, 1.0)
    found = steps(recording_of(time_s, position, "rad"), moves)
    assert found.noise.step == pytest.approx(NOISE * math.sqrt(2.0 / 200.0), rel=0.5)
    assert found.flags == ()


def test_a_step_that_comes_too_late_is_flagged() -> None:
    moves = BENCH.moves(COMMAND)
    late = replace(moves, time_s=np.where(np.arange(60) == 10, moves.time_s + 3.5, moves.time_s))
    assert flagged(steps(BENCH.recorded(late, COMMAND), moves), "late") == (11,)


@pytest.mark.parametrize("share", [-0.3, 0.15, 0.8])
def test_a_second_motion_in_one_dwell_is_flagged(share: float) -> None:
    moves = BENCH.moves(COMMAND)
    time_s, position = BENCH.samples(moves, COMMAND)
    position += share * COMMAND[20] * np.clip((time_s - moves.time_s[20] - 1.5) / 0.3, 0.0, 1.0)
    found = steps(recording_of(time_s, position, "rad"), moves)
    assert flagged(found, "unexpected-motion") == (21,)
    assert any("moved a second time before the next move" in flag.text for flag in found.flags)


def test_settling_is_no_second_motion() -> None:
    moves = BENCH.moves(COMMAND)
    time_s, position = BENCH.samples(moves, COMMAND)
    for at_s, size in zip(moves.time_s, COMMAND, strict=True):
        since_s = np.maximum(time_s - at_s - BENCH.motion_s, 0.0)
        position += 0.2 * size * np.exp(-3.0 * since_s) * np.sin(12.0 * since_s)
    assert flagged(steps(recording_of(time_s, position, "rad"), moves), "unexpected-motion") == ()


def test_motion_behind_the_last_listed_move_is_flagged() -> None:
    moves = BENCH.moves(COMMAND)
    fewer = moves_of(moves.time_s[:-3], COMMAND[:-3], "rad")
    (flag,) = steps(BENCH.recorded(moves, COMMAND), fewer).flags
    assert flag.kind == "unexpected-motion"
    assert "behind the last move, from 34" in flag.text
    assert "moves are missing from the list" in flag.text


def test_rest_behind_the_last_move_is_no_motion() -> None:
    moves = BENCH.moves(COMMAND)
    for seed in range(10):
        longer = replace(moves, time_s=moves.time_s + np.where(np.arange(60) == 59, 600.0, 0.0))
        done = np.where(np.arange(60) == 59, 0.0, COMMAND)
        fewer = moves_of(moves.time_s[:-1], COMMAND[:-1], "rad")
        assert steps(BENCH.recorded(longer, done, seed), fewer).flags == ()


def test_a_drift_is_no_motion_of_its_own() -> None:
    bench = replace(BENCH, drift_per_s=1e-3 * DEG)
    done = np.where(np.arange(60) < 50, COMMAND, 0.0)
    found = steps(bench.recorded(bench.moves(COMMAND), done), bench.moves(COMMAND[:50]))
    assert [flag.kind for flag in found.flags] == ["drift"]


def test_creep_behind_a_step_is_flagged() -> None:
    moves = BENCH.moves(COMMAND)
    time_s, position = BENCH.samples(moves, COMMAND)
    since = np.clip((time_s - moves.time_s[5]) / 5.0, 0.0, 1.0)
    found = steps(recording_of(time_s, position + 0.1 * COMMAND[5] * since, "rad"), moves)
    assert flagged(found, "unsettled") == (6,)


def test_optics_add_to_the_uncertainty() -> None:
    moves = BENCH.moves(COMMAND)
    found = steps(BENCH.recorded(moves, COMMAND), moves, optics=AngularOptics(30.0))
    assert found.u[0] == pytest.approx(2.02e-6, rel=0.01)
    assert found.u_scale == pytest.approx(0.001)


def without(moves: Moves, done: Floats, *gaps_s: tuple[float, float]) -> Recording:
    """Return a recording that lacks what lies between times."""
    time_s, position = BENCH.samples(moves, done)
    there = np.ones(time_s.size, dtype=np.bool_)
    for start_s, end_s in gaps_s:
        there &= (time_s < start_s) | (time_s >= end_s)
    return recording_of(time_s[there], position[there], "rad")


def test_a_gap_within_a_plateau_costs_only_samples() -> None:
    moves = BENCH.moves(COMMAND)
    whole, rest_s = staircase(COMMAND), float(moves.time_s[11])
    found = steps(without(moves, COMMAND, (rest_s - 1.75, rest_s - 0.75)), moves)
    others = np.delete(np.arange(60), [10, 11])
    assert found.measured[others] == pytest.approx(whole.measured[others], abs=1e-12)
    assert found.u[10:12] == pytest.approx(whole.u[10:12] * math.sqrt(1.5), rel=0.02)
    assert np.abs(found.measured[10:12] - COMMAND[10:12]).max() < 4.0 * found.u[10]
    assert flagged(found, "gap") == (11, 12)
    assert flagged(found, "missed") == ()


def test_a_gap_that_hides_a_move_is_flagged_as_missed() -> None:
    moves = BENCH.moves(COMMAND)
    at_s = float(moves.time_s[20])
    found = steps(without(moves, COMMAND, (at_s - 0.2, at_s + 1.5)), moves)
    assert flagged(found, "missed") == (21,)
    assert flagged(found, "no-motion") == ()
    assert np.isnan(found.peak_s[20])
    assert found.measured[20] == pytest.approx(COMMAND[20], abs=4.0 * found.u[20])


def test_moves_beside_a_lost_plateau_are_not_measured() -> None:
    moves = BENCH.moves(COMMAND)
    at_s = float(moves.time_s[20])
    found = steps(without(moves, COMMAND, (at_s - 3.0, at_s + 1.0)), moves)
    assert np.flatnonzero(np.isnan(found.measured)).tolist() == [19, 20]
    assert not found.judged[19:21].any()
    assert flagged(found, "missed")[:2] == (20, 21)


def test_a_polled_counter_with_lost_and_late_readings_is_evaluated() -> None:
    polled = Bench(rate_hz=25.0, noise=NOISE)
    moves = polled.moves(COMMAND)
    time_s, _ = polled.samples(moves, COMMAND)
    rng = np.random.default_rng(5)
    time_s = time_s + rng.exponential(0.004, time_s.size)
    asked_s = time_s[rng.random(time_s.size) > 0.05]
    share = np.clip((asked_s[:, None] - moves.time_s) / polled.motion_s, 0.0, 1.0)
    position = (0.5 - 0.5 * np.cos(np.pi * share)) @ COMMAND
    found = steps(recording_of(asked_s, position + rng.normal(0.0, NOISE, asked_s.size), "rad"), moves)
    errors = (found.measured - COMMAND) / found.u
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(1.0, abs=0.3)
    assert found.judged.all()
    assert {"gap", "irregular-sampling"} <= {flag.kind for flag in found.flags}


def test_a_recording_without_most_plateaus_is_refused() -> None:
    moves = BENCH.moves(COMMAND)
    gaps = [(float(at_s) - 2.3, float(at_s) - 0.2) for at_s in moves.time_s[:40]]
    with pytest.raises(MovesError, match="40 of 61 plateaus have no samples"):
        steps(without(moves, COMMAND, *gaps), moves)


def judge(recording: Recording, moves: Moves) -> Steps:
    found = steps(recording, moves)
    require_same_run(found, recording)
    return found


def errors_in_u(found: Steps, done: Floats) -> Floats:
    """Return how far each move is from the step that was really done at its time, in standard uncertainties."""
    return np.asarray(np.abs(found.measured - done) / found.u)


def cut(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording.clipped(0.0, 300.0), moves


def begun_late(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording.clipped(70.0, 1e4), moves


def of_other_times(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording, replace(moves, time_s=moves.time_s - 15.0)


def of_later_times(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording, Moves(moves.time_s[:-2] + 5.0, moves.command[:-2], moves.unit)


def without_the_beginning(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return of_later_times(recording.clipped(float(moves.time_s[0]) + 1.5, 1e4), moves)


def listed_too_late(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording.clipped(0.0, 1e4), replace(moves, time_s=moves.time_s + 0.5).part(0, 59)


def listed_too_early(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording, replace(moves, time_s=moves.time_s - 3.5)


def of_another_test(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording, replace(moves, command=10.0 * moves.command[::-1])


def without_a_beam(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return replace(recording, position=np.full_like(recording.position, 0.3)), moves


def in_inches(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return replace(recording, position=recording.position / 25.4), moves


def of_other_sign(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording, replace(moves, command=-moves.command)


def of_other_unit(recording: Recording, moves: Moves) -> tuple[Recording, Moves]:
    return recording, replace(moves, unit="mm")


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (cut, "ends at 299.99 s, but move 48 of 60.*cut off"),
        (begun_late, "begins at 70 s.*too late"),
        (of_other_times, "those commanded 3 moves earlier.*ahead by about 15 s"),
        (of_later_times, "those commanded 1 moves later.*behind by about 5 s"),
        (without_the_beginning, "those commanded 1 moves later"),
        (listed_too_late, r"motions begin about 0\.[56] s before they were commanded.*align the clocks"),
        (listed_too_early, r"or 3\.4 s behind the command before.*align the clocks"),
        (of_another_test, "show 0.0.* of what was commanded.*another run"),
        (without_a_beam, "show 0 of what was commanded.*saturated, or the beam was lost; align the optics"),
        (in_inches, r"show 0\.0394 of what was commanded.*inches were taken for mm; correct it"),
        (of_other_sign, "the direction is reversed"),
        (of_other_unit, "the recording holds angles, the moves are displacements: leave out the spacing"),
    ],
)
def test_moves_that_do_not_fit_are_refused(
    wrong: Callable[[Recording, Moves], tuple[Recording, Moves]], text: str
) -> None:
    moves = BENCH.moves(COMMAND)
    with pytest.raises(MovesError, match=text):
        judge(*wrong(BENCH.recorded(moves, COMMAND), moves))


def test_motions_that_reach_into_the_rest_are_refused() -> None:
    bench = replace(BENCH, motion_s=4.5)
    moves = bench.moves(COMMAND)
    moves = replace(moves, time_s=moves.time_s - 0.8)
    with pytest.raises(
        MovesError, match=r"of the 10 largest motions lie behind 2\.8 s of their dwell.*too short"
    ):
        judge(bench.recorded(bench.moves(COMMAND), COMMAND), moves)


@pytest.mark.parametrize("early_s", [-1.0, 0.0, 0.2])
@pytest.mark.parametrize("motion_s", [0.05, 0.8, 2.0])
def test_clocks_that_nearly_agree_are_accepted(early_s: float, motion_s: float) -> None:
    bench = replace(BENCH, motion_s=motion_s)
    moves = bench.moves(COMMAND)
    recording = bench.recorded(moves, COMMAND)
    found = judge(recording, replace(moves, time_s=moves.time_s + early_s).part(0, 59))
    # Each move keeps its own step: that of its neighbour is a fourteenth larger or smaller.
    assert np.abs(found.measured / COMMAND[:59] - 1.0).max() < 0.002


@pytest.mark.parametrize("factor", [0.9, 0.93, 1.07, 1.1])
def test_an_error_that_all_steps_share_is_no_shift(factor: float) -> None:
    moves = BENCH.moves(COMMAND)
    found = judge(BENCH.recorded(moves, factor * COMMAND), moves)
    # Each move keeps its own step: that of its neighbour is a fiftieth larger or smaller.
    assert errors_in_u(found, factor * COMMAND).max() < 5.0
    assert errors_in_u(found, factor * np.roll(COMMAND, 1)).max() > 5.0


THERE_AND_BACK = 1.7e-3 * np.tile(np.repeat([1.0, -1.0], 10), 2)


def test_reversals_that_cost_much_of_a_step_are_no_shift() -> None:
    done = THERE_AND_BACK.copy()
    done[::10] *= 0.85
    moves = BENCH.moves(THERE_AND_BACK)
    found = judge(BENCH.recorded(moves, done), moves)
    assert errors_in_u(found, done).max() < 5.0
    assert found.error_percent[::10] == pytest.approx(-15.0, abs=1.0)


@pytest.mark.parametrize(("late_s", "text"), [(-5.0, "1 moves earlier"), (5.0, "1 moves later")])
def test_a_dwell_too_early_is_seen_through_scatter(late_s: float, text: str) -> None:
    """Steps that scatter by 3 % hide the 7 % from one to the next in ten steps, not in forty."""
    command = STEPS_DEG[:60] * DEG
    moves = BENCH.moves(command)
    listed = Moves(moves.time_s[:-1] + late_s, command[:-1], "rad")
    for seed in range(12):
        done = command * (1.0 + np.random.default_rng(seed).normal(0.0, 0.03, command.size))
        with pytest.raises(MovesError, match=f"those commanded {text}"):
            judge(BENCH.recorded(moves, done), listed)


def test_equal_steps_of_other_times_are_refused() -> None:
    moves = BENCH.moves(THERE_AND_BACK)
    with pytest.raises(MovesError, match="those commanded 3 moves earlier"):
        judge(*of_other_times(BENCH.recorded(moves, THERE_AND_BACK), moves))


@pytest.mark.parametrize(
    ("time_s", "command", "text"),
    [
        ([0.0, 5.0, 5.0], [1.0, 1.0, 1.0], "move 3 at 5 s does not follow"),
        ([0.0], [1.0], "1 move"),
        ([0.0, 5.0], [1.0, np.nan], "move 2 has no time or no size"),
        ([0.0, 5.0], [1.0, 0.0], "move 2 is 0"),
        ([0.0, 5.0], [1.0], "command"),
    ],
)
def test_moves_without_meaning_are_refused(time_s: list[float], command: list[float], text: str) -> None:
    with pytest.raises(CalibrationError, match=text):
        moves_of(np.array(time_s), np.array(command), "rad")


def test_moves_too_close_for_a_plateau_are_refused() -> None:
    hasty = Bench(rate_hz=20.0, dwell_s=0.4, motion_s=0.1)
    moves = hasty.moves(np.full(5, 1e-3))
    with pytest.raises(MovesError, match="dwell longer"):
        steps(hasty.recorded(moves, moves.command), moves)


def test_steps_that_hold_unlisted_moves_are_not_judged() -> None:
    command = STEPS_DEG[:30] * DEG
    recording = BENCH.recorded(BENCH.moves(command), command)
    listed = [number for number in range(30) if not 10 <= number < 13]
    moves = moves_of(BENCH.moves(command).time_s[listed], command[listed], "rad")
    found = steps(recording, moves)
    assert flagged(found, "unexpected-motion") == (10,)
    assert not found.judged[9]
    assert found.judged.sum() == len(listed) - 1


def test_a_hold_between_two_moves_is_no_motion_of_others() -> None:
    command = STEPS_DEG[:30] * DEG
    moves = BENCH.moves(command)
    later = moves_of(moves.time_s + np.where(np.arange(30) > 12, 20.0, 0.0), command, "rad")
    assert flagged(steps(BENCH.recorded(later, command), later), "unexpected-motion") == ()
