"""What an engine sends unasked: the events of a run, as `catseye run --json` writes them, and those of the socket."""

from collections.abc import Mapping
from typing import Any, Final, Literal, Self

from pydantic import Field, ValidationError

from catseye.app.protocol.bench import BenchStatus, Samples, WireLine
from catseye.app.protocol.loss import LossPolicy
from catseye.app.protocol.message import (
    VERSION,
    JsonData,
    Message,
    MessageError,
    absent,
    encode_object,
    faults_of,
)
from catseye.app.protocol.prompts import PromptFields
from catseye.app.protocol.state import ControlState
from catseye.procedures.kit.live import Live


class Event(Message):
    """An event. Who publishes it stamps it: `stamped`.

    Attributes:
        t: ISO 8601 UTC time.
        event: its name.
        run: name of the run that it belongs to; None outside of one.
    """

    t: str = ""
    event: str
    run: str | None = None

    def stamped(self, t: str, run: str | None) -> Self:
        """Return it with time and run."""
        return self.model_copy(update={"t": t, "run": run})


# --- events of a run: `run --json`, and the socket


class RunStarted(Event):
    """The record is open.

    Attributes:
        procedure: its name.
        title: one line for people.
    """

    event: Literal["run-started"] = "run-started"
    procedure: str
    title: str


class StateChanged(Event):
    """Run or idle engine is in another state, or a request means nothing in this one.

    Attributes:
        state: the state.
        reason: why.
    """

    event: Literal["state"] = "state"
    state: ControlState
    reason: str = ""


class LiveData(Message):
    """A live value with its acceptance band. `accepted` is judged once, by the kit."""

    name: str
    value: float
    unit: str
    low: float | None
    high: float | None
    accepted: bool
    text: str

    @classmethod
    def of(cls, live: Live) -> Self:
        """Return a live value of a procedure."""
        return cls(
            name=live.name,
            value=live.value,
            unit=live.unit,
            low=live.low,
            high=live.high,
            accepted=live.accepted,
            text=live.text,
        )


class LiveShown(Event):
    """A value that a technician watches; it is not stored."""

    event: Literal["state"] = "state"
    state: ControlState
    kind: Literal["live"] = "live"
    data: LiveData


class FirstMotionData(Message):
    """Where the arm is led from where it stands.

    Attributes:
        stands: joints now, in the order of the axes; None where they are not known.
        way: targets.
    """

    stands: tuple[float, ...] | None
    way: tuple[tuple[float, ...], ...]


class FirstMotionShown(Event):
    """The arm is about to leave the place where it stands."""

    event: Literal["state"] = "state"
    state: ControlState
    kind: Literal["first-motion"] = "first-motion"
    data: FirstMotionData


class DrivesLeftData(Message):
    """What a run leaves switched on."""

    on: bool
    text: str


class DrivesLeft(Event):
    """The run has ended its work on the drives."""

    event: Literal["state"] = "state"
    state: ControlState
    kind: Literal["drives"] = "drives"
    data: DrivesLeftData


class Happened(Event):
    """Something that a procedure or the engine has stored; `story` has the words for it.

    Attributes:
        state: of the run.
        kind: a name that its author chose.
        data: as it is stored.
    """

    event: Literal["state"] = "state"
    state: ControlState
    kind: str
    data: JsonData


class StepStarted(Event):
    """A step has begun.

    Attributes:
        step: its id.
        title: one line.
        attempt: from 1; more after an interruption.
    """

    event: Literal["step-started"] = "step-started"
    step: str
    title: str
    attempt: int


class StepDone(Event):
    """A step is done, and its rows are durable.

    Attributes:
        step: its id.
        title: one line.
        stored: its result was there from before an interruption.
    """

    event: Literal["step-done"] = "step-done"
    step: str
    title: str
    stored: bool


class PointMeasured(Event):
    """A distance, once it is durable.

    Attributes:
        step: that it belongs to.
        point: the row, with the columns of the procedure's record type.
    """

    event: Literal["point"] = "point"
    step: str
    point: JsonData


class PromptAsked(PromptFields, Event):
    """A question is open."""

    event: Literal["prompt"] = "prompt"


