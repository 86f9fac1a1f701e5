"""Running one procedure from the first connection to the sealed record."""

import asyncio
import logging
import os
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import partial

from catseye.app.engine.alarm import RESET, require_no_alarm
from catseye.app.engine.announcer import Announcer, Publish
from catseye.app.engine.before_motion import require_within_controller, unconfirmed_text
from catseye.app.engine.compensation import Compensation
from catseye.app.engine.conditions import AirInRange, Condition
from catseye.app.engine.context import RunContext
from catseye.app.engine.control import RunControl
from catseye.app.engine.devices import (
    DeviceBuilder,
    Devices,
    close_all,
    connect_all,
    identities_as_json,
    require_permission,
)
from catseye.app.engine.door_watch import DoorWatch
from catseye.app.engine.drives import DrivesLeft, leave_drives
from catseye.app.engine.ending import COMPLETE, Ending, ending_of, react, report_of
from catseye.app.engine.first_motion import require_rest
from catseye.app.engine.gate import WHOLE_PERCENT, MotionGate, require_ready
from catseye.app.engine.halt import FAILURES
from catseye.app.engine.handle import RunHandle
from catseye.app.engine.interlock import NO_DOOR, StackLight
from catseye.app.engine.measuring import AirCache
from catseye.app.engine.operator import Operator
from catseye.app.engine.reentry import Reentry
from catseye.app.engine.request import RunOutcome, RunRequest
from catseye.app.engine.restoring import restore_override
from catseye.app.engine.signals import SignalInstaller, loop_signals
from catseye.app.engine.waiting import uncancelled, within
from catseye.app.engine.watches import POLL_S, Watches
from catseye.app.errors import SafetyError, StorageError, TerminatedRunError, UsageError
from catseye.app.files.crash_points import arm, crash_point
from catseye.app.guard.client import ArmGuard
from catseye.app.protocol import run_events
from catseye.app.protocol.banners import SIMULATION_TEXT
from catseye.app.protocol.loss import after_loss
from catseye.app.protocol.run_events import (
    Happened,
    RunEnded,
    RunEvent,
    RunStarted,
    StateChanged,
    StateNoted,
    WarningData,
    WarningIssued,
)
from catseye.app.protocol.state import ControlState
from catseye.app.store.lines import LogHandler
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.interferometer import Interferometer
from catseye.procedures.kit.errors import ProcedureError
from catseye.procedures.kit.records import Json

_log = logging.getLogger(__name__)

_CLOSING_LIMIT_S = 5.0
"""Real seconds for the lamps, and for the links: a bench that is gone keeps nobody waiting who ends the run."""


async def run_procedure(
    request: RunRequest,
    build_devices: DeviceBuilder,
    clock: Clock,
    publish: Publish,
    install_signals: SignalInstaller = loop_signals,
) -> RunOutcome:
    """Run a procedure; every ending leaves the robot at rest, the devices closed and the record sealed.

    Args:
        build_devices: makes the devices; their transports record into the run's transcript.
        publish: takes the headless events.
        install_signals: delivers signals to the stop ladder.

    Raises:
        StorageError: the run's directory cannot be created or opened; nothing was connected.
        UsageError: the run to go on with is complete, or a crash point is asked for that does not exist.
        asyncio.CancelledError: the caller was cancelled; the robot was stopped and the record closed.
    """
    arm(os.environ)
    records = request.procedure.records
    if request.resume is None:
        name, meta = request.procedure.name, {"cell": request.cell, **request.meta}
        store = await RunStore.create(
            request.root, name, meta, clock, records=records, reserve_bytes=request.reserve_bytes
        )
    else:
        store = await RunStore.reopen(
            request.resume, clock, request.meta, records=records, reserve_bytes=request.reserve_bytes
        )
    handler = LogHandler(store.log)
    logging.getLogger().addHandler(handler)
    try:
        return await _Run(request, store, clock, publish).conduct(build_devices, install_signals)
    finally:
        logging.getLogger().removeHandler(handler)
        await uncancelled(store.abandon())


