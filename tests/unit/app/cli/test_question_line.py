"""A question with a live value above it, as a terminal shows it."""

import re

import pytest

from catseye.app.cli.narrator import Narrator
from catseye.app.cli.question_line import live_text
from catseye.app.protocol.run_events import (
    Happened,
    LiveData,
    LiveShown,
    PromptAnswered,
    PromptAsked,
    WarningIssued,
)
from catseye.app.protocol.state import ControlState


class Screen:
    """A terminal of few rows that understands what is written to it here: cursor up, erase, save and restore."""

    def __init__(self) -> None:
        self.rows = [""]
        self.row = self.column = 0
        self._saved = (0, 0)

    def write(self, text: str) -> None:
        for part in re.findall(r"\x1b7|\x1b8|\x1b\[1A|\x1b\[K|\r|\n|[^\x1b\r\n]+", text):
            self._take(part)

    def _take(self, part: str) -> None:
        match part:
            case "\x1b7":
                self._saved = (self.row, self.column)
            case "\x1b8":
                self.row, self.column = self._saved
            case "\x1b[1A":
                self.row -= 1
            case "\x1b[K":
                self.rows[self.row] = self.rows[self.row][: self.column]
            case "\r":
                self.column = 0
            case "\n":
                self.row, self.column = self.row + 1, 0
                self.rows += [""] * (self.row + 1 - len(self.rows))
            case _:
                line = self.rows[self.row].ljust(self.column)
                self.rows[self.row] = line[: self.column] + part + line[self.column + len(part) :]
                self.column += len(part)


def data(
    name: str, value: float, unit: str, *limits: float | None, accepted: bool = True, text: str = ""
) -> LiveData:
    low, high = limits
    return LiveData(name=name, value=value, unit=unit, low=low, high=high, accepted=accepted, text=text)


def live(value: float, accepted: bool) -> LiveShown:
    found = data("offset", value, "mm", -0.1, 0.1, accepted=accepted, text="turn the stage clockwise")
    return LiveShown(state=ControlState.EXECUTE, data=found)


@pytest.mark.parametrize(
    ("shown", "text"),
    [
        (live(0.43, False).data, "offset 0.430 mm  [-0.1 … 0.1]  outside  turn the stage clockwise"),
        (data("signal", 0.5, "", 0.1, None), "signal 0.50  [0.1 … ]  ok"),
        (data("drift", 1.25, "µm", None, None), "drift 1.2 µm"),
        (live(0.489638, False).data, "offset 0.490 mm  [-0.1 … 0.1]  outside  turn the stage clockwise"),
        (live(-0.0001, True).data, "offset 0.000 mm  [-0.1 … 0.1]  ok  turn the stage clockwise"),
    ],
)
def test_a_live_value_reads_with_its_band(shown: LiveData, text: str) -> None:
    assert live_text(shown) == text


def test_what_is_typed_stays_while_the_value_above_it_changes(capsys: pytest.CaptureFixture[str]) -> None:
    narrator, screen = Narrator("job", as_json=False), Screen()
    narrator.interactive = True

    def shown() -> list[str]:
        screen.write(capsys.readouterr().err)
        return [row.rstrip() for row in screen.rows]

    narrator.publish(PromptAsked(id="stage/1", kind="confirm", text="Turn the stage.", motion=True))
    assert shown() == ["question stage/1: Turn the stage.", "(the arm moves: type move, or no) >"]
    narrator.publish(live(0.43, False))
    shown()
    screen.write("mo")
    for value in (0.3, 0.2, 0.05):
        narrator.publish(live(value, accepted=value < 0.1))
    assert shown() == [
        "question stage/1: Turn the stage.",
        "offset 0.050 mm  [-0.1 … 0.1]  ok  turn the stage clockwise",
        "(the arm moves: type move, or no) > mo",
    ]
    narrator.publish(WarningIssued(text="the signal is weak"))
    screen.write(capsys.readouterr().err + "move\n")
    narrator.entered()
    narrator.publish(PromptAnswered(id="stage/1", answer="yes", who="Ada"))
    assert shown()[3:] == [
        "warning: the signal is weak",
        "(the arm moves: type move, or no) > move",
        "answer to stage/1: yes (Ada)",
        "",
    ]


def test_what_a_run_is_made_for_is_read_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    narrator = Narrator("ballbar-cup", as_json=False)
    data = {"nest": "nest1", "centre_mm": [1.0, 2.0, 3.0], "apart_mm": 0.02}
    narrator.publish(Happened(state=ControlState.EXECUTE, kind="cup-found", data=data))
    assert "--param centre_mm=[1.000,2.000,3.000]" in capsys.readouterr().err
    narrator.publish(Happened(state=ControlState.EXECUTE, kind="frame-found", data={"what": "base"}))
    assert capsys.readouterr().err == ""
