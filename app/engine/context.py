"""What a procedure is given on the bench: every call passes the stop ladder, every move the gate."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Collection, Sequence
from contextlib import asynccontextmanager
from dataclasses import asdict
from typing import TypeVar

from catseye.app.cell.model import Air
from catseye.app.engine.acknowledging import Acknowledging
from catseye.app.engine.announcer import Announcer
from catseye.app.engine.control import RunControl
from catseye.app.engine.devices import Devices
from catseye.app.engine.gate import MotionGate
from catseye.app.engine.length_meter import LengthMeter
from catseye.app.engine.mover import Mover
from catseye.app.engine.operator import Answer, Operator
from catseye.app.engine.run_steps import RunSteps
from catseye.app.engine.stepping import LineTarget, axis_step, line_step, pose_step
from catseye.app.engine.timekeeping import Progress, StepTime
from catseye.app.engine.waiting import cancel, uncancelled
from catseye.app.errors import ConfigError, UnwalkedError, UsageError
from catseye.app.files.columns import read_typed_table
from catseye.app.files.crash_points import crash_point
from catseye.app.protocol.bench import AxisName
from catseye.app.protocol.prompts import MotionAfter
from catseye.app.protocol.run_events import (
    FirstMotionData,
    FirstMotionShown,
    Happened,
    LiveData,
    LiveShown,
    Progressed,
    PromptAnswered,
    PromptAsked,
    WarningData,
    WarningIssued,
)
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Axes, Pose
from catseye.drivers.roles.tracker import Face, Place, Position, TargetPoint, TargetPose, Tracker
from catseye.procedures.kit.columns import Columns, TableRule
from catseye.procedures.kit.context import Measurement, Prompt, Stepped
from catseye.procedures.kit.errors import TableFileError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.mapping import TableMapping
from catseye.procedures.kit.motion.steps import Vector
from catseye.procedures.kit.recording import Recording
from catseye.procedures.kit.records import Json, Record, Row

_DEFAULT_AIR = Air()

T = TypeVar("T")

_WATCH_S = 0.2
"""Real seconds between two looks at a value that is shown beside a question."""


class RunContext:
    """Implements `catseye.procedures.kit.context.Context` with real or emulated instruments.

    Args:
        announcer: publishes to front ends.
        line_target: returns where a straight shift of the tool ends.
        air: how the program corrects for the air where the instrument does not.
        poll_s: between two looks at a condition that is missing, s of the clock.
        speed: bench seconds in one real second.

    Attributes:
        on_remounted: called with the angle by which what the arm carries is turned, deg, when that changes.
        set_up_lost: somebody has moved what the run had set up, before it was resumed.
    """

    def __init__(
        self,
        devices: Devices,
        store: RunStore,
        control: RunControl,
        clock: Clock,
        axes: Axes,
        gate: MotionGate,
        operator: Operator,
        announcer: Announcer,
        line_target: LineTarget,
        air: Air = _DEFAULT_AIR,
        poll_s: float = 0.5,
        records: Collection[type[Record]] = (),
        speed: float = 1.0,
    ) -> None:
        self.on_remounted: Callable[[float], None] = lambda _turned_deg: None
        self.set_up_lost = False
        self._devices = devices
        self._store = store
        self._control = control
        self._clock = clock
        self._axes = axes
        self._gate = gate
        self._operator = operator
        self._announcer = announcer
        self._steps = RunSteps(store, announcer, clock, records)
        self._lengths = LengthMeter(devices, clock, air, self.warn, self._steps.waited)
        self._progress = Progress(clock, speed)
        self._asked_s = 0.0
        self._poll_s = poll_s
        self._looking = 0
        self._mover = Mover(
            devices.robot,
            axes,
            control,
            gate,
            clock,
            self.wait_until,
            self._timed,
            self._waive,
            self._first_motion,
        )
        self._line_target = line_target
        self._acknowledging = Acknowledging(
            control, gate, devices.guard, clock, poll_s, self._ask_to_go_on, self.warn
        )
        control.on_interrupted = self._acknowledge

    @property
    def step_times(self) -> list[StepTime]:
        """Where the time of each step that ran went."""
        return self._steps.times

    @property
    def resumed(self) -> bool:
        """The run goes on after an interruption."""
        return self._store.resumed

    @property
    def rehearsing(self) -> bool:
        """The devices of the bench are measured with."""
        return False

    @property
    def clock_s(self) -> float:
        """Bench seconds now."""
        return self._clock.monotonic_s()

    @property
    def waited_s(self) -> float:
        """Bench seconds held, suspended or with a question open so far."""
        return self._control.wait_time.idle_s + self._asked_s

    def is_done(self, step_id: str) -> bool:
        """Return whether a step is stored."""
        return self._store.stored_result(step_id) is not None

    async def step(self, step_id: str, title: str, action: Callable[[], Awaitable[Row]]) -> Row:
        """Run a step once; one that is done returns its stored result.

        Raises:
            RuntimeError: another step is under way.
        """
        await self._control.checkpoint()
        return await self._steps.run(step_id, title, action)

    def record(self, record: Record) -> None:
        """Keep a record until the step under way is done.

        Raises:
            RuntimeError: no step is under way, or the procedure does not declare this type of records.
            ValueError: the record does not fit its table.
        """
        self._steps.record(record)

    async def checkpoint(self) -> None:
        """Let a hold or a stop take effect here.

        A look at the bench during a question or a suspension waits for neither.
        """
        if self._lengths.recorder is not None:
            self._lengths.recorder.require_going_on()
        if self._looking:
            self._control.raise_ending()
        else:
            await self._control.checkpoint()

    async def move(self, target: Pose) -> None:
        """Move through the gate and wait for standstill.

        Raises:
            LimitError: the target is outside the limits.
            SafetyError: the controller may not move.
            ArmMovedError: the arm was moved while the run was held or suspended.
        """
        await self._mover.drive((target,))

    async def follow(self, way: Sequence[Pose]) -> None:
        """Move through targets; a robot that cannot pass them stands still at each.

        Raises:
            LimitError: a target is outside the limits; nothing of the way is driven.
            SafetyError: the controller may not move.
            ArmMovedError: the arm was moved while the run was held or suspended.
        """
        if self._devices.robot.abilities.following != "stops":
            await self._mover.drive(way)
            return
        for target in way:
            await self.move(target)

    async def step_axis(self, axis: str, increment: float) -> Stepped:
        """Step one axis through the gate; see the protocol.

        Raises:
            LimitError: the step is too large, or may end outside the limits.
            SafetyError: the controller may not move.
            StepCutShortError: the arm was stopped on the way.
            ArmMovedError: the arm was moved while the run was held or suspended.
        """
        await self.checkpoint()
        return await self._mover.step(axis_step(self._devices.robot, self._axes, axis, increment))

    async def step_to(self, target: Pose) -> Stepped:
        """Step to a pose through the gate; raises as `step_axis` does."""
        await self.checkpoint()
        return await self._mover.step(pose_step(self._devices.robot, self._axes, target))

    async def step_line(self, increment_mm: Vector) -> Stepped:
        """Step along a straight line through the gate; raises as `step_axis` does."""
        await self.checkpoint()
        return await self._mover.step(line_step(self._devices.robot, self._line_target, increment_mm))

    async def torques(self) -> tuple[float, ...]:
        """Return the motor torques of the axes, N m."""
        await self.checkpoint()
        return await self._control.command(self._devices.robot.torques())

    @asynccontextmanager
    async def recording(self, name: str, rate_hz: float = 25.0) -> AsyncIterator[Recording]:
        """Record the length counter while the body runs; see the protocol.

        Raises:
            RuntimeError: no step is under way, or another recording is.
        """
        await self.checkpoint()
        key = self._steps.key(name)
        async with self._lengths.record(self._store, key, rate_hz, self.record) as recorder:
            yield recorder

    async def joints(self) -> Pose:
        """Return the reported joints."""
        await self.checkpoint()
        waits = self._control.waits
        here = await self._control.command(self._devices.robot.joints())
        self._mover.stands(here, waits)
        return here

    async def led_joints(self, rehearsed: Pose) -> Pose:
        """Return the reported joints; see `catseye.procedures.kit.context.Context.led_joints`."""
        del rehearsed
        return await self.joints()

    def stands(self, here: Pose) -> None:
        """Take note of where the arm stands before its first motion."""
        self._mover.stands(here, self._control.waits)

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Settle, then average readings over the dwell.

        Nobody watched the count before this process: until its first zero no reading is ok.
        """
        await self.checkpoint()
        return await self._control.command(self._measure(settle_time_s, dwell_time_s, readings))

    async def beam(self) -> BeamStatus:
        """Return the state of the beam now."""
        await self.checkpoint()
        return await self._control.command(self._lengths.status())

    async def zero(self, dead_path_mm: float) -> None:
        """Zero the count.

        Raises:
            MeasurementRejectedError: the program has to correct for the air and does not know it.
            NoBeamError: no beam returns, and the instrument does not zero without one.
        """
        await self._control.checkpoint()
        # The count may be new and the air at its zero unknown, if this does not come to its end.
        self._lengths.zeroed = False
        number = await self._control.command(self._lengths.zero(dead_path_mm))
        self._lengths.zeroed = True
        crash_point("zeroed")
        await self.event("zero", number=number, dead_path_mm=dead_path_mm)

    async def locate(self, settle_time_s: float, commanded_mm: tuple[float, float]) -> Position:
        """Return where the independent instrument sees its target after settling; see the protocol.

        Raises:
            ConfigError: the cell has none.
        """
        del commanded_mm
        found = await self._settled(settle_time_s, lambda tracker: tracker.locate())
        return Position(found.x_mm, found.y_mm, found.u_mm)

    async def measure_target(
        self, target: str, settle_time_s: float, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Settle, then have the tracker measure a target; see the protocol.

        Raises:
            ConfigError: the cell has none.
            HiddenTargetError: the target is not seen.
        """
        return await self._settled(
            settle_time_s, lambda tracker: tracker.point(target, dwell_s, near_mm, face)
        )

    async def measure_frame(self, target: str, settle_time_s: float, dwell_s: float) -> TargetPose:
        """Settle, then have an optical CMM measure a frame; raises as `measure_target` does."""
        return await self._settled(settle_time_s, lambda tracker: tracker.pose(target, dwell_s))

    async def remounted(self, turned_deg: float) -> None:
        """Store how what the arm carries is mounted from now on, for those who watch, too."""
        self.on_remounted(turned_deg)
        await self.event("mounted", turned_deg=turned_deg)

    async def pause(self, duration_s: float) -> None:
        """Let the arm stand still for a time, s."""
        await self.checkpoint()
        await self._control.command(self._sleep(duration_s))

    async def read_table(self, file: str, table: TableRule | TableMapping, rehearsed: Columns) -> Columns:
        """Return what a file holds that the operator names; see the protocol.

        Raises:
            TableFileError: the file cannot be read or used.
        """
        del rehearsed
        await self._control.checkpoint()
        try:
            # A file may lie on a disk that takes its time.
            return await asyncio.to_thread(read_typed_table, file, table)
        except UsageError as error:
            raise TableFileError(str(error)) from error

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Put a question to the operator; question and answer are stored.

        Args:
            watch: reads a value that is shown until the answer is there.

        Raises:
            PromptUnansweredError: nobody answered and there is no safe answer.
        """
        await self._control.checkpoint()
        if self._control.wait_time.asks:
            raise RuntimeError(f"prompt {prompt.id} is asked while another one is open")
        # Who answers may have been at the arm.
        self._control.waits += 1
        start_s = self._clock.monotonic_s() - self._control.wait_time.idle_s
        try:
            with self._control.wait_time.asking(prompt.id):
                return (await self._ask(prompt, watch)).text
        finally:
            self._asked_s += self._clock.monotonic_s() - self._control.wait_time.idle_s - start_s

    def show(self, live: Live) -> None:
        """Publish a value with its acceptance band; it is not stored."""
        self._announcer.publish(LiveShown(state=self._control.state, data=LiveData.of(live)))

    async def wait_until(self, reason: str, back: Callable[[], Awaitable[bool]]) -> None:
        """Suspend the run until a condition is back."""
        await self._control.suspended(reason, lambda: self._look(back), self._poll_s)

    async def event(self, kind: str, **data: Json) -> None:
        """Store and publish something that happened; possible in every state."""
        await self._store.event(kind, data)
        self._announcer.publish(Happened(state=self._control.state, kind=kind, data=data))

    async def warn(self, text: str, **data: Json) -> None:
        """Store and publish a warning; possible in every state."""
        await self._store.event("warning", {"text": text, **data})
        self._announcer.publish(WarningIssued(text=text, data=WarningData.model_validate(data)))

    def progress(self, done: float, total: float, text: str = "") -> None:
        """Publish how far the run is, with elapsed and remaining time."""
        left = self._progress.estimate(done, total, self.waited_s)
        self._announcer.publish(Progressed(done=done, total=total, text=text, **asdict(left)))

    def _motion_after(self) -> MotionAfter:
        """Return at which override the arm would move now, and how fast its revolute axes can be."""
        percent = self._gate.override_percent
        return MotionAfter(
            override_percent=percent,
            speed_deg_s=tuple(axis.speed * percent / 100.0 for axis in self._axes if axis.unit == "deg"),
            axes=self._axis_names,
        )

    @property
    def _axis_names(self) -> tuple[AxisName, ...]:
        return tuple(AxisName(name=axis.name, unit=axis.unit) for axis in self._axes)

    async def _look(self, look: Callable[[], Awaitable[T]]) -> T:
        """Look at the bench while the run waits."""
        self._looking += 1
        try:
            return await look()
        finally:
            self._looking -= 1

    async def _watched(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]]) -> Answer:
        """Show a value until the answer is there."""
        answer = asyncio.create_task(self._operator.answer(prompt))
        try:
            while not answer.done():
                self.show(await self._look(watch))
                await asyncio.wait({answer}, timeout=_WATCH_S)
            return answer.result()
        finally:
            await cancel(answer)

    async def _waive(self, error: UnwalkedError) -> None:
        await self._gate.waive(error, self, self._store)

    async def _first_motion(self, here: Pose | None, way: Sequence[Pose]) -> None:
        """Show where the arm is led from where it stands, before it moves."""
        data = FirstMotionData(stands=here, way=tuple(way), axes=self._axis_names)
        await self._store.event("first-motion", data.json_object())
        self._announcer.publish(FirstMotionShown(state=self._control.state, data=data))

    async def _acknowledge(self) -> None:
        """Ask whether the arm may move again; whoever was in the cell may have touched what the count rests on."""
        await self._acknowledging()
        self._lengths.zeroed = False

    async def _timed(self, motion: Awaitable[None]) -> None:
        start_s = self._clock.monotonic_s()
        crash_point("before-motion")
        await motion
        self._steps.moved(self._clock.monotonic_s() - start_s)

    async def _measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        await self._sleep(settle_time_s)
        return await self._lengths.measure(dwell_time_s, readings)

    async def _settled(self, settle_time_s: float, measure: Callable[[Tracker], Awaitable[T]]) -> T:
        """Let the arm settle, then ask the independent instrument."""
        await self.checkpoint()
        tracker = self._devices.tracker
        if tracker is None:
            raise ConfigError("this procedure needs a [tracker] and the cell file has none; add one")

        async def measured() -> T:
            await self._sleep(settle_time_s)
            start_s = self._clock.monotonic_s()
            found = await measure(tracker)
            self._steps.waited(self._clock.monotonic_s() - start_s)
            return found

        return await self._control.command(measured())

    async def _sleep(self, duration_s: float) -> None:
        start_s = self._clock.monotonic_s()
        await self._clock.sleep(duration_s)
        self._steps.waited(self._clock.monotonic_s() - start_s)

    async def _ask_to_go_on(self, prompt: Prompt) -> str:
        return (await self._ask(prompt, None)).text

    async def _ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None) -> Answer:
        asked_utc = self._clock.now_utc().isoformat()
        # The table of prompts takes answered ones; a question that a process dies over is known by this.
        await self._store.event("asked", {"id": prompt.id, "text": prompt.text, "asked_utc": asked_utc})
        self._announcer.publish(PromptAsked.of(prompt, self._motion_after()))
        crash_point("prompt-open")
        try:
            # A stop that came while the question was stored has dropped nothing: nobody would end the wait.
            self._control.raise_ending()
            asking = self._operator.answer(prompt) if watch is None else self._watched(prompt, watch)
            answer = await self._control.command(asking)
        except BaseException:
            if self._store.failure is None:
                await uncancelled(
                    self._store.prompt(prompt.id, prompt.kind, prompt.text, asked_utc, None, None)
                )
            raise
        await self._store.prompt(prompt.id, prompt.kind, prompt.text, asked_utc, answer.text, answer.who)
        if answer.done is not None:
            await self.event("hands", prompt=prompt.id, **answer.done)
        self._announcer.publish(PromptAnswered(id=prompt.id, answer=answer.text, who=answer.who))
        return answer