class _Run:
    """One run under way."""

    def __init__(self, request: RunRequest, store: RunStore, clock: Clock, publish: Publish) -> None:
        self._request = request
        self._store = store
        self._clock = clock
        self._control = RunControl(
            clock, self._state_changed, request.halt_limits.at_speed(request.clock_speed)
        )
        self._light: StackLight | None = None
        self._publish = publish
        self._announcer = Announcer(store.path.name, clock, self._pass_on, self._output_lost)
        self._context: RunContext | None = None
        self._torn_down = False
        self._watches: Watches | None = None
        self._drives_on = False
        self._bound_s = request.teardown_limit_s * request.clock_speed
        self._closing_bound_s = min(request.teardown_limit_s, _CLOSING_LIMIT_S) * request.clock_speed
        store.on_failure = self._control.fault
        self._sealed = False
        self._told: ControlState | None = None
        procedure = request.procedure
        self._handle = RunHandle(
            store.path, procedure.name, procedure.title, self._control, self._note, self._warn
        )

    async def conduct(self, build_devices: DeviceBuilder, install_signals: SignalInstaller) -> RunOutcome:
        """Run to the end, whatever the end is."""
        on_open = self._request.on_open
        # Before anybody hears of the run: whoever does may stop it.
        with install_signals(self._control.on_signal):
            async with nullcontext() if on_open is None else on_open(self._handle):
                return await self._conduct(build_devices)

    async def _conduct(self, build_devices: DeviceBuilder) -> RunOutcome:
        procedure = self._request.procedure
        self._announcer.publish(RunStarted(procedure=procedure.name, title=procedure.title))
        devices = build_devices(self._store.wire.record)
        try:
            ending = await self._to_the_end(devices)
        except asyncio.CancelledError:
            error = TerminatedRunError("the run was cancelled; the robot was stopped")
            await uncancelled(self._cancelled(devices, error))
            raise
        return await uncancelled(self._close(devices, ending))

    async def _to_the_end(self, devices: Devices) -> Ending:
        try:
            context = await self._prepare(devices)
            await self._request.procedure.run(context, self._request.plan)
            # A stop that came after the last checkpoint still counts.
            await self._control.checkpoint()
            ending = await self._teardown(context, COMPLETE)
            await self._control.halted()
            self._control.done()
        except Exception as error:  # noqa: BLE001  # the last line of defence: whatever failed, the robot must stop
            return await uncancelled(self._failed(error))
        return ending

    async def _prepare(self, devices: Devices) -> RunContext:
        reentry = Reentry(RunReader(self._store.path, Accept.UNCHECKED)) if self._store.resumed else None
        if reentry is None or reentry.abort_cause is None:
            self._control.starting()
        identities = await self._control.command(connect_all(devices))
        crash_point("devices-connected")
        simulated = require_permission(identities, self._request.cell, self._request.arm)
        if not simulated and self._request.clock_speed != 1.0:
            raise UsageError("the devices are real: leave --speed out, real time cannot run faster")
        self._require_same_world(simulated)
        if devices.guard is not None:
            await self._own(devices.guard, simulated)
        facts: dict[str, Json] = {
            "devices": identities_as_json(identities),
            "simulated": simulated,
            **self._compensation(devices.interferometer),
        }
        if simulated and self._request.hands is not None:
            facts |= await self._request.hands.bench()
        await self._describe(facts, simulated)
        self._handle.simulated = simulated
        self._control.attach(devices.robot)
        if not simulated and (text := unconfirmed_text(self._request.unconfirmed)):
            self._warn(text)
        if devices.io is not None:
            self._light = StackLight(devices.io, self._warn)
        self._watches = watches = Watches(self._control, devices, self._clock, self._request.clock_speed)
        if self._request.hold_limit_s is not None:
            watches.watch_holds(self._request.attended, self._request.hold_limit_s)
        await self._control.command(watches.watch_door())
        conditions = self._conditions(devices)
        gate = self._gate(devices, conditions, watches.door)
        context = self._context_of(devices, gate, simulated)
        context.on_remounted = self._handle.remounted
        if reentry is not None:
            await self._reenter(reentry, context, facts)
        if not simulated and self._request.walk_rule is not None:
            gate.walk_rule = self._request.walk_rule
            here = await self._control.command(devices.robot.joints())
            await gate.walk_rule.begin(identities["robot"], here, context, self._store)
        # Before anybody is asked anything: the alarm would end the run at its first motion.
        require_no_alarm(await self._control.command(devices.robot.status()), RESET)
        await restore_override(devices.robot, self._request.override_cap_percent, context.ask)
        await self._control.command(self._ready(devices, gate, context))
        self._handle.gate = gate
        await self._publish_notes(devices, context)
        self._context = context
        self._control.started()
        watches.watch_controller(gate, conditions)
        return self._context

    def _gate(self, devices: Devices, conditions: Sequence[Condition], door: DoorWatch | None) -> MotionGate:
        request = self._request
        gate = MotionGate(
            devices.robot,
            request.driven.axes,
            request.blocked,
            request.override_cap_percent,
            conditions,
            door,
        )
        gate.on_override = self._override_lowered
        gate.permit = self._control.raise_ending
        return gate

    def _context_of(self, devices: Devices, gate: MotionGate, simulated: bool) -> RunContext:
        request = self._request
        operator = Operator(
            self._clock, request.answers, request.answerer, simulated=simulated, hands=request.hands
        )
        return RunContext(
            devices,
            self._store,
            self._control,
            self._clock,
            request.driven.axes,
            gate,
            operator,
            self._announcer,
            request.line_target,
            request.air,
            POLL_S * request.clock_speed,
            request.procedure.records,
            request.clock_speed,
        )

    async def _own(self, guard: ArmGuard, simulated: bool) -> None:
        """Become the arm's only owner and have it guarded, before anything that moves it or stops it is sent."""
        guard.on_stop = partial(self._control.interrupt, anew=True)
        for text in await guard.hold(
            f"run {self._store.path.name}", self._store.path.parent, simulated=simulated
        ):
            self._warn(text)

    async def _reenter(self, reentry: Reentry, context: RunContext, facts: Mapping[str, Json]) -> None:
        """Look and ask whether the bench is still the one of the points; an abort is cleared first."""
        for text in reentry.require_same_bench(facts):
            await context.warn(text)
        if reentry.abort_cause is not None:
            await reentry.clear(context.ask, self._state_changed)
            self._control.starting()
        stands = await reentry.ask_for_reflectors(
            context.ask, self._store.event, sets_up_anew=self._request.procedure.sets_up_anew
        )
        context.set_up_lost = not stands

    def _conditions(self, devices: Devices) -> list[Condition]:
        conditions: list[Condition] = []
        if self._request.air_limits.ranges and devices.environment is not None:
            air = AirCache(devices.environment, self._clock, self._request.air.max_age_s)
            conditions.append(AirInRange(air, self._request.air_limits))
        return conditions

    def _require_same_world(self, simulated: bool) -> None:
        aim = self._request.aim_simulated
        if aim is not None and aim != simulated:
            searched, present = ("emulated", "real") if aim else ("real", "emulated")
            raise SafetyError(
                f"the aim comes from a search on {searched} devices and these are {present}: nothing was moved; "
                "search on this bench first, or plan with --search none"
            )

    def _compensation(self, counter: Interferometer | None) -> dict[str, Json]:
        """Return who corrects lengths for the air, for the run; nothing where none is measured."""
        if counter is None:
            return {}
        present = Compensation(counter.compensated, self._request.air).facts()
        self._require_same_compensation(present)
        return {"compensation": present}

    def _require_same_compensation(self, present: dict[str, Json]) -> None:
        meta = RunReader(self._store.path, Accept.UNCHECKED).meta
        # A run of format 1 took lengths as the instrument gave them and did not say so.
        silent = "devices" in meta and "compensation" not in meta
        if (present["by"] != "instrument") if silent else (meta.get("compensation", present) != present):
            raise UsageError(
                f"{self._store.path.name} was begun with another correction for the air and cannot go on with this "
                "one: its points would not belong together; set [air] and the instrument as they were, or start again"
            )

    async def _publish_notes(self, devices: Devices, context: RunContext) -> None:
        """Publish what the drivers know about their connections, and what of the bench may be unexpected."""
        for name, device in devices.named().items():
            for note in device.notes:
                await context.warn(f"{name}: {note}", device=name)
        if devices.io is None and not self._handle.simulated:
            await context.warn(NO_DOOR)
        if self._request.aftermath:
            await context.warn(self._request.aftermath)

    async def _describe(self, facts: dict[str, Json], simulated: bool) -> None:
        stored = RunReader(self._store.path, Accept.UNCHECKED).meta
        if stored.get("simulated", simulated) != simulated:
            raise SafetyError(
                f"{self._store.path.name} was begun with {'real' if simulated else 'emulated'} devices and cannot "
                "go on with the others: nothing was moved; check the endpoints of the cell"
            )
        # A run that goes on has its facts already, unless it died before it knew them.
        await self._store.append_meta({key: value for key, value in facts.items() if key not in stored})
        await self._store.event("devices", facts)
        if simulated:
            await self._store.event("warning", {"text": SIMULATION_TEXT, "simulated": True})
            self._announcer.publish(WarningIssued(text=SIMULATION_TEXT, data=WarningData(simulated=True)))

    async def _ready(self, devices: Devices, gate: MotionGate, context: RunContext) -> None:
        await gate.require_surroundings()
        if text := await require_within_controller(devices.robot, self._request.driven):
            self._warn(text)
        here = await require_rest(devices.robot, self._clock, self._request.clock_speed, context.warn)
        percent = await gate.lower_override()
        self._drives_on = True
        await devices.robot.servo(on=True)
        require_ready(await devices.robot.status())
        context.stands(here)
        await context.event("ready", override_percent=percent, joints=list(here))
        cap_percent = self._request.override_cap_percent
        if percent <= cap_percent - WHOLE_PERCENT:
            # Left so by somebody who moved the arm by hand, as often as not.
            self._warn(
                f"the controller's speed override is {percent:g} % and the run is planned with {cap_percent:g} %: it "
                "takes longer; unless that is meant raise it at the controller, as this program never does"
            )

    async def _failed(self, error: Exception) -> Ending:
        if self._control.ending is None:
            react(self._control, error)
        cause = self._control.ending or error
        await self._control.halted()
        ending = ending_of(self._control, cause)
        if isinstance(error, ProcedureError) and self._request.aftermath:
            ending = replace(ending, text=f"{ending.text}. {self._request.aftermath}")
        self._report(ending, error)
        if self._context is not None and self._control.state == ControlState.STOPPED and not self._torn_down:
            ending = await self._teardown(self._context, ending)
        return ending

    async def _cancelled(self, devices: Devices, error: TerminatedRunError) -> None:
        self._control.abort(error)
        await self._control.halted()
        ending = ending_of(self._control, error)
        self._report(ending, error)
        await self._close(devices, ending)

    async def _teardown(self, context: RunContext, ending: Ending) -> Ending:
        self._torn_down = True
        try:
            await within(self._clock, self._bound_s, self._request.procedure.teardown(context))
        except Exception as error:
            if ending is COMPLETE:
                raise
            # It must not hide how the run itself ended.
            self._report(ending_of(self._control, error), error)
        return ending

    async def _close(self, devices: Devices, ending: Ending) -> RunOutcome:
        if self._watches is not None:
            await self._watches.end()
        left = await self._leave_drives(devices, ending)
        troubles = await self._let_go(devices)
        try:
            if left is not None:
                await self._store.event("drives", {"on": left.on, "text": left.text})
            if troubles:
                await self._store.event("close-failed", dict(troubles))
            if self._announcer.missed:
                await self._store.event("output-missed", {"events": self._announcer.missed})
            self._sealed = True
            crash_point("before-closing")
            await self._store.finish(ending.status, ending.exit_code, ending.text, rejected=ending.rejected)
        except StorageError as error:
            ending = Ending("failed", error.exit_code, str(error))
            self._report(ending, error)
        self._announcer.publish(
            RunEnded(
                status=ending.status,
                exit_code=int(ending.exit_code),
                text=ending.text,
                path=str(self._store.path),
                drives_on=left is not None and left.on,
                rejected=ending.rejected,
            )
        )
        times = self._context.step_times if self._context else []
        return RunOutcome(
            self._store.path,
            ending.status,
            ending.exit_code,
            ending.text,
            times,
            drives_on=left.on if left is not None and left.switched else None,
            unacknowledged=self._control.unacknowledged,
        )

    async def _leave_drives(self, devices: Devices, ending: Ending) -> DrivesLeft | None:
        """Switch the drives off after an abort, or unless they are to be kept; None when this run left them alone."""
        unseen = [report for report in self._control.reports if not report.standstill]
        if unseen:
            # A halt without a standstill that was seen has switched them off already, if it could.
            return DrivesLeft(not any(report.servo_off for report in unseen), unseen[-1].text)
        if not self._drives_on:
            return None
        keep = self._request.keep_drives and ending.status != "aborted"
        left = await leave_drives(devices.robot, self._clock, self._closing_bound_s, keep=keep)
        data = run_events.DrivesLeftData(on=left.on, text=left.text)
        self._announcer.publish(run_events.DrivesLeft(state=self._control.state, data=data))
        return left

    async def _let_go(self, devices: Devices) -> dict[str, str]:
        """Put the lamps out and disconnect, whatever happens to either; return what went wrong."""
        troubles: dict[str, str] = {}
        try:
            if self._light is not None:
                await within(self._clock, self._closing_bound_s, self._light.end())
        except FAILURES as error:
            troubles["light"] = str(error)
        try:
            troubles |= await within(self._clock, self._closing_bound_s, close_all(devices))
        except FAILURES as error:
            troubles["devices"] = str(error)
        if devices.guard is not None:
            await devices.guard.let_go()
        return troubles

    def _pass_on(self, event: RunEvent) -> None:
        if self._light is not None:
            self._light.take(event)
        self._publish(event)

    def _note(self, kind: str, data: Mapping[str, Json]) -> None:
        # A client or Ctrl-C may do something while the record is being sealed; nothing can be added to it then.
        if not self._sealed:
            self._store.post(kind, data)

    def _override_lowered(self, percent: float) -> None:
        self._note("override", {"percent": percent})
        self._announcer.publish(
            Happened(state=self._control.state, kind="override", data={"percent": percent})
        )

    def _warn(self, text: str) -> None:
        self._note("warning", {"text": text})
        self._announcer.publish(WarningIssued(text=text))

    def _report(self, ending: Ending, error: BaseException) -> None:
        # The traceback is for the log of the run; people are shown the text, unless they ask for more.
        _log.error(ending.text, exc_info=error)
        self._store.post("error", {"text": ending.text, "type": type(error).__name__})
        self._announcer.publish(report_of(ending, error))

    def _state_changed(self, state: ControlState, reason: str) -> None:
        self._note("state", {"state": state, "reason": reason})
        told, self._told = self._told, state
        event = StateNoted if told is state else StateChanged
        self._announcer.publish(event(state=state, reason=reason))

    def _output_lost(self, error: OSError) -> None:
        policy = self._request.on_output_lost
        self._note("output-lost", {"reason": str(error), "policy": policy})
        text = f"what the run says is taken no more ({error})"
        match after_loss(policy, self._control.state):
            case "warn":
                self._warn(
                    f"{text}; it goes on, as [engine] on_output_lost says, and its record has everything"
                )
            case "hold":
                self._control.hold_before_motion(f"{text}; send SIGUSR1 to go on without it, SIGTERM to end")
            case "stop":
                self._control.stop(f"{text}; the run is stopped, as [engine] on_output_lost says")
