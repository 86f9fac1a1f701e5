"""What a procedure may do: the only door between a procedure and the world."""

import math
from collections.abc import Awaitable, Callable, Sequence
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.tracker import Face, Place, Position, TargetPoint, TargetPose
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.recording import Recording
from catseye.procedures.kit.records import Json, Record, Row
from catseye.procedures.kit.tasks import Task

if TYPE_CHECKING:
    # Numpy comes with it: clients of an engine start without.
    from catseye.procedures.kit.columns import Columns, TableRule
    from catseye.procedures.kit.mapping import TableMapping


@dataclass(frozen=True)
class AirCorrection:
    """How a distance was corrected for the air. All but the raw reading are None when the instrument corrects.

    Attributes:
        raw_displacement_mm: mean of the readings as the instrument gave them.
        refractive_index: of the air during the readings.
        zero_refractive_index: the same at the last zero.
        dead_path_mm: length of the beam at the last zero.
        formula: of the index.
    """

    raw_displacement_mm: float
    refractive_index: float | None = None
    zero_refractive_index: float | None = None
    dead_path_mm: float | None = None
    formula: str | None = None


@dataclass(frozen=True)
class Measurement:
    """A distance measured at standstill.

    Attributes:
        displacement_mm: mean of the readings, corrected for the air.
        spread_mm: standard deviation of the readings, 0 for a single one.
        readings: how many were averaged.
        beam: state of beam and counter after the last reading.
        reported: joints reported by the controller.
        air: state of the air.
        time_utc: ISO 8601 UTC time of the first reading.
        duration_s: from the first to the last reading, s.
        material_c: temperature of the links, °C; None without a sensor.
        correction: raw reading and what was used to correct it; None for an ideal distance.
        clock_s: bench seconds at the first reading; they count from an origin of their own in every process.
        apart: readings that were left out since they stand apart from the others, as the instrument gave them.
    """

    displacement_mm: float
    spread_mm: float
    readings: int
    beam: BeamStatus
    reported: Pose
    air: AirSample
    time_utc: str
    duration_s: float
    material_c: float | None = None
    correction: AirCorrection | None = None
    clock_s: float = 0.0
    apart: tuple[str, ...] = ()


@dataclass(frozen=True)
class Prompt:
    """A question to the operator, as data.

    Attributes:
        id: stable within the run; answers name it.
        kind: what an answer may be.
        text: one imperative sentence.
        choices: for kind "choice".
        unit: for kind "number".
        timeout_s: how long the question stays open; None for ever.
        safe_answer: taken when the time is over; None leaves the prompt unanswered (an error).
        task: what a person does on the bench before the answer; None for a mere question. "yes", or the first of the
            choices, says that it is done; an emulated bench has it done then.
        motion: the arm moves after "yes", after every choice but those of `rests_after`, after what is typed: front
            ends take such an answer by a key of its own.
        rests_after: answers after which the arm does not move; None for the safe choice alone.
        by_person: no emulated operator answers it.
        target: where it goes then; None where the procedure does not know yet.
    """

    id: str
    kind: Literal["confirm", "choice", "number", "text"]
    text: str
    choices: tuple[str, ...] = ()
    unit: str = ""
    timeout_s: float | None = None
    safe_answer: str | None = None
    task: Task | None = None
    motion: bool = False
    rests_after: tuple[str, ...] | None = None
    by_person: bool = False
    target: Pose | None = None

    @property
    def resting_answers(self) -> tuple[str, ...]:
        """Answers after which the arm does not move; of a confirmation everything but "yes" is one."""
        if self.kind != "choice":
            return self.rests_after or ()
        resting = (self.safe_answer,) if self.rests_after is None else self.rests_after
        return tuple(choice for choice in resting if choice in self.choices)

    @property
    def in_unit(self) -> str:
        """The unit as it follows what is asked for: " in mm"; empty without one."""
        return f" in {self.unit}" if self.unit else ""

    def fault_of(self, text: str) -> str:
        """Return why a text is no answer; empty when it is one."""
        match self.kind:
            case "confirm":
                return "" if text in {"yes", "no"} else "answer yes or no"
            case "choice":
                return "" if text in self.choices else f"choose one of {', '.join(self.choices)}"
            case "number":
                return "" if _is_number(text) else f"type a number{self.in_unit}"
            case "text":
                return ""

    def moves_after(self, answer: str) -> bool:
        """Return whether the arm moves after an answer."""
        if self.kind == "confirm":
            return self.motion and answer == "yes"
        return self.motion and answer not in self.resting_answers


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


