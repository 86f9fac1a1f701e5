"""The same procedure without instruments: what it would do, how long it takes, whether limits hold."""

from collections.abc import AsyncIterator, Awaitable, Callable, Collection, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta

import numpy as np

from catseye.app.engine.driven import AT_REST, Speeds, sampled, speeds_of
from catseye.app.engine.dry_account import Account, IdealRecording
from catseye.app.engine.gate import require_in_range
from catseye.app.engine.measuring import dwell_interval_s
from catseye.app.engine.recording import require_recordable, require_result
from catseye.app.engine.walked.tube import Leg, legs_through
from catseye.app.errors import LimitError, MeasurementRejectedError
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.tracker import Face, Place, Position, TargetPoint, TargetPose
from catseye.procedures.kit.bench import Arm
from catseye.procedures.kit.columns import Columns, TableRule
from catseye.procedures.kit.context import Measurement, Prompt, Stepped
from catseye.procedures.kit.ideal import Hit, SteadyBeam
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.mapping import TableMapping
from catseye.procedures.kit.motion.clear_way import legs_refusal
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.kit.motion.steps import (
    STEP_SPEED,
    Vector,
    axis_target,
    largest_change,
    length_mm,
    line_target,
    step_time_s,
)
from catseye.procedures.kit.recording import Recorded, Recording
from catseye.procedures.kit.records import Json, Record, Row
from catseye.procedures.kit.system import System
from catseye.procedures.kit.tasks import MountOptics

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)

_MOST_QUESTIONS = 50
"""So many questions with nothing done between them are a loop that no answer ends."""

_AIR = AirSample(20.0, 1013.25, 50.0)
"""Reference conditions of length metrology."""


@dataclass
class DryStep:
    """One line of the step table.

    Attributes:
        step_id: stable name within the run.
        title: what it does.
        moves: how many motions.
        measurements: how many distances, or measurements of targets and nests.
        duration_s: expected time, s.
        first: where its first motion ends; None of one without motions.
        end: pose at its end.
        speeds: the fastest that it drives.
        beam_mm: length of the beam at its end; None when nothing returns it.
        miss_mm: largest miss on the ways over which the beam is kept; None when it is kept on none.
    """

    step_id: str
    title: str
    moves: int
    measurements: int
    duration_s: float
    first: Pose | None
    end: Pose
    speeds: Speeds
    beam_mm: float | None
    miss_mm: float | None