class PromptAnswered(Event):
    """A question is answered.

    Attributes:
        id: of the prompt.
        answer: as typed.
        who: the person, or which part of the program.
    """

    event: Literal["answer"] = "answer"
    id: str
    answer: str
    who: str


class WarningData(Message):
    """More about a warning; procedures add their own.

    Attributes:
        simulated: every device is an emulator, which is what the warning says.
        device: name of the device that it is about.
    """

    simulated: bool | None = Field(default=None, exclude_if=absent)
    device: str | None = Field(default=None, exclude_if=absent)


class WarningTold(Event):
    """A warning with its remedy.

    Attributes:
        text: for people.
        data: more about it.
    """

    event: Literal["warning"] = "warning"
    text: str
    data: WarningData = WarningData()


class ErrorTold(Event):
    """What ends a run, or failed between runs.

    Attributes:
        text: for people.
        exit_code: that it leads to.
    """

    event: Literal["error"] = "error"
    text: str
    exit_code: int


class Progressed(Event):
    """How far the run is.

    Attributes:
        done: expected bench seconds that are behind.
        total: of the whole run, s.
        text: what is under way.
        elapsed_s: bench time so far without waits, s.
        remaining_s: estimate of the rest, s.
    """

    event: Literal["progress"] = "progress"
    done: float
    total: float
    text: str
    elapsed_s: float
    remaining_s: float

    @property
    def share(self) -> float:
        """What is done, 0…1."""
        return min(1.0, self.done / self.total) if self.total > 0.0 else 1.0


class RunEnded(Event):
    """The record is sealed.

    Attributes:
        status: how it ended.
        exit_code: of the process.
        text: why it did not complete; empty otherwise.
        path: of the record.
        drives_on: the drives were left on, or are not certain to be off.
    """

    event: Literal["run-ended"] = "run-ended"
    status: Literal["complete", "stopped", "aborted", "failed"]
    exit_code: int
    text: str
    path: str
    drives_on: bool


# --- what only the socket has


class Client(Message):
    """A client of an engine, as people and records know it.

    Attributes:
        client: unique within this engine.
        who: the person.
    """

    client: str
    who: str

    @property
    def text(self) -> str:
        """The client as people and records read it. Nothing parses this."""
        return f"{self.who} ({self.client})"


LeaseChange = Literal["taken", "taken by force", "handed over", "released", "left", "lost"]


class ControlChanged(Event):
    """Another client, or none, holds control.

    Attributes:
        what: how that came.
        by: text of who holds it now; None for nobody.
        before: text of who held it.
        holder: who holds it now.
    """

    event: Literal["control"] = "control"
    what: LeaseChange
    by: str | None
    before: str | None
    holder: Client | None


class ClientsChanged(Event):
    """Somebody has come or gone."""

    event: Literal["clients"] = "clients"
    clients: tuple[Client, ...]


class ClientLost(Event):
    """The client that held control is gone without a word.

    Attributes:
        client: its name.
        who: the person.
        reason: how it went.
        policy: what becomes of the run.
    """

    event: Literal["client-lost"] = "client-lost"
    client: str
    who: str
    reason: str
    policy: LossPolicy


class EngineIdle(Event):
    """A run is put away, and the next one may begin."""

    event: Literal["idle"] = "idle"
    state: ControlState


class Dropped(Event):
    """This client read too slowly. The message is made where it is sent, without time and run.

    Attributes:
        t: not used.
        run: not used.
        count: points and steps that it missed; the run has them all the same.
    """

    t: str = Field(default="", exclude_if=lambda t: not t)
    event: Literal["dropped"] = "dropped"
    run: str | None = Field(default=None, exclude_if=absent)
    count: int


class JogFields(Message):
    """Whether and how the arm is moved by hand.

    Attributes:
        on: it may move.
        by: text of who moves it.
        client: name of that client.
        percent: speed override as read back; None before it is known.
        moving: the joint, or "beam"; None while the arm stands.
        reason: why it stands, or why the jog is over.
    """

    on: bool
    by: str
    client: str = ""
    percent: float | None
    moving: str | None
    reason: str | None = Field(default=None, exclude_if=absent)


