"""Lost motion of joints whose play, drift and noise are written down."""

import numpy as np
import pytest

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.backlash import Backlash, backlash
from catseye.calibration.resolution.errors import MovesError, RecordingError
from catseye.calibration.resolution.flags import doubts
from tests.unit.calibration.resolution.measured import DWELL_S, measured_steps

STEP = 1.7e-3
COMMAND = STEP * np.tile(np.repeat([1.0, -1.0], 10), 5)
PLAY = 8.7e-5
NOISE = 5e-6


def places(seed: int, drift_per_s: float = 0.0, command: Floats = COMMAND) -> Floats:
    """Return where the link stands on the plateaus: behind the motor by half the play, in the last direction."""
    motor = np.concatenate([[0.0], np.cumsum(command)])
    sense = np.concatenate([[-1.0], np.sign(command)])
    drift = drift_per_s * DWELL_S * np.arange(motor.size)
    noise = np.random.default_rng(seed).normal(0.0, NOISE, motor.size)
    return np.asarray(motor - 0.5 * PLAY * sense + drift + noise)


def carried_on(shared: float, seed: int) -> Floats:
    """Return what each position takes over from the one before in its sequence, ten times the noise of the rest."""
    rng = np.random.default_rng([seed, 1])
    left = np.zeros((10, 10))
    left[:, 0] = rng.normal(size=10)
    for k in range(1, 10):
        left[:, k] = shared * left[:, k - 1] + np.sqrt(1.0 - shared**2) * rng.normal(size=10)
    return 10.0 * NOISE * np.concatenate([[0.0], left.ravel()])


def found(seed: int = 1, drift_per_s: float = 0.0, torque: tuple[Floats, Floats] | None = None) -> Backlash:
    steps = measured_steps(COMMAND, places(seed, drift_per_s), NOISE)
    return backlash(steps, *torque) if torque else backlash(steps)


