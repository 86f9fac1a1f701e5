"""An engine in a process of its own: idle until a client starts a procedure, and again after it."""

import asyncio
import json
import logging
import signal
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.engine.announcer import Publish
from catseye.app.engine.handle import RunHandle
from catseye.app.engine.heap import settled_heap
from catseye.app.engine.request import RunOutcome
from catseye.app.engine.signals import loop_signals
from catseye.app.engine.states import Trigger, transition
from catseye.app.engine.waiting import uncancelled
from catseye.app.errors import InterruptedRunError, exit_code_of, text_of
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.answers import Answer, Opened
from catseye.app.protocol.engine_events import EmulatorsChanged, EngineIdle
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.procedures import load_procedure, parse_params
from catseye.app.protocol.requests import Emulate, ResetAlarm, Resume, Start
from catseye.app.protocol.run_events import ErrorReported, RunEvent, StateChanged
from catseye.app.protocol.state import ControlState
from catseye.app.service.address import socket_folder
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.engine_bench import EngineBench
from catseye.app.service.errors import RefusedError, refusal_of
from catseye.app.service.hooks import Hooks, RunHooks
from catseye.app.service.manual.drives import RestingDrives
from catseye.app.service.manual.manual_control import ManualControl
from catseye.app.service.metrics import MetricsFile
from catseye.app.service.owned_emulators import OwnedEmulators
from catseye.app.service.planned_walk import as_walk
from catseye.app.service.resumption import plan_resume
from catseye.app.service.run_metrics import metrics_of
from catseye.app.service.running import PlannedRun, carry_out, plan_run
from catseye.app.service.server import Server
from catseye.app.service.sparse_log import SparseLog
from catseye.drivers.roles.clock import SystemClock

_log = logging.getLogger(__name__)

_WAIT_POLL_S = 0.2