class JogChanged(JogFields, Event):
    """A jog has begun or ended, or something of it moves or stands."""

    event: Literal["jog"] = "jog"


class RawChanged(Event):
    """A device's link was taken from its driver, or given back.

    Attributes:
        device: its name in the cell file.
        on: it is taken.
        by: text of who has it, or had it.
        client: name of that client.
        reason: why it was given back.
    """

    event: Literal["raw"] = "raw"
    device: str
    on: bool
    by: str
    client: str = ""
    reason: str | None = Field(default=None, exclude_if=absent)


class DrivesFields(Message):
    """What becomes of drives that a run has left on.

    Attributes:
        on: they are on, or not certain to be off.
        off_at_utc: ISO 8601 UTC time at which they go off; absent while nobody counts.
        reason: why they went off, or are not certain to be.
    """

    on: bool
    off_at_utc: str | None = Field(default=None, exclude_if=absent)
    reason: str | None = Field(default=None, exclude_if=absent)


class DrivesChanged(DrivesFields, Event):
    """The engine counts down to switching the drives off, or does it."""

    event: Literal["drives"] = "drives"


class BenchSeen(BenchStatus, Event):
    """The bench as it is now, for those who watch."""

    event: Literal["bench"] = "bench"


class SamplesTaken(Samples, Event):
    """The beam's displacement since the last ones, for those who watch."""

    event: Literal["samples"] = "samples"


class WirePassed(Event):
    """What went over the wires, for those who asked for traffic.

    Attributes:
        lines: oldest first.
        missed: older lines that are left out.
    """

    event: Literal["wire"] = "wire"
    lines: tuple[WireLine, ...]
    missed: int


class Unknown(Event):
    """An event of a newer engine; whoever does not pass it on ignores it."""


RunEvent = (
    RunStarted
    | StateChanged
    | LiveShown
    | FirstMotionShown
    | DrivesLeft
    | Happened
    | StepStarted
    | StepDone
    | PointMeasured
    | PromptAsked
    | PromptAnswered
    | WarningTold
    | ErrorTold
    | Progressed
    | RunEnded
)
"""The events of the file format, as `catseye run --json` writes them."""

EngineEvent = (
    ControlChanged
    | ClientsChanged
    | ClientLost
    | EngineIdle
    | Dropped
    | JogChanged
    | RawChanged
    | DrivesChanged
    | BenchSeen
    | SamplesTaken
    | WirePassed
    | Unknown
)
AnyEvent = RunEvent | EngineEvent

_KINDS: Final[Mapping[str, type[LiveShown | FirstMotionShown | DrivesLeft]]] = {
    "live": LiveShown,
    "first-motion": FirstMotionShown,
    "drives": DrivesLeft,
}
"""Kinds of `state` that clients read field by field."""

_EVENTS: Final[Mapping[str, type[AnyEvent]]] = {
    str(model.model_fields["event"].default): model
    for model in (
        RunStarted,
        StateChanged,
        StepStarted,
        StepDone,
        PointMeasured,
        PromptAsked,
        PromptAnswered,
        WarningTold,
        ErrorTold,
        Progressed,
        RunEnded,
        ControlChanged,
        ClientsChanged,
        ClientLost,
        EngineIdle,
        Dropped,
        JogChanged,
        RawChanged,
        DrivesChanged,
        BenchSeen,
        SamplesTaken,
        WirePassed,
    )
}


def event_of(message: Mapping[str, Any]) -> AnyEvent:
    """Return the event of a message.

    Raises:
        MessageError: it is no event as this version has it.
    """
    try:
        return _model_of(message).model_validate(message)
    except ValidationError as error:
        raise MessageError(f"{message.get('event')}: {faults_of(error)}") from error


def _model_of(message: Mapping[str, Any]) -> type[AnyEvent]:
    """Return the model of a message: by its name, and for a `state` that has a kind by that."""
    name, kind = str(message.get("event")), message.get("kind")
    if name == "state" and kind is not None:
        return _KINDS.get(str(kind), Happened)
    return _EVENTS.get(name, Unknown)


def encode_event(event: Event) -> bytes:
    """Return an event as its line on the socket."""
    return encode_object({"v": VERSION, **event.json_object()})