def traced(forward_nm: float, backward_nm: float, noise_nm: float, seed: int = 1) -> tuple[Floats, Floats]:
    """Return a torque every 12 ms that follows the direction of the last move."""
    time_s = np.arange(0.0, 100.0 + DWELL_S * (COMMAND.size + 1.0), 0.012)
    move = np.clip((time_s - 100.0) // DWELL_S, 0, COMMAND.size - 1).astype(np.int64)
    mean = np.where(COMMAND[move] > 0.0, forward_nm, backward_nm)
    return time_s, np.asarray(mean + np.random.default_rng(seed).normal(0.0, noise_nm, time_s.size))


@pytest.mark.parametrize("torque_nm", [0.0, 5.3])
def test_a_torque_that_does_not_change_has_no_other_clock(torque_nm: float) -> None:
    one = found(torque=traced(torque_nm, torque_nm, 0.0))
    assert one.valid is False
    assert [flag.kind for flag in one.flags] == ["torque"]


@pytest.mark.parametrize("drift_per_s", [0.0, 2e-7])
def test_lost_motion_is_found_within_its_uncertainty(drift_per_s: float) -> None:
    many = [found(seed, drift_per_s) for seed in range(100)]
    z = [(one.lost_motion - PLAY) / one.u for one in many]
    assert np.sqrt(np.mean(np.square(z))) == pytest.approx(1.0, abs=0.15)
    # The mean over nine places of the difference of two means of five.
    assert np.mean([one.u for one in many]) == pytest.approx(NOISE * np.sqrt(2.0 / 45.0), rel=0.05)


@pytest.mark.parametrize("shared", [0.2, 0.4])
def test_neighbours_that_are_alike_make_it_less_certain(shared: float) -> None:
    z = []
    for seed in range(200):
        left = carried_on(shared, seed)
        one = backlash(measured_steps(COMMAND, places(seed) + left, NOISE))
        z.append((one.lost_motion - PLAY) / one.u)
    assert np.sqrt(np.mean(np.square(z))) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(
    ("factor", "text"),
    [
        (2.0 / 3.0, "are 0.667 times those commanded.*the real one is 0.667 times the stated one"),
        (2.0, "are 2 times those commanded.*the stated spacing is half of the real one"),
        (1.25, "are 1.25 times those commanded.*moves of another run; correct it"),
    ],
)
def test_steps_in_a_wrong_scale_are_refused(factor: float, text: str) -> None:
    with pytest.raises(MovesError, match=text):
        backlash(measured_steps(COMMAND, factor * places(1), NOISE))


def test_play_of_a_third_of_a_step_is_no_scale() -> None:
    motor = np.concatenate([[0.0], np.cumsum(COMMAND)])
    sense = np.concatenate([[-1.0], np.sign(COMMAND)])
    one = backlash(measured_steps(COMMAND, motor - STEP / 6.0 * sense, NOISE))
    assert one.lost_motion == pytest.approx(STEP / 3.0)


def test_nine_interior_positions_count() -> None:
    one = found()
    assert one.place == pytest.approx(STEP * np.arange(1.0, 10.0))
    assert one.reversal == pytest.approx(PLAY, abs=4.0 * NOISE * np.sqrt(0.4))
    assert one.lost_motion == pytest.approx(one.reversal.mean())


def test_only_a_significant_drift_is_flagged() -> None:
    assert [flag.kind for flag in found(1, 2e-7).flags] == ["drift", "torque"]
    assert sum(len(found(seed).flags) > 1 for seed in range(100)) <= 5


def test_preliminary_steps_to_the_middle_do_no_harm() -> None:
    command = np.concatenate([np.full(5, -STEP), COMMAND])
    one = backlash(measured_steps(command, places(1, 0.0, command), NOISE))
    assert one.place == pytest.approx(STEP * np.arange(-4.0, 5.0))
    assert one.lost_motion == pytest.approx(PLAY, abs=4.0 * one.u)


def test_a_torque_that_changes_its_sign_makes_it_valid() -> None:
    one = found(torque=traced(0.8, -0.5, 0.4))
    assert one.valid is True
    assert one.torque is not None
    assert one.torque.forward_nm == pytest.approx(0.8, abs=4.0 * one.torque.u_forward_nm)
    assert one.torque.backward_nm == pytest.approx(-0.5, abs=4.0 * one.torque.u_backward_nm)
    assert one.flags == ()


def test_without_a_change_of_sign_it_is_never_valid() -> None:
    for seed in range(50):
        one = found(torque=traced(0.8, 0.01, 0.4, seed))
        assert one.valid is False
        assert [flag.kind for flag in one.flags] == ["torque"]


def test_a_torque_in_its_noise_seldom_changes_sign() -> None:
    assert sum(bool(found(torque=traced(0.0, 0.0, 0.4, seed)).valid) for seed in range(100)) <= 1


@pytest.mark.parametrize("late_s", [25.0, 17.0, -15.0])
def test_a_torque_by_another_clock_says_nothing(late_s: float) -> None:
    """Late by half a sequence, both directions have one mean of +50 and −30 N m; dwells of 5 s are told apart."""
    shown_s = round(5.0 * round(abs(late_s) / 5.0))
    time_s, torque_nm = traced(50.0, -30.0, 3.0)
    one = found(torque=(time_s, np.roll(torque_nm, round(late_s / 0.012))))
    assert one.valid is None
    (flag,) = doubts(one.flags, ())
    assert flag.text.startswith(
        f"the motor torque changes some {shown_s} s {'behind' if late_s > 0.0 else 'ahead of'} the reversals"
    )


@pytest.mark.parametrize("late_s", [0.3, 5.0])
def test_a_torque_that_follows_a_little_late_counts(late_s: float) -> None:
    time_s, torque_nm = traced(50.0, -30.0, 3.0)
    one = found(torque=(time_s, np.roll(torque_nm, round(late_s / 0.012))))
    assert one.valid is True
    assert one.flags == ()


@pytest.mark.parametrize("friction_nm", [0.0, 1.0, 8.0])
def test_a_weight_that_grows_with_the_angle_is_no_clock(friction_nm: float) -> None:
    """Its torque goes up and down with the position: a quarter of a period behind the direction."""
    time_s, torque_nm = traced(friction_nm, -friction_nm, 0.5)
    move = np.clip((time_s - 100.0) // DWELL_S, 0, COMMAND.size - 1).astype(np.int64)
    weight_nm = 40.0 + 20.0 * np.cumsum(COMMAND)[move] / (10.0 * STEP)
    one = found(torque=(time_s, torque_nm + weight_nm))
    assert one.valid is False
    assert [flag.kind for flag in one.flags] == ["torque"]


def test_a_torque_in_its_noise_is_by_no_other_clock() -> None:
    for seed in range(50):
        assert found(torque=traced(0.0, 0.0, 0.4, seed)).valid is not None


def test_without_torque_nothing_is_said_about_validity() -> None:
    one = found()
    assert one.valid is None
    assert "no motor torque" in one.flags[0].text


def test_a_torque_that_ends_early_is_refused() -> None:
    time_s, torque_nm = traced(0.8, -0.5, 0.1)
    with pytest.raises(MovesError, match="no torque was recorded at move 42"):
        found(torque=(time_s[time_s < 305.0], torque_nm[time_s < 305.0]))
    with pytest.raises(ArgumentError, match="torque_nm"):
        found(torque=(time_s, torque_nm[1:]))


@pytest.mark.parametrize(
    ("command", "text"),
    [
        (np.full(20, STEP), "no position is reached 2 times"),
        (COMMAND * np.linspace(1.0, 2.0, 100), "steps of one size"),
    ],
)
def test_other_moves_are_refused(command: Floats, text: str) -> None:
    with pytest.raises(MovesError, match=text):
        backlash(measured_steps(command, places(1, 0.0, command), NOISE))


def test_steps_that_were_not_driven_are_refused() -> None:
    done = places(1)
    done[91:] = done[90]
    with pytest.raises(MovesError, match=r"moves 91, 92, .* and 2 more of 100 .* fewer steps were driven"):
        backlash(measured_steps(COMMAND, done, NOISE))


def test_torques_out_of_their_order_are_refused() -> None:
    time_s, torque_nm = traced(20.0, -15.0, 1.0)
    twice = np.concatenate([time_s, time_s]), np.concatenate([torque_nm, torque_nm])
    with pytest.raises(RecordingError, match="times have to increase"):
        found(torque=twice)