class EngineProcess:
    """Runs one procedure after another for its clients.

    Args:
        cell: cell file.
        root: folder of all runs.
        metrics: file that says how the newest run fares, as OpenMetrics text; None for none.

    Attributes:
        registry: of its clients.
        manual: what they do by hand between runs.
    """

    def __init__(self, cell: Path, root: Path, metrics: Path | None = None) -> None:
        self._clock = SystemClock()
        self._errors = SparseLog(_log, self._clock)
        self.registry = ClientRegistry(self._clock, waits=True)
        self._bench = EngineBench(self.registry, self._clock, cell, root)
        self.manual = ManualControl(self.registry, self._bench.for_hands(), self._require_idle, self._abort)
        self._drives = RestingDrives(
            self._bench.idle,
            self._clock,
            self._announce_drives,
            self.manual,
            self._bench.owned,
        )
        self._hooks = Hooks(self._clock)
        self._emulators = OwnedEmulators(cell, self.registry.announce, self._announce_emulators)
        self._server = Server(self.registry, self._clock, self, telemetry=self._bench.telemetry)
        self._cell = cell
        self._root = root
        self._metrics = metrics
        self._job: asyncio.Task[RunOutcome | None] | None = None
        self._once: asyncio.Task[RunOutcome] | None = None
        self._aborted = ""
        self._planning = False
        self._dropped = ""
        self._on_signal: Callable[[int], None] | None = None
        self._end: asyncio.Future[ExitCode] = asyncio.get_running_loop().create_future()
        self._facts()

    async def serve(self, ready: Callable[[], None], wait_for_client_s: float | None = None) -> ExitCode:
        """Serve until a client, a signal or the lack of clients ends the process.

        Args:
            ready: is called when clients can connect.
            wait_for_client_s: idle without any client for so long, real s, the engine ends; None for ever.

        Raises:
            ServiceError: another engine serves this folder of runs, or no socket can be made.
        """
        with loop_signals(self._deliver):
            async with self._server.at(self._root):
                waiting = asyncio.create_task(self._wait_for_clients(wait_for_client_s))
                try:
                    ready()
                    return await self._end
                finally:
                    waiting.cancel()
                    await uncancelled(self._finish())

    async def run_once(
        self, request: Start | Resume, opened: Callable[[Path], None], ready: Callable[[], None]
    ) -> RunOutcome:
        """Run one procedure for whoever attaches to it.

        Args:
            opened: takes the run's directory when its record is open.
            ready: is called when the devices are.

        Raises:
            ServiceError: nobody could attach to it, since no socket can be made; nothing was started.
            Exception: it could not be started; the text says why.
        """
        socket_folder()
        self._once = asyncio.current_task()

        def publish(event: RunEvent) -> None:
            self.registry.publish(event)
            if isinstance(event, StateChanged) and event.state is ControlState.EXECUTE:
                ready()

        with loop_signals(self._deliver):
            try:
                await self._bench.idle.release()
                planned = await asyncio.to_thread(self._planned, request)
                return await self._carry_out(
                    request, planned, opened, publish, keep_drives=request.keep_drives
                )
            finally:
                await uncancelled(self._bench.end())
                await uncancelled(self._server.end())
                await uncancelled(self._hooks.end())

    def start(self, request: Start) -> "asyncio.Future[Answer]":
        """Begin a run; the result is there when its record is open.

        Raises:
            RefusedError: a run is under way, or the last one was aborted.
        """
        return self._begin(request)

    def resume(self, request: Resume) -> "asyncio.Future[Answer]":
        """Go on with a run; the result is there when its record is open.

        Raises:
            RefusedError: a run is under way, or the last one was aborted.
        """
        return self._begin(request)

    def stop(self, reason: str) -> bool:
        """Stop the arm that is moved by hand, keep a run from beginning; return whether there was either."""
        return self.manual.stop(reason) or self._drop(reason)

    def abort(self, reason: str) -> bool:
        """The same; what was moved by hand has to be cleared before anything begins."""
        return self.manual.abort(reason) or self._drop(reason)

    def _drop(self, reason: str) -> bool:
        """Keep a run from beginning; return whether there was one that was about to.

        One whose record is being made ends as stopped when it is there: half a record would look like a death.
        """
        if self._job is None or not self.registry.beginning:
            return False
        self._dropped = self._dropped or reason
        if self._planning:
            # A task that is cancelled before its first step never gets to say why.
            asyncio.get_running_loop().call_soon(self._drop_plan)
        return True

    def clear(self, who: str) -> None:
        """Leave ABORTED, on an operator's word.

        Raises:
            RefusedError: there is nothing to clear.
        """
        if self._job is not None:
            raise RefusedError("a run is under way; clear is for after an abort")
        if self.registry.idle_state != ControlState.ABORTED:
            raise RefusedError(
                f"there is nothing to clear: the engine is in state {self.registry.idle_state}"
            )
        self._aborted = ""
        for event in (Trigger.CLEAR, Trigger.CLEARED):
            self.registry.idle_state = transition(self.registry.idle_state, event).state
            self._announce_state(f"{who} cleared the abort")
        self._facts()

    def emulate(self, request: Emulate) -> "asyncio.Future[Answer]":
        """Start the emulated bench of the cell; it ends with this process. The result is there when it answers.

        Raises:
            RefusedError: a run is under way, or the engine ends.
        """
        self._require_no_run()
        return self._emulators.begin(request.speed)

    def reset_alarm(self, request: ResetAlarm, who: str) -> "asyncio.Future[Answer]":
        """Reset the controller's alarm that was read, also after an abort that nobody has cleared yet.

        Raises:
            RefusedError: a run is under way, or something is done by hand.
        """
        self._require_no_run()
        return self.manual.reset_alarm(request, who)

    def shut_down(self, who: str) -> None:
        """End the process.

        Raises:
            RefusedError: a run is under way.
        """
        if self._job is not None:
            raise RefusedError("a run is under way: stop it first")
        _log.info("%s ends the engine", who)
        self._ended(ExitCode.DONE)

    def _drop_plan(self) -> None:
        if self._job is not None and self._planning:
            self._job.cancel()

    def _begin(self, request: Start | Resume) -> "asyncio.Future[Answer]":
        self._require_idle()
        if (occupied := self.manual.occupied) is not None:
            raise RefusedError(occupied)
        opened: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()
        self.registry.beginning, self._planning, self._dropped = True, True, ""
        self._job = asyncio.create_task(self._run(request, opened))
        return opened

    def _require_idle(self) -> None:
        """Check that nothing runs, that the bench is in order and that the process goes on.

        Raises:
            RefusedError: a run is under way, something was aborted, or the engine ends.
        """
        self._require_no_run()
        if self._aborted:
            raise RefusedError(
                f"nothing begins after the abort ({self._aborted}): look at the bench, then clear the abort "
                "(in catseye tui: x on Run, F4)",
                ExitCode.SAFETY,
            )

    def _require_no_run(self) -> None:
        """Check that nothing runs and that the process goes on.

        Raises:
            RefusedError: a run is under way, or the engine ends.
        """
        if self._end.done():
            raise RefusedError("the engine ends: start it again", ExitCode.TERMINATED)
        if self._job is not None or self._once is not None:
            raise RefusedError("a run is under way: wait for its end, or stop it first")

    def _abort(self, why: str) -> None:
        """Let nothing begin before an operator has cleared it: what was done by hand was aborted."""
        self.registry.idle_state, self._aborted = ControlState.ABORTED, why
        self._facts()
        self._announce_state(why)

    async def _run(self, request: Start | Resume, opened: "asyncio.Future[Answer]") -> RunOutcome | None:
        def opened_at(path: Path) -> None:
            if not opened.done():
                opened.set_result(Opened(run=path.name, path=str(path.resolve())))

        outcome: RunOutcome | None = None
        try:
            planned = await asyncio.to_thread(self._planned, request)
            await self._drives.cancel()
            self._facts()
            await self._bench.idle.release()
            self._planning = False
            outcome = await self._carry_out(
                request, planned, opened_at, self.registry.publish, keep_drives=True
            )
        except asyncio.CancelledError:
            if not self._dropped:
                raise
            self._failed(InterruptedRunError(f"{self._dropped} before it began"), opened)
            return None
        except Exception as error:  # noqa: BLE001  # the engine outlives a run that cannot be started, whatever the cause
            self._failed(error, opened)
            return None
        finally:
            opened.cancel()
            self.registry.beginning = False
            self._job = None
            self._bench.idle.take_up()
            if outcome is None or outcome.drives_on is None:
                self._drives.begin_again()
            else:
                self._drives.forget()
        if planned.walk is not None and planned.walk.override is not None:
            self.manual.take_walked(planned.walk.override, planned.bench.arm.override_percent)
        if outcome.drives_on and not request.keep_drives:
            self._drives.begin(planned.loaded.cell.robot.drives_off_after_s)
        if outcome.status == "aborted":
            self.registry.idle_state, self._aborted = ControlState.ABORTED, outcome.text
        elif outcome.unacknowledged:
            self._abort(outcome.unacknowledged)
        else:
            self.registry.idle_state = (
                ControlState.COMPLETE if outcome.status == "complete" else ControlState.STOPPED
            )
        self._facts()
        self.registry.announce(EngineIdle(state=self.registry.idle_state))
        return outcome

    def _failed(self, error: Exception, opened: "asyncio.Future[Answer]") -> None:
        self._errors.error("a run could not be made", error)
        if opened.done():
            self.registry.announce(ErrorReported(text=text_of(error), exit_code=int(exit_code_of(error))))
        else:
            opened.set_exception(refusal_of(error))

    def _planned(self, request: Start | Resume) -> PlannedRun:
        if isinstance(request, Resume):
            return plan_resume(self._root, request.run)
        loaded = load_cell(Path(request.cell) if request.cell else self._cell)
        procedure = load_procedure(request.procedure)
        texts = request.params if isinstance(request.params, list) else _texts(request.params)
        params = parse_params(procedure.params_type, texts)
        planned = plan_run(loaded, procedure, params, self._root, request.search, request.job)
        return as_walk(planned, self._root) if request.walk else planned

    async def _carry_out(
        self,
        request: Start | Resume,
        planned: PlannedRun,
        opened: Callable[[Path], None],
        publish: Publish,
        *,
        keep_drives: bool,
    ) -> RunOutcome:
        self.registry.policy = planned.on_client_lost
        hooks = self._hooks.of_run(planned.loaded.cell.hooks)
        publish = hooks.before(publish)
        metrics = metrics_of(self._metrics, planned, self._root, self._bench.telemetry)
        if metrics is not None:
            publish = metrics.before(publish)
        with settled_heap():
            return await carry_out(
                planned,
                self._root,
                publish,
                speed=planned.clock_speed if isinstance(request, Resume) else request.speed,
                arm=request.arm,
                answers=Path(request.answers) if request.answers else None,
                install_signals=self._to_run,
                keep_drives=keep_drives,
                answerer=self.registry.broker,
                on_open=partial(self._serve_run, opened, hooks, metrics),
                attended=lambda: self.registry.attended,
                observe=partial(self._bench.observe, planned),
                waive_walk=request.waive_walk,
            )

    @asynccontextmanager
    async def _serve_run(
        self,
        opened: Callable[[Path], None],
        hooks: RunHooks,
        metrics: MetricsFile | None,
        handle: RunHandle,
    ) -> AsyncIterator[None]:
        async with AsyncExitStack() as stack:
            stack.enter_context(hooks.attending(handle))
            if metrics is not None:
                await stack.enter_async_context(metrics.kept(handle))
            await stack.enter_async_context(self._server.of_run(handle))
            opened(handle.path)
            if self._dropped:
                handle.control.stop(self._dropped)
            yield

    def _facts(self) -> None:
        self.registry.facts = replace(
            self.registry.facts,
            cell=str(self._cell.resolve()),
            runs=str(self._root.resolve()),
            aborted=self._aborted or None,
            drives=self._drives.facts,
            emulated_speed=self._emulators.speed,
        )

    def _announce_state(self, reason: str) -> None:
        self.registry.announce(StateChanged(state=self.registry.idle_state, reason=reason))

    def _announce_emulators(self) -> None:
        """Send every client, and say in snapshots, whether the engine's own emulators answer."""
        self._facts()
        self.registry.announce(EmulatorsChanged(speed=self._emulators.speed))

    def _announce_drives(self, event: AnyEvent) -> None:
        """Send every client, and say in snapshots, when the drives go off."""
        self._facts()
        self.registry.announce(event)

    def _deliver(self, number: int) -> None:
        """Take a signal; the engine outlives its terminal, so SIGHUP means nothing to it."""
        if number == signal.SIGHUP:
            return
        if self._on_signal is not None:
            self._on_signal(number)
        elif self._once is not None and number != signal.SIGUSR1:
            self._once.cancel()
        if number == signal.SIGTERM:
            self._ended(ExitCode.TERMINATED)
        elif number == signal.SIGINT and self._on_signal is None:
            self._ended(ExitCode.INTERRUPTED)

    @contextmanager
    def _to_run(self, on_signal: Callable[[int], None]) -> Iterator[None]:
        self._on_signal = on_signal
        try:
            yield
        finally:
            self._on_signal = None

    async def _wait_for_clients(self, limit_s: float | None) -> None:
        alone_since_s = self._clock.monotonic_s()
        while limit_s is not None:
            await self._clock.sleep(_WAIT_POLL_S)
            if self.registry.members or self._job is not None:
                alone_since_s = self._clock.monotonic_s()
            elif self._clock.monotonic_s() - alone_since_s >= limit_s:
                self._ended(ExitCode.TIMEOUT)
                return

    def _ended(self, code: ExitCode) -> None:
        if not self._end.done():
            self._end.set_result(code)

    async def _finish(self) -> None:
        if self._job is not None:
            if self._on_signal is None:
                # It is still being planned; a run that has begun was aborted by the signal, and seals its record.
                self._job.cancel()
            await asyncio.wait({self._job})
        await self.manual.end("the engine ends")
        await self._drives.end()
        await self._bench.end()
        await self._server.end()
        await self._emulators.end()
        await self._hooks.end()


def _texts(params: dict[str, object]) -> list[str]:
    """Return parameters as the command line writes them."""
    return [f"{name}={json.dumps(value)}" for name, value in params.items()]
