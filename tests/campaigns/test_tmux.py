"""The paper's whole plan by keys alone in tmux, on the emulators."""

import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.system.by_keys import measure_by_keys, result_of
from tests.system.command import emulated, environment, own_runtime

SPEED = "100"
LIMIT_S = 900.0
_NAMES = {"enter": "Enter", "home": "Home", "down": "Down", "ctrl+s": "C-s", "ctrl+q": "C-q"}


class Tmux:
    """The user interface in a session of tmux.

    Args:
        socket: of this server of tmux.
    """

    def __init__(self, socket: Path) -> None:
        self._socket = socket

    @property
    def text(self) -> str:
        """What stands on the screen now."""
        return self.call("capture-pane", "-p")

    def press(self, *keys: str) -> None:
        """Press keys by their names, or characters."""
        for key in keys:
            self.call("send-keys", _NAMES.get(key, key.upper() if len(key) > 1 else key))

    def shows(self, *texts: str, limit_s: float = 90.0) -> str:
        """Wait until all texts stand on the screen; return it."""
        end_s = time.monotonic() + limit_s
        while not all(text in (shown := self.text) for text in texts):
            assert time.monotonic() < end_s, f"{texts} not on the screen:\n{shown}"
            time.sleep(0.1)
        return shown

    def call(self, *words: str) -> str:
        """Call tmux; return what it says."""
        return subprocess.run(
            ["tmux", "-S", str(self._socket), *words], capture_output=True, text=True, check=True
        ).stdout


@contextmanager
def in_tmux(folder: Path, *arguments: str) -> Iterator[Tmux]:
    """Show a command of `catseye` in a terminal of 120 columns and 40 lines."""
    assert shutil.which("tmux"), "tmux is missing; call: apt-get install tmux"
    tmux = Tmux(folder / "tmux")
    variables = [
        f"{name}={environment()[name]}" for name in ("PYTHONPATH", "XDG_RUNTIME_DIR", "OMP_NUM_THREADS")
    ]
    command = ["env", *variables, sys.executable, "-m", "catseye", *arguments]
    tmux.call("new-session", "-d", "-x", "120", "-y", "40", "-c", str(folder), *command)
    try:
        yield tmux
    finally:
        subprocess.run(["tmux", "-S", str(folder / "tmux"), "kill-server"], capture_output=True, check=False)


@pytest.mark.timeout(2000)
def test_whole_plan_by_keys_in_tmux(tmp_path: Path) -> None:
    with own_runtime(), emulated(tmp_path, "--speed", SPEED) as bench:
        with in_tmux(tmp_path, "tui", "--cell", str(bench.cell), "--speed", SPEED) as tmux:
            begun_s = time.monotonic()
            measure_by_keys(tmux, LIMIT_S)
            print(f"\nthe paper's plan by keys: {(time.monotonic() - begun_s) / 60:.1f} min")  # noqa: T201  # the figure
            tmux.press("ctrl+q")
        truth = bench.ask(op="truth")["truth"]
    result = result_of(tmp_path)
    assert result["fit"]["n_points"] > 1000
    for name in ("link1_mm", "link2_mm"):
        found = result[name]
        assert abs(found["value"] - truth[name]["value"]) < 4.0 * found["u"], name