@dataclass
class DryRunContext:
    """Implements `catseye.procedures.kit.context.Context` for an ideal arm.

    Attributes:
        system: knows how long moves take and where the beam goes; the limits of its axes are checked at every move.
        declared: types of records that the procedure declares.
        pose: where the arm stands; set it to where it starts.
        done: results of steps that an interrupted run has done; they are not rehearsed.
        steps: the step table, filled while the procedure runs.
        prompts: the questions that were asked.
        asked_s: the expected time at which each was.
        notes: events and warnings, as (kind, data).
        records: what was recorded.
        motions: every straight joint motion.
        ideal: the beam, where the arm carries one.
    """

    system: System
    pose: Pose
    declared: Collection[type[Record]] = ()
    steps: list[DryStep] = field(default_factory=list)
    prompts: list[Prompt] = field(default_factory=list)
    asked_s: list[float] = field(default_factory=list)
    notes: list[tuple[str, dict[str, Json]]] = field(default_factory=list)
    records: list[Record] = field(default_factory=list)
    done: Mapping[str, Row] = field(default_factory=dict)
    motions: list[Leg] = field(default_factory=list)
    _account: Account = field(default_factory=Account)
    _in_step: bool = False
    _lost: bool = False
    _zeroed: Hit | None = None
    _way_miss_mm: float | None = None
    _questions: int = 0
    _start: Pose | None = None
    _driven: list[tuple[Pose, ...]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Make the ideal beam."""
        self.ideal = self.system.ideal_beam()

    @property
    def _arm(self) -> Arm:
        return self.system.bench.arm

    @property
    def resumed(self) -> bool:
        """A rehearsal begins at the beginning, unless some steps are done."""
        return bool(self.done)

    @property
    def rehearsing(self) -> bool:
        """Every value comes from the plan."""
        return True

    @property
    def set_up_lost(self) -> bool:
        """Nobody moves anything before a rehearsal."""
        return False

    @property
    def total_s(self) -> float:
        """Expected time of everything so far, s."""
        return self._account.time_s

    @property
    def excess(self) -> list[DryStep]:
        """Steps on whose ways the beam misses by more than the plan allows itself."""
        limit_mm = self.ideal.max_miss_mm
        return [step for step in self.steps if step.miss_mm is not None and step.miss_mm > limit_mm]

    @property
    def clock_s(self) -> float:
        """Expected time of everything so far, s."""
        return self.total_s

    @property
    def waited_s(self) -> float:
        """Nobody is waited for."""
        return 0.0

    def is_done(self, step_id: str) -> bool:
        """Return whether a step was done before the rehearsal."""
        return step_id in self.done

    async def step(self, step_id: str, title: str, action: Callable[[], Awaitable[Row]]) -> Row:
        """Run a step and add its line to the table; one that is done returns its stored result."""
        if self._in_step:
            raise RuntimeError(f"step {step_id} begins inside another one; steps do not nest")
        if step_id in self.done:
            return self.done[step_id]
        before, driven = self._account, len(self._driven)
        self._account = replace(before, speeds=AT_REST, miss_mm=None)
        self._in_step = True
        try:
            result = await action()
            require_result(step_id, result)
        finally:
            self._in_step = False
        now = self._account
        seen = self.ideal.hit(self.pose)
        step = DryStep(
            step_id,
            title,
            moves=now.moves - before.moves,
            measurements=now.measurements - before.measurements,
            duration_s=now.time_s - before.time_s,
            first=next((way[-1] for way in self._driven[driven:]), None),
            end=self.pose,
            speeds=now.speeds,
            beam_mm=None if seen is None else seen.length_mm,
            miss_mm=now.miss_mm,
        )
        self.steps.append(step)
        return result

    def record(self, record: Record) -> None:
        """Check and keep a record.

        Raises:
            RuntimeError: no step is under way, or the procedure does not declare this type of records.
            ValueError: the record does not fit its table.
        """
        require_recordable(record, self.declared, in_step=self._in_step)
        self.records.append(record)

    async def checkpoint(self) -> None:
        """Return at once: nobody holds a dry run."""

    async def move(self, target: Pose) -> None:
        """Check the limits and account for the time; the beam may break on the way.

        Raises:
            LimitError: the target is outside the limits.
        """
        await self.follow((target,))

    async def follow(self, way: Sequence[Pose]) -> None:
        """Account for every target of a way.

        Raises:
            LimitError: a target is outside the limits.
        """
        if not way:
            return
        for target in way:
            require_in_range(self._arm.axes, target)
        self._start = self._start or self.pose
        account = self._account
        account.time_s += way_time_s(self._arm, np.array([self.pose, *way]))
        account.moves += len(way)
        self._driven.append(tuple(way))
        account.speeds = account.speeds.faster(speeds_of(self.system, self.pose, way))
        self._watch_beam(way)
        self.motions += legs_through(self.pose, way, blended=self._arm.following == "blended")
        self.pose = way[-1]
        self._questions = 0

    async def step_axis(self, axis: str, increment: float) -> Stepped:
        """Drive to where a step ends.

        Raises:
            LimitError: that is outside the limits.
        """
        return await self._step(axis_target(self._arm.axes, self.pose, axis, increment), increment)

    async def step_to(self, target: Pose) -> Stepped:
        """Drive to where a step ends.

        Raises:
            LimitError: that is outside the limits.
        """
        return await self._step(target, largest_change(self.pose, target))

    async def step_line(self, increment_mm: Vector) -> Stepped:
        """Drive to where a straight step ends.

        Raises:
            LimitError: that is outside the limits.
            PlanError: the arm cannot make it.
        """
        target = line_target(self.system.bench, self.pose, increment_mm)
        return await self._step(target, length_mm(increment_mm), line=True)

    async def _step(self, target: Pose, commanded: float, *, line: bool = False) -> Stepped:
        before, sent_s, peaks = self.pose, self._account.time_s, self._account.speeds
        self._account.speeds = AT_REST
        await self.move(target)
        # Steps are driven slowly, whatever the axes can do.
        full = self._account.speeds
        fastest = full.tool_mm_s if line else full.joint_deg_s
        self._account.speeds = peaks.faster(full.slowed(STEP_SPEED / fastest if fastest else 1.0))
        self._account.time_s = max(self._account.time_s, sent_s + step_time_s(commanded))
        return Stepped(before, commanded, sent_s, self._account.time_s, self.pose)

    async def torques(self) -> tuple[float, ...]:
        """Return none of any axis: an ideal arm weighs nothing."""
        return (0.0,) * len(self._arm.axes)

    @asynccontextmanager
    async def recording(self, name: str, rate_hz: float = 25.0) -> AsyncIterator[Recording]:
        """Account for a recording without keeping any reading."""
        if not self._in_step:
            raise RuntimeError(f"recording {name} begins outside of a step; it could never count")
        recording = IdealRecording(name, self._account.time_s, rate_hz, self._account)
        origin_utc = self._now()
        yield recording
        self.record(
            Recorded(
                name=name,
                method="polled",
                origin_utc=origin_utc,
                origin_clock_s=recording.origin_s,
                readings=recording.readings,
                chunks=0,
                crc32=0,
                duration_s=recording.elapsed_s,
                rate_hz=rate_hz,
                asked_hz=rate_hz,
                jitter_s=0.0,
                longest_gap_s=1.0 / rate_hz,
                late=0,
                lost=0,
                beam_lost=int((await self.beam()).interrupted),
                overspeed=0,
                values_lost=0,
                scale=1.0,
                offset_mm=0.0,
            )
        )

    def require_clear_ways(self) -> None:
        """Check the bodies of the arm over all that was driven: at once, which is much faster than way by way.

        Raises:
            LimitError: names the bodies and the first target on the way to which they come too near.
        """
        if self._start is None:
            return
        if (blocked := legs_refusal(self._start, self._driven, self.system.bench)) is not None:
            raise LimitError(blocked)

    def _watch_beam(self, way: Sequence[Pose]) -> None:
        """Note by how much the beam misses on a way the target that it was zeroed on."""
        if self._zeroed is None:
            self._lost = True
            return
        watched = self.ideal.watch(sampled(self.pose, way), self._zeroed.target)
        self._lost = self._lost or not watched.kept
        if watched.miss_mm is not None:
            self._way_miss_mm = max(self._way_miss_mm or 0.0, watched.miss_mm)

    async def joints(self) -> Pose:
        """Return the pose."""
        return self.pose

    async def led_joints(self, rehearsed: Pose) -> Pose:
        """Return what is rehearsed: the arm itself is not moved."""
        return rehearsed

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the ideal distance and account for settling and dwell."""
        time_utc, clock_s = self._now(), self._account.time_s
        dwell_s = dwell_interval_s(dwell_time_s, readings) * (readings - 1)
        self._account.time_s += settle_time_s + dwell_s
        self._account.measurements += 1
        self._questions = 0
        self._claim_way()
        seen = self.ideal.hit(self.pose)
        zero_mm = 0.0 if self._zeroed is None else self._zeroed.length_mm
        return Measurement(
            displacement_mm=0.0 if seen is None else seen.length_mm - zero_mm,
            spread_mm=0.0,
            readings=readings,
            beam=await self.beam(),
            reported=self.pose,
            air=_AIR,
            time_utc=time_utc,
            duration_s=dwell_s,
            clock_s=clock_s,
        )

    async def beam(self) -> BeamStatus:
        """Return the state of the ideal beam."""
        hit = self.ideal.hit(self.pose) is not None
        return BeamStatus(
            beam_ok=hit, beam_lost=self._lost, overspeed=False, laser_ready=True, signal=1.0 if hit else 0.0
        )

    async def zero(self, dead_path_mm: float) -> None:
        """Begin a new dead path; an ideal distance needs no correction for it."""
        del dead_path_mm
        self._zeroed = self.ideal.hit(self.pose)
        self._lost = self._zeroed is None
        # Nobody needed the beam on the way here.
        self._way_miss_mm = None

    async def locate(self, settle_time_s: float, commanded_mm: tuple[float, float]) -> Position:
        """Account for settling; the frame of an ideal instrument is that of the arm."""
        self._measured_in(settle_time_s)
        return Position(*commanded_mm, 0.0)

    async def measure_target(
        self, target: str, settle_time_s: float, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Account for settling and dwell; an ideal arm has its targets where they are looked for."""
        del target, face
        self._measured_in(settle_time_s + dwell_s)
        return TargetPoint(near_mm or (0.0, 0.0, 0.0))

    async def measure_frame(self, target: str, settle_time_s: float, dwell_s: float) -> TargetPose:
        """Account for settling and dwell; a dry run does not know the instrument's frame."""
        del target
        self._measured_in(settle_time_s + dwell_s)
        return TargetPose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    async def remounted(self, turned_deg: float) -> None:
        """Let the ideal beam leave as it does then."""
        self.ideal = self.system.turned(turned_deg).ideal_beam()

    async def pause(self, duration_s: float) -> None:
        """Account for the time."""
        self._account.time_s += duration_s

    async def read_table(self, file: str, table: TableRule | TableMapping, rehearsed: Columns) -> Columns:
        """Return what the procedure goes on with where there is no file."""
        del file, table
        return rehearsed

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Keep the question and return the answer that goes on: nothing moves in a rehearsal.

        Raises:
            MeasurementRejectedError: questions follow each other for ever.
        """
        self.prompts.append(prompt)
        if isinstance(prompt.task, MountOptics):
            self.ideal = SteadyBeam()
        self.asked_s.append(self.total_s)
        self._questions += 1
        if self._questions > _MOST_QUESTIONS:
            raise MeasurementRejectedError(
                f"the rehearsal is asked {prompt.id!r} after {_MOST_QUESTIONS} other questions with nothing done "
                "between them: no answer ends this on an ideal bench"
            )
        if watch is not None:
            await watch()
        possible = ("yes", *prompt.choices, prompt.safe_answer or "", "0")
        return next(text for text in possible if text and not prompt.fault_of(text))

    def show(self, live: Live) -> None:
        """Do nothing: nobody watches."""

    async def wait_until(self, reason: str, back: Callable[[], Awaitable[bool]]) -> None:
        """Keep what was missing: on an ideal bench it will not come back by waiting.

        Raises:
            MeasurementRejectedError: the condition does not hold.
        """
        if not await back():
            raise MeasurementRejectedError(f"the rehearsal waits for ever: {reason}")

    async def event(self, kind: str, **data: Json) -> None:
        """Keep what happened."""
        self.notes.append((kind, data))

    async def warn(self, text: str, **data: Json) -> None:
        """Keep a warning."""
        self.notes.append(("warning", {"text": text, **data}))

    def progress(self, done: float, total: float, text: str = "") -> None:
        """Do nothing: a dry run is over at once."""

    def _measured_in(self, duration_s: float) -> None:
        """Account for a measurement of the independent instrument."""
        self._account.time_s += duration_s
        self._account.measurements += 1
        self._questions = 0

    def _claim_way(self) -> None:
        """Count the miss of the way to this distance: it was measured over it."""
        if self._way_miss_mm is not None and self._zeroed is not None:
            self._account.miss_mm = max(self._account.miss_mm or 0.0, self._way_miss_mm)
        self._way_miss_mm = None

    def _now(self) -> str:
        return (_EPOCH + timedelta(seconds=self._account.time_s)).isoformat()
