"""The steps of a run: each runs once, and what it records becomes durable when it is done."""

from collections.abc import Awaitable, Callable, Collection
from dataclasses import dataclass, field

from catseye.app.engine.announcer import Announcer
from catseye.app.engine.recording import require_recordable, require_result, rows_of
from catseye.app.engine.timekeeping import StepTime
from catseye.app.engine.waiting import uncancelled
from catseye.app.files.crash_points import crash_point
from catseye.app.protocol.run_events import PointMeasured, StepDone, StepStarted
from catseye.app.store.chunks import Key
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.records import Record, Row, row_of


@dataclass
class _OpenStep:
    step_id: str
    title: str
    attempt: int
    started_utc: str
    time: StepTime
    records: list[Record] = field(default_factory=list)


class RunSteps:
    """Runs steps one after the other and stores them.

    Args:
        announcer: publishes to front ends.
        declared: types of the records that the procedure keeps.

    Attributes:
        times: where the time of each step that ran went.
    """

    def __init__(
        self, store: RunStore, announcer: Announcer, clock: Clock, declared: Collection[type[Record]]
    ) -> None:
        self.times: list[StepTime] = []
        self._store = store
        self._announcer = announcer
        self._clock = clock
        self._declared = declared
        self._open: _OpenStep | None = None

    async def run(self, step_id: str, title: str, action: Callable[[], Awaitable[Row]]) -> Row:
        """Run a step once; one that is done returns its stored result.

        Raises:
            RuntimeError: another step is under way.
        """
        if self._open is not None:
            raise RuntimeError(f"step {step_id} begins inside step {self._open.step_id}; steps do not nest")
        stored = self._store.stored_result(step_id)
        if stored is not None:
            self._announcer.publish(StepDone(step=step_id, title=title, stored=True))
            return stored
        self._open = self._begin(step_id, title)
        try:
            return await self._run(self._open, action)
        finally:
            self._open = None

    def record(self, record: Record) -> None:
        """Keep a record until the step under way is done.

        Raises:
            RuntimeError: no step is under way, or the procedure does not declare this type of records.
            ValueError: the record does not fit its table.
        """
        require_recordable(record, self._declared, in_step=self._open is not None)
        if self._open is not None:
            self._open.records.append(record)

    def key(self, recording: str) -> Key:
        """Return what a recording of the step under way is stored under.

        Raises:
            RuntimeError: no step is under way.
        """
        if self._open is None:
            raise RuntimeError(f"recording {recording} begins outside of a step; it could never count")
        return (self._open.step_id, self._open.attempt, recording)

    def moved(self, duration_s: float) -> None:
        """Count a time inside motions to the step under way."""
        if self._open is not None:
            self._open.time.motion_s += duration_s

    def waited(self, duration_s: float) -> None:
        """Count a time of settling or dwelling to the step under way."""
        if self._open is not None:
            self._open.time.idle_s += duration_s

    def _begin(self, step_id: str, title: str) -> _OpenStep:
        attempt = self._store.next_attempt(step_id)
        self._announcer.publish(StepStarted(step=step_id, title=title, attempt=attempt))
        time = StepTime(step_id, self._clock.monotonic_s())
        return _OpenStep(step_id, title, attempt, self._clock.now_utc().isoformat(), time)

    async def _run(self, step: _OpenStep, action: Callable[[], Awaitable[Row]]) -> Row:
        try:
            result = await action()
            require_result(step.step_id, result)
        except BaseException as error:
            await uncancelled(self._drop(step, error))
            raise
        crash_point("before-commit")
        await self._store.append_step(
            step.step_id,
            step.attempt,
            step.title,
            result,
            rows_of(step.records),
            started_utc=step.started_utc,
        )
        crash_point("after-commit")
        self._account(step)
        for record in step.records:
            if record.is_point:
                self._announcer.publish(PointMeasured(step=step.step_id, point=dict(row_of(record))))
        self._announcer.publish(StepDone(step=step.step_id, title=step.title, stored=False))
        return result

    async def _drop(self, step: _OpenStep, error: BaseException) -> None:
        # After a storage failure nothing can be stored; the error that is under way says so already.
        if self._store.failure is None:
            text = f"{type(error).__name__}: {error}".removesuffix(": ")
            await self._store.drop_step(
                step.step_id, step.attempt, {"error": text, "rows": len(step.records)}
            )

    def _account(self, step: _OpenStep) -> None:
        step.time.total_s = self._clock.monotonic_s() - step.time.start_s
        step.time.points = sum(record.is_point for record in step.records)
        self.times.append(step.time)
