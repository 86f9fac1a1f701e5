"""The same procedure without instruments: what it would do, how long it takes, whether limits hold."""

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta

import numpy as np

from app.engine.arm_model import Beam, poses_between
from app.engine.gate import JointLimits
from app.engine.measuring import dwell_interval_s
from app.engine.operator import fault_of
from app.errors import MeasurementRejectedError
from app.store.rows import encode
from procedures.bench import Arm
from procedures.context import Json, Live, Location, Measurement, Prompt, Row, Table
from procedures.devices import Joints
from procedures.motion_time import way_time_s

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


@dataclass(frozen=True)
class DryAir:
    """Reference conditions of length metrology."""

    temperature_c: float | None = 20.0
    pressure_hpa: float | None = 1013.25
    humidity_percent: float | None = 50.0


@dataclass(frozen=True)
class DryBeam:
    """State of an ideal beam."""

    beam_ok: bool
    beam_lost: bool
    signal: float
    overspeed: bool = False
    laser_ready: bool = True


@dataclass
class DryStep:
    """One line of the step table.

    Attributes:
        step_id: stable name within the run.
        title: what it does.
        moves: how many motions.
        measurements: how many distances.
        duration_s: expected time, s.
        end: pose at its end.
    """

    step_id: str
    title: str
    moves: int
    measurements: int
    duration_s: float
    end: Joints


@dataclass
class _Account:
    moves: int = 0
    measurements: int = 0
    time_s: float = 0.0


@dataclass
class DryRunContext:
    """Implements `procedures.context.Context` for an ideal arm.

    Attributes:
        limits: checked at every move.
        arm: tells how long moves take.
        beam_at: the ideal beam.
        pose: where the arm stands; set it to where it starts.
        steps: the step table, filled while the procedure runs.
        prompts: the questions that were asked.
        notes: events and warnings, as (kind, data).
        rows: what was recorded, as (table, row).
    """

    limits: JointLimits
    arm: Arm
    beam_at: Beam
    pose: Joints = (0.0, 0.0, 0.0, 0.0)
    steps: list[DryStep] = field(default_factory=list)
    prompts: list[Prompt] = field(default_factory=list)
    notes: list[tuple[str, dict[str, Json]]] = field(default_factory=list)
    rows: list[tuple[Table, Row]] = field(default_factory=list)
    _account: _Account = field(default_factory=_Account)
    _in_step: bool = False
    _lost: bool = False
    _zero_mm: float = 0.0

    @property
    def resumed(self) -> bool:
        """A rehearsal begins at the beginning."""
        return False

    @property
    def total_s(self) -> float:
        """Expected time of everything so far, s."""
        return self._account.time_s

    async def step(self, step_id: str, title: str, action: Callable[[], Awaitable[Row]]) -> Row:
        """Run a step and add its line to the table."""
        if self._in_step:
            raise RuntimeError(f"step {step_id} begins inside another one; steps do not nest")
        before = _Account(self._account.moves, self._account.measurements, self._account.time_s)
        self._in_step = True
        try:
            result = await action()
        finally:
            self._in_step = False
        now = self._account
        counts = (now.moves - before.moves, now.measurements - before.measurements)
        self.steps.append(DryStep(step_id, title, *counts, now.time_s - before.time_s, self.pose))
        return result

    def record(self, table: Table, row: Row) -> None:
        """Check and keep a row."""
        if not self._in_step:
            raise RuntimeError(
                f"a row for {table} was recorded outside of a step; it could not become durable"
            )
        encode(table, row)
        self.rows.append((table, dict(row)))

    async def checkpoint(self) -> None:
        """Return at once: nobody holds a dry run."""

    async def move(self, target: Joints) -> None:
        """Check the limits and account for the time; the beam may break on the way.

        Raises:
            LimitError: the target is outside the limits.
        """
        await self.follow((target,))

    async def follow(self, way: Sequence[Joints]) -> None:
        """Account for every target of a way.

        Raises:
            LimitError: a target is outside the limits.
        """
        poses = np.array([self.pose, *way])[:, [0, 1, 3]]
        for target in way:
            self.limits.require(target)
            between = poses_between(self.pose, target)
            self._lost = self._lost or any(self.beam_at(pose) is None for pose in between)
            self.pose = target
        self._account.time_s += way_time_s(self.arm, poses)
        self._account.moves += len(way)

    async def joints(self) -> Joints:
        """Return the pose."""
        return self.pose

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the ideal distance and account for settling and dwell."""
        time_utc = self._now()
        dwell_s = dwell_interval_s(dwell_time_s, readings) * (readings - 1)
        self._account.time_s += settle_time_s + dwell_s
        self._account.measurements += 1
        beam = await self.beam()
        return Measurement(
            displacement_mm=(self.beam_at(self.pose) or self._zero_mm) - self._zero_mm,
            spread_mm=0.0,
            readings=readings,
            signal=beam.signal,
            beam_ok=beam.beam_ok and not beam.beam_lost,
            reported=self.pose,
            air=DryAir(),
            time_utc=time_utc,
            duration_s=dwell_s,
        )

    async def beam(self) -> DryBeam:
        """Return the state of the ideal beam."""
        hit = self.beam_at(self.pose) is not None
        return DryBeam(beam_ok=hit, beam_lost=self._lost, signal=1.0 if hit else 0.0)

    async def zero(self, dead_path_mm: float) -> None:
        """Begin a new dead path; an ideal distance needs no correction for it."""
        del dead_path_mm
        length_mm = self.beam_at(self.pose)
        self._lost = length_mm is None
        self._zero_mm = length_mm or 0.0

    async def locate(self, settle_time_s: float) -> Location:
        """Account for settling; a dry run does not know the independent instrument's frame."""
        self._account.time_s += settle_time_s
        self._account.measurements += 1
        return Location(0.0, 0.0, 0.0)

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Keep the question and return its first possible answer."""
        del watch
        self.prompts.append(prompt)
        possible = (prompt.safe_answer or "", "yes", *prompt.choices, "0")
        return next(text for text in possible if text and not fault_of(prompt, text))

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

    def _now(self) -> str:
        return (_EPOCH + timedelta(seconds=self._account.time_s)).isoformat()
