"""What is looked at and asked before an interrupted run goes on: the physical world may have changed meanwhile."""

from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from catseye.app.engine.questions import CLEAR, REFLECTORS
from catseye.app.engine.states import Trigger, transition
from catseye.app.errors import MeasurementRejectedError, SafetyError, UsageError
from catseye.app.protocol.state import ControlState
from catseye.app.store.reader import RunReader, StoredEvent
from catseye.app.store.resumable import MOVED, SET_UP_LOST
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.records import Json

_IDENTIFYING = ("model", "serial")
_OF_THE_POINTS = ("robot", "interferometer", "tracker")
"""Devices that a run's data are one with."""

_RESTARTED = (
    "the emulated bench was restarted since the run was begun: reflectors, screws, optics and temperatures are "
    "as at its beginning"
)

Ask = Callable[[Prompt], Awaitable[str]]
Note = Callable[[str, Mapping[str, Json]], Awaitable[None]]


class Reentry:
    """The way back into an interrupted run.

    Attributes:
        abort_cause: why the run was aborted, while no operator has cleared that; None otherwise.
        since_utc: when the last step was done, or the run begun: points are worth something if nothing was touched
            since.
    """

    def __init__(self, reader: RunReader) -> None:
        self._name = reader.path.name
        self._facts: Mapping[str, Any] = reader.meta
        events, steps = reader.events(), reader.steps()
        self.abort_cause = _uncleared_abort(events)
        self.since_utc = steps[-1].done_utc if steps else events[0].time_utc if events else ""

    def require_same_bench(self, present: Mapping[str, Any]) -> list[str]:
        """Check that instruments and an emulated arm are those of the points; return what else has changed.

        Another controller drives another arm, another interferometer sends another beam (offset from its axis,
        direction, reference length), and another tracker has another frame. No answer of an operator makes such
        points belong together, so this is refused and not asked. A device that does not state its model or serial
        number cannot be compared; one that only serves the surroundings may be exchanged, which is reported.

        Args:
            present: facts of the bench, as a run stores them.

        Raises:
            UsageError: the robot, the interferometer or the tracker is another one, or an emulated arm is.
        """
        bench = _changes(self._facts, {key: present.get(key) for key in ("bench_started", "bench_truth")})
        if "bench_truth" in bench:
            raise self._other("the emulated arm is another one", "start the emulators with its seed or truth")
        notes = [_RESTARTED] if bench else []
        devices = self._facts.get("devices") or {}
        for name, facts in present["devices"].items():
            changes = _changes(devices.get(name) or {}, facts)
            if changes and name in _OF_THE_POINTS and not changes.keys().isdisjoint(_IDENTIFYING):
                raise self._other(
                    f"the {name} is another one ({_changes_text(changes)})", "connect the former one"
                )
            if changes:
                notes.append(f"the {name} is not as it was before the interruption: {_changes_text(changes)}")
        return notes

    def _other(self, what: str, remedy: str) -> UsageError:
        return UsageError(
            f"{self._name}: {what}: its points and new ones would not belong together, nothing was moved; {remedy}, "
            "or start a new run; the points so far stay usable"
        )

    async def clear(self, ask: Ask, publish: Callable[[ControlState, str], None]) -> None:
        """Lead the run out of ABORTED, which only its operator can.

        Args:
            ask: puts a question to the operator.
            publish: publishes and stores a state and its reason.

        Raises:
            SafetyError: the operator does not clear.
        """
        text = f"The cause of the abort was ‘{self.abort_cause}’: is it found and removed?"
        prompt = CLEAR.prompt(CLEAR.id, text)
        if await ask(prompt) != "yes":
            raise SafetyError(
                f"{self._name} stays aborted: find and remove the cause (‘{self.abort_cause}’), then go on with: "
                f"catseye resume {self._name}"
            )
        clearing = transition(ControlState.ABORTED, Trigger.CLEAR).state
        publish(clearing, "the operator has found and removed the cause of the abort")
        publish(transition(clearing, Trigger.CLEARED).state, "cleared; the run goes on")

    async def ask_for_reflectors(self, ask: Ask, note: Note, *, sets_up_anew: bool = False) -> bool:
        """Ask whether the bench is still the one of the points; return whether it is.

        Args:
            sets_up_anew: the run can go on without, since its procedure sets up anew what was moved.

        Raises:
            MeasurementRejectedError: it is not, and the run never goes on.
        """
        anew = "; the run has what was moved set up again" if sets_up_anew else ""
        prompt = REFLECTORS.prompt(
            REFLECTORS.id,
            (
                "Has a reflector, a nest or the instrument been moved or touched, beyond what the run asked for, "
                f"since {_time_text(self.since_utc)} (untouched, or moved{anew})?"
            ),
        )
        if await ask(prompt) == "untouched":
            return True
        if sets_up_anew:
            await note(SET_UP_LOST, {"since_utc": self.since_utc})
            return False
        await note(MOVED, {"since_utc": self.since_utc})
        raise MeasurementRejectedError(
            f"{self._name} cannot go on: its points belong to reflectors that stood elsewhere; search again and "
            "start a new run; the points so far stay usable"
        )


def _uncleared_abort(events: list[StoredEvent]) -> str | None:
    """Return why a run was aborted last; None when it was not, or when its operator has cleared that.

    A process may die between the abort and its closing record, or while the operator is asked to clear.
    """
    cause: str | None = None
    for event in events:
        match event.kind, event.data:
            case "state", {"state": ControlState.ABORTING, "reason": str(reason)}:
                cause = cause or reason
            case "state", {"state": ControlState.CLEARING}:
                cause = None
            case "run-ended", {"status": "aborted", **rest}:
                cause = cause or str(rest.get("text") or "unknown: the record does not say")
    return cause


def _changes(before: Mapping[str, Json], now: Any) -> dict[str, tuple[Json, Json]]:
    return {
        key: (before[key], value)
        for key, value in now.items()
        if value not in ("", None) and before.get(key) not in ("", None, value)
    }


def _changes_text(changes: Mapping[str, tuple[Json, Json]]) -> str:
    return ", ".join(f"{key} {now}, was {before}" for key, (before, now) in changes.items())


def _time_text(time_utc: str) -> str:
    return f"{time_utc[:10]} {time_utc[11:19]} UTC"
