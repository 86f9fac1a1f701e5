"""What a service may do with a run that is under way."""

from collections.abc import Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path

from catseye.app.engine.control import RunControl
from catseye.app.engine.gate import MotionGate
from catseye.app.errors import LimitError
from catseye.procedures.kit.records import Json


@dataclass
class RunHandle:
    """A run from its opening to its sealed record.

    Attributes:
        path: the run's directory.
        procedure: its name.
        title: one line for people.
        control: the stop ladder.
        note: stores something that happened: kind and data; never waits.
        warn: stores and publishes a warning.
        simulated: all devices are emulated; None until they are known.
        gate: of the run's motions; None until the devices are ready.
        turned_deg: what the arm carries is turned so far about the last axis against the beginning of the run.
        feed: keeps a walk going for another moment, or stops it; None for a run that is no walk.
    """

    path: Path
    procedure: str
    title: str
    control: RunControl
    note: Callable[[str, Mapping[str, Json]], None]
    warn: Callable[[str], None]
    simulated: bool | None = None
    gate: MotionGate | None = None
    turned_deg: float = 0.0
    feed: Callable[[bool], None] | None = None

    def remounted(self, turned_deg: float) -> None:
        """Take note of how what the arm carries is mounted from now on, deg."""
        self.turned_deg = turned_deg

    def lower_override(self, percent: float) -> float:
        """Have the speed override lowered before the next motion; return what it reads until then.

        Args:
            percent: of the programmed speed.

        Raises:
            LimitError: it would not be lowered, or the devices are not ready; nothing changes.
        """
        if self.gate is None:
            raise LimitError("the devices are not ready yet: ask again when the state is EXECUTE")
        return self.gate.want_override(percent)


OnOpen = Callable[[RunHandle], AbstractAsyncContextManager[None]]
"""Entered when a run's record is open and before any device is connected, left when the record is sealed."""
