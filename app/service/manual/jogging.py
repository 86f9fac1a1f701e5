"""Moving the arm by hand between runs, from permission and drives to the arm that stands again."""

import asyncio
from collections.abc import Callable
from contextlib import nullcontext
from typing import Final

from catseye.app.engine.before_motion import unconfirmed_text
from catseye.app.engine.devices import Devices, require_permission
from catseye.app.engine.door_watch import DoorWatch
from catseye.app.engine.gate import require_ready
from catseye.app.engine.halt import HaltLimits, halt
from catseye.app.engine.waiting import uncancelled, within
from catseye.app.errors import InterruptedRunError, SafetyError, text_of
from catseye.app.exitcode import ExitCode
from catseye.app.guard.client import ArmGuard
from catseye.app.protocol import answers
from catseye.app.protocol.answers import Answer
from catseye.app.protocol.engine_events import Client, JogChanged, LeftOverride
from catseye.app.protocol.requests import JogHold, JogMode, JogStep
from catseye.app.protocol.run_events import ErrorReported, WarningIssued
from catseye.app.service.errors import RefusedError, refusal_of
from catseye.app.service.manual.device_loan import ManualBench
from catseye.app.service.manual.jog_gate import JogGate
from catseye.app.service.manual.left_override import lowered
from catseye.app.service.manual.manual_arm import ManualArm
from catseye.app.service.watching.bench_facts import BenchFacts
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.robot import Robot

_LOOK_S: Final = 0.25
"""Between two looks at an arm that stands."""

_DRIVES_S: Final = 6.0
_PRESS = "PRESS THE EMERGENCY STOP if the robot moves: it is not certain to stand, with its drives off"


