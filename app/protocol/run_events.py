"""The events of a run, as `catseye run --json` writes them and the socket sends them."""

from typing import Literal, Self

from pydantic import Field

from catseye.app.protocol.bench import AxisName
from catseye.app.protocol.message import Event, JsonData, Message, absent
from catseye.app.protocol.prompts import PromptFields
from catseye.app.protocol.state import ControlState
from catseye.procedures.kit.live import Live


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


class LiveStepData(Message):
    """A step of a series as its plateaus look now; see `catseye.procedures.kit.live.LiveStep`."""

    series: str
    number: int
    count: int
    command: float
    measured: float
    position: float
    unit: Literal["deg", "mm"]
    error_percent: float
    band_percent: float
    torque_nm: float | None
    below: bool = False


class LiveData(Message):
    """A live value with its acceptance band. `accepted` is judged once, by the kit, with U `expanded`."""

    name: str
    value: float
    unit: str
    low: float | None
    high: float | None
    accepted: bool
    text: str
    step: LiveStepData | None = Field(default=None, exclude_if=absent)
    expanded: float = Field(default=0.0, exclude_if=lambda expanded: not expanded)

    @classmethod
    def of(cls, live: Live) -> Self:
        """Return a live value of a procedure."""
        return cls.model_validate(live, from_attributes=True)


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
        axes: of the joints; None from programs that did not send them.
    """

    stands: tuple[float, ...] | None
    way: tuple[tuple[float, ...], ...]
    axes: tuple[AxisName, ...] | None = Field(default=None, exclude_if=absent)


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
    """Something that a procedure or the engine has stored; `event_text` puts it into words.

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


class WarningIssued(Event):
    """A warning with its remedy.

    Attributes:
        text: for people.
        data: more about it.
    """

    event: Literal["warning"] = "warning"
    text: str
    data: WarningData = WarningData()


class ErrorReported(Event):
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
    | WarningIssued
    | ErrorReported
    | Progressed
    | RunEnded
)
"""The events of the file format, as `catseye run --json` writes them."""
