"""An arm that is jogged by a held key in a terminal: from the last repeat to standstill."""

import pytest

from tests.system.command import Emulated
from tests.system.screen import Screen
from tests.system.test_jog_by_keys import bench, hold, moving, screen, settled

__all__ = ["bench", "screen"]

LIMIT_S = 0.8


@pytest.mark.parametrize("end", ["let go", "f12", "f2", "focus lost"])
def test_arm_stands_within_800_ms(bench: Emulated, screen: Screen, end: str) -> None:  # fixtures
    screen.press("m")
    screen.shows("[hold]")
    hold(bench, screen, "right")
    if end != "let go":
        screen.press(end)
    taken_s = settled(bench, lambda: not moving(bench))
    print(f"\n{end}: {1e3 * taken_s:.0f} ms to standstill (limit {1e3 * LIMIT_S:g} ms)")  # noqa: T201  # the figure
    assert taken_s <= LIMIT_S
