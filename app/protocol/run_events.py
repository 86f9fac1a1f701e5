"""The events of a run, as `catseye run --json` writes them and the socket sends them."""

from typing import Final, Literal, Self

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


class StateFields(Event):
    """The state of a run or of an idle engine.

    Attributes:
        state: the state.
        reason: why.
    """

    state: ControlState
    reason: str = ""


class StateChanged(StateFields):
    """It is in another state."""

    event: Literal["state"] = "state"


class StateNoted(StateFields):
    """It stays in its state, for one more reason, or a request means nothing in it."""

    event: Literal["state-note"] = "state-note"


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

    event: Literal["live"] = "live"
    state: ControlState
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

    event: Literal["first-motion"] = "first-motion"
    state: ControlState
    data: FirstMotionData


class DrivesLeftData(Message):
    """What a run leaves switched on."""

    on: bool
    text: str


class DrivesLeft(Event):
    """The run has ended its work on the drives."""

    event: Literal["drives-left"] = "drives-left"
    state: ControlState
    data: DrivesLeftData


class Happened(Event):
    """Something that a procedure or the engine has stored; `event_text` puts it into words.

    Attributes:
        state: of the run.
        kind: a name that its author chose.
        data: as it is stored.
    """

    event: Literal["happened"] = "happened"
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
        trace: where it happened; empty unless the environment of the engine has CATSEYE_DEBUG set.
    """

    event: Literal["error"] = "error"
    text: str
    exit_code: int
    trace: str = Field(default="", exclude_if=lambda trace: not trace)


class Progressed(Event):
    """How far the run is.

    Attributes:
        done: expected bench seconds that are behind.
        total: of the whole run, s.
        text: what is under way.
        elapsed_bench_s: bench time so far, waits left out.
        left_bench_s: estimate of the rest by the rehearsal and what was seen, without waits to come.
        elapsed_s: real time since the beginning, waits included.
        left_s: real time of the rest, without waits to come.
        changed: why the whole takes more or less than it looked before; empty while that is about the same.
    """

    event: Literal["progress"] = "progress"
    done: float
    total: float
    text: str
    elapsed_bench_s: float
    left_bench_s: float
    elapsed_s: float
    left_s: float
    changed: str = ""

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
        rejected: what was measured is no use, and the run never goes on.
    """

    event: Literal["run-ended"] = "run-ended"
    status: Literal["complete", "stopped", "aborted", "failed"]
    exit_code: int
    text: str
    path: str
    drives_on: bool
    rejected: bool = Field(default=False, exclude_if=lambda rejected: not rejected)


RunEvent = (
    RunStarted
    | StateChanged
    | StateNoted
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
"""The events of a run."""

TELEMETRY: Final = (StateNoted, LiveShown, FirstMotionShown, DrivesLeft, Happened)
"""What accompanies a run and decides nothing: `catseye run --json` leaves it out unless it is asked for."""