@dataclass(frozen=True)
class Stepped:
    """A relative motion of an axis, or along a line.

    Attributes:
        before: measured joints that the increment was added to, as they were looked at just before.
        commanded: signed increment that was commanded, deg or mm; along a line its length.
        sent_s: bench seconds when it was sent.
        ended_s: bench seconds when the motion was over.
        after: measured joints then.
    """

    before: Pose
    commanded: float
    sent_s: float
    ended_s: float
    after: Pose


class Context(Protocol):
    """The engine as a procedure sees it. Every call is a checkpoint of the stop ladder."""

    @property
    def resumed(self) -> bool:
        """The run goes on after an interruption: arm and beam are not where the last stored step left them."""
        ...

    @property
    def rehearsing(self) -> bool:
        """Nothing is measured: values are those of an ideal bench, and say nothing against stored ones."""
        ...

    @property
    def clock_s(self) -> float:
        """Bench seconds now; they count from an origin of their own in every process."""
        ...

    @property
    def waited_s(self) -> float:
        """Bench seconds that the run stood still so far, in this process: held, suspended or with a question open."""
        ...

    @property
    def set_up_lost(self) -> bool:
        """Somebody has moved what the run had set up, before it was resumed: what is needed is to be set up anew."""
        ...

    def is_done(self, step_id: str) -> bool:
        """Return whether a step is stored, in this process or before it: its action does not run again."""
        ...

    async def step(self, step_id: str, title: str, action: Callable[[], Awaitable[Row]]) -> Row:
        """Run a step once.

        A step that is done already returns its stored result and the action does not run. Rows recorded
        during the action and the completion of the step are stored in one transaction.
        """
        ...

    def record(self, record: Record) -> None:
        """Keep a record; it becomes durable with the step that is under way.

        Raises:
            RuntimeError: no step is under way, or the procedure does not declare this type of records.
            ValueError: a value is not finite or not of its column's type.
        """
        ...

    async def checkpoint(self) -> None:
        """Let a hold or a stop take effect here."""
        ...

    async def move(self, target: Pose) -> None:
        """Interpolate the joints to a target through the limit gate and wait for standstill.

        Raises:
            ArmMovedError: somebody moved the arm while the run was held or suspended; nothing is driven.
        """
        ...

    async def follow(self, way: Sequence[Pose]) -> None:
        """Move through joint targets and wait for standstill at the last one.

        The robot stands still at each target, passes it or is led through it, as its driver can.

        Raises:
            ArmMovedError: somebody moved the arm while the run was held or suspended; the rest is not driven.
        """
        ...

    async def step_axis(self, axis: str, increment: float) -> Stepped:
        """Turn or shift one axis by an increment to its measured position; wait for standstill.

        The controller adds the increment. Where it cannot, the program does, and rounds to what it can command. A
        step is sent once: one that was cut short is not completed.

        Args:
            axis: its name.
            increment: deg or mm, signed.

        Raises:
            StepCutShortError: the surroundings stopped the arm on the way.
            ArmMovedError: somebody moved the arm while the run was held or suspended; nothing is driven.
        """
        ...

    async def step_to(self, target: Pose) -> Stepped:
        """Drive one axis a little, to a pose of its own, as `step_axis` drives it by an increment.

        Args:
            target: pose; only one axis differs from where the arm was sent before.
        """
        ...

    async def step_line(self, increment_mm: tuple[float, float, float]) -> Stepped:
        """Shift the tool along a straight line of the base frame, orientation kept; as `step_axis` else.

        Args:
            increment_mm: x, y, z.
        """
        ...

    async def torques(self) -> tuple[float, ...]:
        """Return the motor torques of the axes, N m.

        Raises:
            RefusedError: the controller states none.
        """
        ...

    def recording(self, name: str, rate_hz: float = 25.0) -> AbstractAsyncContextManager[Recording]:
        """Record the length counter while the body runs: every reading, as it comes.

        Readings are stored as they come. They count when the step that is under way is done; the procedure declares
        `catseye.procedures.kit.recording.Recorded`.

        Args:
            name: unique in the step.
            rate_hz: at which a counter is asked that sends nothing by itself; others come as the instrument sends.

        Raises:
            RuntimeError: no step is under way, or another recording is.
            DeviceError: the instrument failed.
        """
        ...

    async def joints(self) -> Pose:
        """Return the reported joints."""
        ...

    async def led_joints(self, rehearsed: Pose) -> Pose:
        """Return the reported joints of an arm that a person has led somewhere.

        Args:
            rehearsed: what a rehearsal, in which nobody leads the arm, goes on with.
        """
        ...

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Settle, then average readings over the dwell time; read beam state, joints and air.

        Raises:
            NoBeamError: the instrument gives no value without a beam.
        """
        ...

    async def beam(self) -> BeamStatus:
        """Return the state of the beam now."""
        ...

    async def zero(self, dead_path_mm: float) -> None:
        """Zero the count: a new dead path begins.

        Args:
            dead_path_mm: length of the beam here, mm.

        Raises:
            NoBeamError: no beam returns, and the instrument does not zero without one.
        """
        ...

    async def locate(self, settle_time_s: float, commanded_mm: tuple[float, float]) -> Position:
        """Return where an independent instrument (a laser tracker) sees its target after settling.

        Args:
            settle_time_s: standstill before the measurement.
            commanded_mm: x and y of the target in the arm's frame by its commands, which an ideal instrument sees.
        """
        ...

    async def measure_target(
        self, target: str, settle_time_s: float, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Settle, then have the tracker measure a target.

        Args:
            target: its name.
            dwell_s: time over which the instrument averages.
            near_mm: roughly where it is, in the instrument's frame; None where the instrument is aimed at it.
            face: in which.

        Raises:
            HiddenTargetError: the target is not seen; it can be tried again.
        """
        ...

    async def measure_frame(self, target: str, settle_time_s: float, dwell_s: float) -> TargetPose:
        """Settle, then have an optical CMM measure a frame; as `measure_target` else."""
        ...

    async def remounted(self, turned_deg: float) -> None:
        """Take note of how what the arm carries is mounted from now on.

        Args:
            turned_deg: angle about the last axis against its mounting at the beginning of the run.
        """
        ...

    async def pause(self, duration_s: float) -> None:
        """Let the arm stand still for a time, s."""
        ...

    async def read_table(
        self, file: str, table: "TableRule | TableMapping", rehearsed: "Columns"
    ) -> "Columns":
        """Return what a file holds that the operator names.

        Args:
            file: its path, as an operator types it.
            table: what its header may hold, or how a file of another program is read.
            rehearsed: what a rehearsal, which has no file, goes on with.

        Raises:
            TableFileError: the file cannot be read or used; the text names file, line and remedy.
        """
        ...

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Put a question to the operator and wait for the answer.

        Args:
            watch: reads a value that is shown again and again until the answer is there; it must not move the robot.
        """
        ...

    def show(self, live: Live) -> None:
        """Show a value with its acceptance band now."""
        ...

    async def wait_until(self, reason: str, back: Callable[[], Awaitable[bool]]) -> None:
        """Suspend the run until a condition is back: nothing moves meanwhile.

        Args:
            reason: what is wrong and what to do about it.
            back: looks whether the condition is back; it must not move the robot.
        """
        ...

    async def event(self, kind: str, **data: Json) -> None:
        """Store and publish something that happened."""
        ...

    async def warn(self, text: str, **data: Json) -> None:
        """Store and publish a warning with its remedy."""
        ...

    def progress(self, done: float, total: float, text: str = "") -> None:
        """Publish how far the run is; done and total in expected bench seconds."""
        ...
