"""Equal steps forth, back and forth, of a joint with play, friction and noise that are written down."""

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.iso import IsoAmplitude, iso_amplitude, iso_test
from tests.unit.calibration.resolution.measured import measured_steps

U_STEP = 1e-6
SEQUENCES = np.repeat([1.0, -1.0, 1.0], 10)


def with_play(command: Floats, play: float, seed: int = 1) -> Floats:
    """Return where a link behind a play stands on the plateaus; it was run in forwards."""
    motor = np.concatenate([[0.0], np.cumsum(command)])
    link = np.empty(motor.size)
    link[0] = -0.5 * play
    for k in range(1, motor.size):
        link[k] = min(max(link[k - 1], motor[k] - 0.5 * play), motor[k] + 0.5 * play)
    return link + np.random.default_rng(seed).normal(0.0, U_STEP / np.sqrt(2.0), motor.size)


def amplitude(size: float, play: float) -> IsoAmplitude:
    command = size * SEQUENCES
    return iso_amplitude(measured_steps(command, with_play(command, play), U_STEP))


def test_without_play_all_steps_are_distinguishable() -> None:
    found = amplitude(2e-5, 0.0)
    assert found.passed
    assert not found.masked.any()
    assert found.sequence.tolist() == [0] * 10 + [1] * 10 + [2] * 10
    assert found.amplitude == pytest.approx(2e-5)


def test_steps_taken_up_by_play_are_masked_and_named() -> None:
    # 3.5 steps of play: three steps behind each reversal do nothing, the fourth half.
    found = amplitude(2e-5, 7e-5)
    assert not found.passed
    assert found.passed_between_reversals
    assert np.flatnonzero(found.masked).tolist() == [10, 11, 12, 20, 21, 22]
    (flag,) = found.flags
    assert (flag.kind, flag.moves) == ("masked-by-reversal", (11, 12, 13, 21, 22, 23))


def test_steps_in_the_noise_are_not_distinguishable() -> None:
    found = amplitude(1e-6, 0.0)
    assert not found.passed
    assert not found.passed_between_reversals


def test_a_joint_that_stays_in_its_play_passes_nothing() -> None:
    assert not amplitude(2e-5, 1.0).passed_between_reversals


def test_reversals_mask_the_least_step() -> None:
    found = iso_test([amplitude(size, 7e-5) for size in (2e-4, 1e-6, 2e-5, 5e-5, 1e-4)])
    assert found.least_step == pytest.approx(1e-4)
    assert found.not_below == pytest.approx(5e-5)
    assert found.between_reversals == pytest.approx(2e-5)
    assert [flag.kind for flag in found.flags] == ["masked-by-reversal"]


def test_a_larger_size_that_fails_ends_the_search() -> None:
    bad = amplitude(1e-4, 7e-4)
    found = iso_test([amplitude(5e-5, 0.0), bad, amplitude(2e-4, 0.0)])
    assert found.least_step == pytest.approx(2e-4)


def test_a_search_that_ends_nowhere_is_flagged() -> None:
    none, smallest = iso_test([amplitude(1e-6, 0.0)]), iso_test([amplitude(1e-4, 0.0)])
    assert none.least_step is None
    assert "go on with larger ones" in none.flags[0].text
    assert smallest.least_step == pytest.approx(1e-4)
    assert "at most that" in smallest.flags[0].text


@pytest.mark.parametrize(
    ("command", "factor", "text"),
    [
        (2e-5 * SEQUENCES[:20], 1.0, "the moves make 2 sequences"),
        (2e-5 * SEQUENCES * np.linspace(1.0, 2.0, 30), 1.0, "move 2 is .* steps of one size"),
        (2e-5 * SEQUENCES, -1.0, "go the other way"),
    ],
)
def test_other_moves_are_refused(command: Floats, factor: float, text: str) -> None:
    with pytest.raises(MovesError, match=text):
        iso_amplitude(measured_steps(command, factor * with_play(command, 0.0), U_STEP))


@pytest.mark.parametrize("lost", [9, 15, 29])
def test_a_sequence_that_lacks_a_move_is_refused(lost: int) -> None:
    command = 2e-4 * np.delete(SEQUENCES, lost)
    with pytest.raises(MovesError, match=r"have .*9.* moves, .*complete the list of moves") as refused:
        iso_amplitude(measured_steps(command, with_play(command, 0.0), U_STEP))
    assert refused.value.row == {9: 9, 15: 19, 29: 29}[lost]


@pytest.mark.parametrize(("factor", "named"), [(2.0 / 3.0, "0.667 times"), (2.0, "half of the real one")])
def test_steps_in_a_wrong_scale_are_flagged(factor: float, named: str) -> None:
    commands = [size * SEQUENCES for size in (1e-4, 3e-4)]
    one = iso_test(
        [
            iso_amplitude(measured_steps(command, factor * with_play(command, 5e-5), U_STEP))
            for command in commands
        ]
    )
    (flag,) = [flag for flag in one.flags if flag.kind == "scale"]
    assert named in flag.text
    assert f"are {factor:.3g} times those commanded" in flag.text


def test_sequences_of_one_move_say_nothing_about_the_scale() -> None:
    command = 2e-4 * np.array([1.0, -1.0, 1.0])
    found = iso_test([iso_amplitude(measured_steps(command, 2.0 * with_play(command, 0.0), U_STEP))])
    assert "scale" not in {flag.kind for flag in found.flags}


@pytest.mark.parametrize("play", [0.0, 2e-5, 7e-5, 2e-4])
def test_play_is_no_wrong_scale(play: float) -> None:
    found = iso_test([amplitude(size, play) for size in (1e-4, 2e-5)])
    assert "scale" not in {flag.kind for flag in found.flags}


def test_no_size_and_one_size_twice_are_refused() -> None:
    with pytest.raises(MovesError, match="no size"):
        iso_test([])
    with pytest.raises(MovesError, match="tested twice"):
        iso_test([amplitude(1e-4, 0.0), amplitude(1e-4, 0.0)])
