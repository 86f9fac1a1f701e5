"""Choosing a procedure by keys: on a screen that follows slowly as on a fast one."""

from types import SimpleNamespace

import pytest

from tests.system import by_keys

TITLES = ("Levelling of the beam", "Beam to J4", "Automated open-loop", "Warm-up")


class SlowScreen:
    """Shows what a key did only some time after it."""

    def __init__(self, behind_s: float) -> None:
        self.now_s = 0.0
        self.chosen = 0
        self._behind_s = behind_s
        self._shown = [(0.0, 0)]

    @property
    def text(self) -> str:
        shown = [chosen for at_s, chosen in self._shown if at_s <= self.now_s][-1]
        return f"╭─ The day ──────────╮╭─ {TITLES[shown]} ────╮"

    def press(self, *keys: str) -> None:
        for key in keys:
            self.chosen = 0 if key == "home" else (self.chosen + 1) % len(TITLES)
            self._shown.append((self.now_s + self._behind_s, self.chosen))

    def shows(self, *_texts: str, limit_s: float = 0.0) -> str:
        raise NotImplementedError(limit_s)

    def sleep(self, duration_s: float) -> None:
        self.now_s += duration_s


@pytest.mark.parametrize("behind_s", [0.0, 0.5, 3.0, 30.0])
def test_the_procedure_is_chosen_however_slow_the_screen(
    behind_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    screen = SlowScreen(behind_s)
    monkeypatch.setattr(by_keys, "time", SimpleNamespace(monotonic=lambda: screen.now_s, sleep=screen.sleep))
    by_keys.choose(screen, "Automated open-loop")
    assert TITLES[screen.chosen] == "Automated open-loop"
