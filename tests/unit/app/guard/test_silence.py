"""When a loop that gives no sign of life is stopped."""

from catseye.app.guard.guard import SILENCE_S, Silence

TICK_S = 0.02


def ticks_until_stopped(silence: Silence, tick_s: float = TICK_S, most: int = 1000) -> int | None:
    return next((n for n in range(1, most) if silence.passed(tick_s)), None)


def test_half_a_second_of_silence_in_motion_stops() -> None:
    silence = Silence()
    silence.beat(moving=True)
    ticks = ticks_until_stopped(silence)
    assert ticks is not None
    assert abs(ticks * TICK_S - SILENCE_S) <= 2 * TICK_S


def test_silence_without_a_motion_means_nothing() -> None:
    silence = Silence()
    silence.beat(moving=False)
    assert ticks_until_stopped(silence) is None


def test_each_beat_begins_the_silence_anew() -> None:
    silence = Silence()
    for _ in range(100):
        silence.beat(moving=True)
        assert not any(silence.passed(TICK_S) for _ in range(20))


def test_a_motion_that_begins_late_counts_from_its_beginning() -> None:
    silence = Silence()
    silence.beat(moving=False)
    silence.passed(60.0)
    silence.beat(moving=True)
    assert not silence.passed(TICK_S)


def test_a_guard_that_was_held_up_itself_does_not_judge() -> None:
    silence = Silence()
    silence.beat(moving=True)
    # A machine that stood still for a minute: the beat that waits is read before the next tick counts.
    assert not silence.passed(60.0)
    silence.beat(moving=True)
    assert ticks_until_stopped(silence) is not None