class Jogging:
    """One jog, from the request that begins it to its end. It is under way from the moment it is made.

    Attributes:
        client: moves it.
        begun: has a result when the arm may be moved, or says why it may not.
        aborted: why nothing may move before somebody has looked at the bench; empty while all is well.
        left_override: what it has left of the speed override; None where it lowered nothing.
    """

    def __init__(
        self, bench: ManualBench, request: JogMode, client: Client, limits: HaltLimits | None = None
    ) -> None:
        self.client = client
        self.begun: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()
        self.aborted = ""
        self._bench = bench
        self._request = request
        self._limits = limits or HaltLimits()
        self._gate: JogGate | None = None
        self._arm: ManualArm | None = None
        self._reason = ""
        self.left_override: LeftOverride | None = None
        self._left_lower = ""
        self._failure: Exception | None = None
        self._ended = asyncio.Event()
        self._task = asyncio.create_task(self._serve())
        self._task.add_done_callback(self._answer_if_unheard)

    def add_done_callback(self, done: Callable[["Jogging"], None]) -> None:
        """Call when the arm stands, the drives are as before and the devices are given back."""
        self._task.add_done_callback(lambda _: done(self))

    async def over(self) -> None:
        """Wait for the end."""
        await asyncio.wait({self._task})

    def step(self, request: JogStep, heard_s: Callable[[], float]) -> "asyncio.Future[Answer]":
        """Begin a step; see ManualArm.step."""
        return self._ready_arm().step(request, heard_s)

    def hold(self, request: JogHold) -> "Answer | asyncio.Future[Answer]":
        """Keep a joint moving, or stop it; see ManualArm.hold."""
        return self._ready_arm().hold(request)

    def end(self, reason: str) -> None:
        """Stop the arm now and end; again does no harm."""
        if self._reason:
            return
        self._reason = reason
        self._ended.set()
        if self._arm is not None:
            self._arm.stop(reason)
        else:
            self._task.cancel()

    def abort(self, reason: str) -> None:
        """Stop the arm now, end, and let nothing move before somebody has cleared it."""
        self.aborted = self.aborted or reason
        self.end(reason)

    def moves(self, joint: str | None, reason: str) -> None:
        """Announce what moves."""
        self._announce(joint, reason)

    def failed(self, error: Exception) -> None:
        """End since a motion failed; the arm has been stopped."""
        self._failure = self._failure or error
        self.end(str(error))

    def unsafe(self, text: str) -> None:
        """End; nothing may move before somebody has looked at the arm, which is not certain to stand."""
        self.aborted = f"{_PRESS}; {text}"
        self._failure = SafetyError(f"{self.aborted} ({self._failure})" if self._failure else self.aborted)
        self.end(self.aborted)

    def _ready_arm(self) -> ManualArm:
        if self._arm is None or self._reason:
            raise RefusedError(
                f"the jog is over: {self._reason}" if self._reason else "the jog is only beginning"
            )
        return self._arm

    async def _serve(self) -> None:
        try:
            async with self._bench.pool.acquired() as devices:
                await self._jog(devices)
        except asyncio.CancelledError:
            self._failure = self._failure or InterruptedRunError(self._reason or "the engine ends")
        except Exception as error:  # noqa: BLE001  # whatever ends a jog is announced; the engine lives on
            self._failure = self._failure or error
        self._close()

    async def _jog(self, devices: Devices) -> None:
        facts = await self._bench.facts()
        simulated = require_permission(self._identities(devices), facts.cell, self._request.arm)
        if not simulated and (text := unconfirmed_text(facts.bench.workspace.unconfirmed)):
            self._bench.announce(WarningIssued(text=text))
        door = None if devices.io is None else DoorWatch(devices.io, self._bench.clock, self._door_opened)
        self._gate = gate = JogGate(devices, facts, self._request.percent, door)
        async with nullcontext() if door is None else door.watching(self._unwatched):
            await self._jog_watched(devices, facts, gate, simulated)

    async def _jog_watched(self, devices: Devices, facts: BenchFacts, gate: JogGate, simulated: bool) -> None:
        robot = devices.robot
        before = await robot.status()
        # An arm that belongs to somebody else is not stopped either.
        await self._own(devices.guard, simulated)
        try:
            override_percent = await gate.switch_on()
            if self._reason:
                # A cancellation that comes together with an answer may be lost on its way through a library.
                raise InterruptedRunError(self._reason)
            self._arm = ManualArm(robot, facts.system, gate, self._bench.clock, self._limits, self)
            self.begun.set_result(answers.Jogging(override_percent=override_percent, simulated=simulated))
            self._announce(None)
            await self._stand_by(robot, self._arm)
        except Exception as error:
            self._failure = self._failure or error
            self._reason = self._reason or str(error)
            raise
        finally:
            await uncancelled(self._leave(robot, before.servo_on))
            await uncancelled(
                self._note_override(robot, before.override_percent, facts.override_cap_percent, gate.percent)
            )
            if devices.guard is not None:
                await uncancelled(devices.guard.let_go())

    async def _own(self, guard: ArmGuard | None, simulated: bool) -> None:
        """Become the arm's only owner and have it guarded."""
        if guard is None:
            return
        guard.on_stop = self.abort
        for text in await guard.hold("moved by hand", self._bench.folder, simulated=simulated):
            self._bench.announce(WarningIssued(text=text))

    def _door_opened(self, trouble: str) -> None:
        """Stop what moves; that ends the jog, and whoever goes on begins a new one."""
        if self._arm is not None:
            self._arm.break_off(SafetyError(trouble))

    def _unwatched(self, trouble: str) -> None:
        """End: nothing goes on unwatched."""
        self._failure = self._failure or SafetyError(trouble)
        self.end(str(self._failure))

    def _identities(self, devices: Devices) -> dict[str, Identity]:
        """Return who answers of those that a run has: what else stands in the cell file moves nothing.

        Raises:
            RefusedError: it is not known who the robot is.
        """
        known = self._bench.identities()
        if "robot" not in known:
            # What is not known to be emulated might move without permission.
            raise RefusedError(
                "it is not known which robot answers: check its link, then jog again", ExitCode.DEVICE
            )
        return {name: known[name] for name in devices.named() if name in known}

    async def _stand_by(self, robot: Robot, arm: ManualArm) -> None:
        """Look at the arm while it stands, until the end.

        Raises:
            Exception: a motion failed, or the controller may not move any more.
        """
        while not self._ended.is_set():
            if arm.motion is None:
                await robot.joints()
                require_ready(await robot.status())
            try:
                await within(self._bench.clock, _LOOK_S, self._ended.wait())
            except TimeoutError:
                continue
        if self._failure is not None:
            raise self._failure

    async def _leave(self, robot: Robot, drives_on: bool) -> None:
        """Stop the arm, see it stand, and leave the drives as they were."""
        if self._arm is not None:
            self._arm.stop(self._reason)
            await self._arm.at_rest()
        try:
            report = await halt(robot, self._bench.clock, self._limits, lambda: None)
        except Exception as error:  # noqa: BLE001  # a fault of a driver: nobody has seen the arm stand
            self.unsafe(f"standstill was not seen: {error}")
            drives_on = False
        else:
            if not report.standstill:
                self.unsafe(report.text)
                return
        if not drives_on:
            await self._switch_off(robot)

    async def _switch_off(self, robot: Robot) -> None:
        try:
            await within(self._bench.clock, _DRIVES_S, robot.servo(on=False))
        except Exception as error:  # noqa: BLE001  # a fault of a driver leaves the drives on as well
            self.unsafe(f"the drives do not switch off: {text_of(error)}")

    def _close(self) -> None:
        error = self._failure
        if error is not None and not self.begun.done():
            self.begun.set_exception(refusal_of(error))
        elif error is not None:
            self._bench.announce(ErrorReported(text=text_of(error), exit_code=int(refusal_of(error).code)))
        if self._arm is not None:
            self._announce(None, self._reason, on=False)
        if self._left_lower:
            self._bench.announce(WarningIssued(text=self._left_lower))

    async def _note_override(
        self, robot: Robot, before_percent: float, cap_percent: float, asked_percent: float
    ) -> None:
        """Have the end of the jog say that runs will be slow, and how the override goes back."""
        try:
            left_percent = (await within(self._bench.clock, _DRIVES_S, robot.status())).override_percent
        except Exception:  # noqa: BLE001  # a fault of a driver, too: nobody knows what stands there, nothing is set again
            return
        self.left_override = lowered(before_percent, left_percent, cap_percent, asked_percent)
        if self.left_override is not None:
            self._left_lower = (
                f"the speed override stays at {left_percent:g} % and runs are planned with {cap_percent:g} %: = on "
                f"Jog (F5) restores the {self.left_override.before_percent:g} % from before"
            )

    def _answer_if_unheard(self, _task: "asyncio.Task[None]") -> None:
        """Answer whoever asked: a task that is cancelled before its first step says nothing itself."""
        if not self.begun.done():
            self.begun.set_exception(refusal_of(InterruptedRunError(self._reason or "the engine ends")))

    def _announce(self, moving: str | None, reason: str = "", *, on: bool = True) -> None:
        self._bench.announce(
            JogChanged(
                on=on,
                by=self.client.text,
                client=self.client.client,
                percent=None if self._gate is None else self._gate.override_percent,
                moving=moving,
                reason=reason or None,
            )
        )
