"""A whole day by keys alone: every stage from the day's list, and how many keys it took."""

import contextlib
import os
import re
import signal
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from catseye.app.service.address import find_socket, is_live
from tests.patience import HANG_S
from tests.system.command import own_runtime
from tests.system.screen import READ_S, Screen, on_screen
from tests.system.socket_client import Lines

SIZE: Final = (120, 40)
_LOOKED: Final = "wait …"
"""Beside the day's list while cell and runs are being looked at."""

_QUESTION: Final = re.compile(r"━ Question (\S+) ━")
_MAY_MOVE: Final = re.compile(r"┃.* F8  \w.*┃\n┗")
_FIRST_ANSWER: Final = re.compile(r"┃ +1  \w.*┃\n┗")
"""Answers below a question: what it asks for was done."""


@dataclass
class Day:
    """Somebody before a terminal who counts the keys.

    Attributes:
        screen: with the user interface in it.
        keys: that were pressed, without answers to a procedure's or a command's question.
        answers: keys that answered such questions.
        took_s: time of each stage.
    """

    screen: Screen
    keys: int = 0
    answers: int = 0
    took_s: dict[str, float] = field(default_factory=dict)

    def press(self, *keys: str) -> None:
        """Press keys."""
        self.keys += len(keys)
        self.screen.press(*keys)

    def answer(self, *keys: str) -> None:
        """Press keys that answer a question."""
        self.answers += len(keys)
        self.screen.press(*keys)

    def emulate(self, key: str) -> None:
        """Have the screen Set-up start an emulated bench."""
        self.screen.shows("Emulated bench")
        self.press(key)
        self.screen.shows("SIMULATION", "IDLE", "servo ")

    def moves(self, stage: str, limit_s: float = HANG_S) -> None:
        """Open the next stage, a procedure, let the arm move, answer its questions and come back to the list."""
        begun_s = self._opened(stage)
        self.screen.shows("F8  the arm moves")
        self.press("f8")
        answered = {""}
        end_s = time.monotonic() + limit_s
        # The run of before stands there until the new one has begun.
        while not _has_ended(text := self.screen.shows(""), stage):
            assert time.monotonic() < end_s, text
            asked = _QUESTION.search(text)
            if asked is not None and asked[1] not in answered and (key := _answer_to(text)):
                answered.add(asked[1])
                # F8 counts only once the question can have been read.
                time.sleep(READ_S)
                self.answer(key)
            time.sleep(0.1)
        self.press("f3")
        self._done(stage, begun_s)

    def works(self, stage: str, *answers: str) -> None:
        """Open the next stage, work on stored data, and answer what it asks."""
        begun_s = self._opened(stage)
        if answers:
            self.screen.shows("esc back")
            self.answer(*answers)
        self._done(stage, begun_s)

    def works_on_each(self, stage: str, command: str, runs: int) -> None:
        """Work on each of several runs; the stage stays the next one until all of them were."""
        begun_s, last = time.monotonic(), "none"
        for _ in range(runs):
            text = self._until(rf"→ {stage}(?! \w)[\s\S]* catseye {command} (?!{last})\w")
            last = text.partition(f" catseye {command} ")[2].partition(" ")[0]
            self.press("enter")
        self._done(stage, begun_s)

    def quit(self) -> None:
        """Leave."""
        self.press("ctrl+q")
        assert self.screen.ended() == 0

    def _opened(self, stage: str) -> float:
        begun_s = time.monotonic()
        self._until(rf"→ {stage}(?! \w)")
        self.press("enter")
        return begun_s

    def _done(self, stage: str, begun_s: float) -> None:
        self._until(rf"✓ {stage}(?! \w)")
        self.took_s[stage] = time.monotonic() - begun_s

    def _until(self, pattern: str) -> str:
        """Wait until something stands on the day's list, and the list is known to be the present one."""
        end_s = time.monotonic() + HANG_S
        while _LOOKED in (text := self.screen.shows("")) or not re.search(pattern, text):
            assert time.monotonic() < end_s, f"{pattern} is not on the list:\n{text}"
            time.sleep(0.1)
        return text


def _answer_to(text: str) -> str:
    """Return the key for a question's work having been done; empty while the question is not drawn whole."""
    if _MAY_MOVE.search(text):
        return "f8"
    return "1" if _FIRST_ANSWER.search(text) else ""


def _has_ended(text: str, stage: str) -> bool:
    """Return whether the first line says that the run of a stage is complete; it must not have failed."""
    first = text.partition("\n")[0]
    assert not first.endswith((" failed", " stopped", " aborted")), text
    return f"_{stage}_" in first and first.endswith(" complete")


@contextlib.contextmanager
def beginning(folder: Path, speed: str, *options: str) -> Iterator[Day]:
    """Start the user interface in a folder; at last the engine ends with its emulators, whatever has happened."""
    with own_runtime(), on_screen("tui", "--speed", speed, *options, cwd=folder, size=SIZE) as screen:
        try:
            yield Day(screen)
        finally:
            path = find_socket(folder / "catseye-runs")
            if path is not None and is_live(path):
                with contextlib.closing(Lines(str(path))) as client:
                    pid = int(client.ask("hello", client="test", who="test")["snapshot"]["pid"])
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
