"""An arm that is jogged by a held key in a terminal: from the last repeat to standstill, against the STOP key."""

from tests.system.command import Emulated
from tests.system.test_jog_by_keys import bench, hold, jogging_screen, moving, settled

__all__ = ["bench"]

TARGET_S = 0.8
STOP_KEY = "f12"
MOST = 100.0
"""Of what the STOP key takes until the arm stands: the repeat of a held key has to be missed first, and a quick
machine stops an arm in milliseconds. An arm that went on to its limit would take a thousand times as long."""


def stands_after_s(bench: Emulated, end: str) -> float:
    """Jog by a held key, end that, and return how long the arm goes on moving, s."""
    with jogging_screen(bench) as screen:
        screen.press("m")
        screen.shows("[hold]")
        hold(bench, screen, "right")
        if end != "let go":
            screen.press(end)
        taken_s = settled(bench, lambda: not moving(bench))
    print(f"\n{end}: {1e3 * taken_s:.0f} ms to standstill (target {1e3 * TARGET_S:g} ms)")  # noqa: T201  # the figure
    return taken_s


def test_other_ends_take_few_times_the_stop_key(bench: Emulated) -> None:  # a fixture
    stopped_s = stands_after_s(bench, STOP_KEY)
    others_s = [stands_after_s(bench, end) for end in ("let go", "f2", "focus lost")]
    assert max(others_s) <= MOST * stopped_s
