"""A MELFA SCARA over the R-protocol of its controller.

Three connections are held. The first one takes the operation right when something is to move and waits for the end
of each motion; the second one is for STOP, which must not queue behind that wait and needs no right (sheet 1.7); the
third one is for questions while the arm moves, so that STOP does not queue behind those either. A serial line has one
connection: there motions are started and polled, and STOP goes between two polls.
"""

import asyncio
import contextlib
import math
import random
from collections.abc import Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from functools import partial
from typing import Any, ClassVar, Self

from catseye.drivers.links.cancelling import uninterrupted
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.guarding import UNGUARDED, LinkGuard, guarded
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.stops import Stops, StopWatch
from catseye.drivers.links.transport import Transport
from catseye.drivers.melfa import codec
from catseye.drivers.melfa.alarms import STOP_IS_ON
from catseye.drivers.melfa.codec import Answer, Layout
from catseye.drivers.melfa.connections import Connections
from catseye.drivers.melfa.controller import MelfaController
from catseye.drivers.melfa.examining import examination_of
from catseye.drivers.melfa.halt import Halt
from catseye.drivers.melfa.jog import Jog
from catseye.drivers.melfa.joint_motion import JointMotion
from catseye.drivers.melfa.motion import NO_TORQUES, REPORTED, VARIABLES, account_for, unstarted_polls
from catseye.drivers.melfa.servo import servo_is
from catseye.drivers.melfa.session import Session, byte_time_s
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.melfa.side import Side
from catseye.drivers.melfa.starting import start_once
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Examination, Identity, Sink
from catseye.drivers.roles.errors import DeviceError, LinkError, NotReadyError, RefusedError
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import JogDirection, Robot, RobotAbilities, RobotStatus

_CLOSE_TIMEOUT_S = 3.0

_Ask = Callable[[str, Layout], Awaitable[Answer]]


def stop_bytes(settings: MelfaSettings) -> bytes:
    """Return what stops the arm on a connection on which a request may be half written: CR ends that one."""
    stop = codec.encode(
        "STOP", robot=settings.robot_number, slot=settings.slot, terminator=settings.terminator or "\r"
    )
    return b"\r" + stop


class MelfaR3(Robot):
    """Robot driver.

    Args:
        transport: connection that holds the operation right once it is needed.
        stop_transport: connection for STOP, on this or another port of the controller; None: there is but one.
        clock: time of the polls.
        byte_s: time of one byte on a serial line, real s; 0 on a network.
        status_transport: connection for questions while the arm moves; None: the stop connection serves them.
        variable: of the controller that carries targets, one of `VARIABLES`; by default each connection takes any.
        guard: of the arm; None for tests and for whoever guards it otherwise.
    """

    Settings: ClassVar[type[MelfaSettings]] = MelfaSettings
    summary: ClassVar[str] = "MELFA controller as delivered; stands still at every target"
    abilities: ClassVar[RobotAbilities] = RobotAbilities(
        jogs=True, takes_guard=True, resets_alarms=True, command_resolution=REPORTED
    )

    def __init__(
        self,
        transport: Transport,
        stop_transport: Transport | None,
        clock: Clock,
        settings: MelfaSettings | None = None,
        *,
        byte_s: float = 0.0,
        status_transport: Transport | None = None,
        variable: str | None = None,
        guard: LinkGuard | None = None,
    ) -> None:
        self._settings = settings or MelfaSettings()
        self._clock = clock
        self._guard = guard or UNGUARDED
        transport = guarded(transport, guard, "robot", stop_bytes(self._settings))
        self._main = Session(transport, self._settings, name="robot", set_up=self._take_over, byte_s=byte_s)
        stop, status = (
            self._further(further, use, guard)
            for further, use in ((stop_transport, "stop"), (status_transport, "status"))
        )
        self._connections = Connections(self._main, stop, status)
        self._given_variable = variable
        self._still_polls = unstarted_polls(byte_s)
        self._motion = JointMotion(
            self._connections,
            clock,
            self._settings,
            still_polls=self._still_polls,
            take_right=self.take_right,
            account_for=self.account_for,
            reset_alarm=self.reset_alarm,
        )
        self._has_right = False
        self._override_percent: int | None = None
        self._stops = Stops()
        self._right_note = ""

    @classmethod
    def at(
        cls,
        endpoint: str,
        clock: Clock,
        sink: Sink | None = None,
        *,
        stop_endpoint: str | None = None,
        status_endpoint: str | None = None,
        stop_sink: Sink | None = None,
        guard: LinkGuard | None = None,
        **settings: Any,
    ) -> Self:
        """Return a driver for endpoints as the cell file writes them; nothing is opened yet.

        Args:
            endpoint: where the controller answers, tcp:// or serial://.
            clock: time of the polls.
            sink: is shown all bytes of the first connection.
            stop_endpoint: of the stop connection, for controllers that serve one client a port.
            status_endpoint: of the connection for questions while the arm moves; as `endpoint` by default.
            stop_sink: is shown all bytes of the further connections; `sink` by default.
            guard: is given what stops the arm; None for tests and for whoever guards it otherwise.
            settings: fields of `MelfaSettings`.

        Raises:
            LinkError: an endpoint is wrong, or a serial line has no terminator.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        checked = MelfaSettings(**settings)
        timeout_s = checked.connect_timeout_s
        main = open_transport(endpoint, connect_timeout_s=timeout_s, sink=sink)
        byte_s = byte_time_s(endpoint)
        if byte_s and not checked.terminator:
            raise LinkError(f"{endpoint}: on a serial line a request ends with CR: set terminator = '\\r'")
        # A serial line carries one conversation; a second one would be the same port.
        stop_endpoint = stop_endpoint or (None if byte_s else endpoint)
        status_endpoint = status_endpoint or (None if byte_s else endpoint)
        aside, status = (
            open_transport(place, connect_timeout_s=timeout_s, sink=stop_sink or sink) if place else None
            for place in (stop_endpoint, status_endpoint)
        )
        return cls(main, aside, clock, checked, byte_s=byte_s, status_transport=status, guard=guard)

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this connection; empty when all is as it should be."""
        return tuple(filter(None, (self._right_note, self._connections.note)))

    @property
    def controller(self) -> MelfaController:
        """The controller beyond motion: variables, programs, parameters, signals, log, monitors, jog."""
        return MelfaController(self._main, self.take_right, self.stop, self.watch_stops, self.guarded)

    async def connect(self) -> Identity:
        """Open all connections and recognise the controller; nothing but questions is sent.

        The operation right follows with the first command that needs it.

        Raises:
            WrongDeviceError: something else answers, or another robot.
            LinkError: unreachable or silent.
        """
        self._has_right = False
        self._right_note = ""
        self._override_percent = None
        self._motion.variable = self._given_variable or random.choice(VARIABLES)
        opened = await self._main.open()
        try:
            await self._connections.open_further()
        except BaseException:
            await uninterrupted(self.close())
            raise
        return Identity(
            model=f"{opened.model} ({opened.controller})",
            firmware=opened.firmware,
            serial=opened.serial,
            simulated="EMULATOR" in opened.copyright.upper(),
        )

    async def close(self) -> None:
        """Give the right back if it was taken and disconnect; may be called any number of times."""
        farewell = ("CNTLOFF",) if self._has_right else ()
        self._has_right = False
        # A request in flight holds a link until its own time-out; closing does not wait for it.
        for closing in (self._connections.shut, partial(self._main.close, *farewell)):
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(_CLOSE_TIMEOUT_S):
                    await closing()
        for session in self._connections.every:
            await session.link.close()

    async def status(self) -> RobotStatus:
        """Return the controller's state.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return await self._asker.status()

    async def servo(self, *, on: bool) -> None:
        """Switch the drives and return when STATE says that they are so.

        Raises:
            AlarmError: an alarm is active.
            NotReadyError: refused for a reason that an operator has to look at.
            RefusedError: refused, or the servo does not follow in time.
            LinkError: lost or silent.
        """
        if on:
            await self.take_right()
            await self._main.command("SRVON", repeat=Repeat.HARMLESS)
        else:
            # Allowed in every state: neither an alarm nor a refused right may keep the drives on unasked.
            with contextlib.suppress(RefusedError):
                await self.take_right()
            await self._main.ask("SRVOFF", codec.bare, repeat=Repeat.HARMLESS)
        await servo_is(self._main, self._clock, self._settings, on=on)

    async def set_override(self, percent: float) -> float:
        """Set the speed override, rounded down to a whole percent; return what is read back.

        Args:
            percent: 1...100.

        Raises:
            ValueError: outside of 1...100.
            AlarmError: an alarm is active.
            NotReadyError: refused for a reason that an operator has to look at.
            RefusedError: refused.
            LinkError: lost or silent.
        """
        if not 1 <= percent <= 100:
            raise ValueError(f"override_percent must be from 1 to 100, got {percent}")
        command = f"OVRD={int(percent)}"
        await self.take_right()
        answer = await self._main.ask(command, codec.free_text, repeat=Repeat.HARMLESS)
        if answer.alarm:
            await self._main.raise_alarm(command)
        self._override_percent = int(percent)
        return await self._main.question("OVRD", codec.free_text, _override)

    async def joints(self) -> Pose:
        """Return the reported joints (J1 deg, J2 deg, J3 mm, J4 deg), in steps of 0.01.

        The sheet does not know whether a controller reports command or feedback (1.11).

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return await self._asker.joints()

    async def torques(self) -> tuple[float, ...]:
        """Refuse: the controller tells currents.

        Raises:
            RefusedError: always.
        """
        raise RefusedError(NO_TORQUES, 0)

    async def joint_limits(self) -> tuple[tuple[float, float], ...]:
        """Return the controller's own limits of J1...J4 from the parameter MEJAR, deg or mm.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return await self.controller.joint_limits()

    async def examine(self) -> Examination:
        """Ask the controller beyond its state: encoders, stop sources, the last line of its log."""
        return await examination_of(self.controller)

    async def reset_alarm(self) -> None:
        """Reset the active alarm.

        Raises:
            AlarmError: it is still there.
            LinkError: lost or silent.
        """
        await self._main.ask("RSTALRM", codec.bare)
        await self._main.raise_alarm("RSTALRM")

    async def move_joints(self, target: Pose) -> None:
        """Interpolate all joints to the target; return when the robot stands there.

        The motion is commanded once. When its answer is lost, the controller is asked where the robot is. A
        cancellation stops the robot before it goes on.

        Args:
            target: J1 deg, J2 deg, J3 mm, J4 deg.

        Raises:
            AlarmError: an alarm came up.
            NotReadyError: refused for a reason that an operator has to look at.
            RefusedError: refused, nothing moves; or ended by `stop` (5610).
            NotArrivedError: the robot stands somewhere else.
            LinkError: lost or silent; the robot has been stopped if it was moving.
            ProtocolError: garbage came.
            ValueError: a joint is not a finite number.
        """
        if not all(map(math.isfinite, target)):
            raise ValueError(f"joints of a motion must be finite numbers, got {target}")
        watch = StopWatch(self._stops, self._main.where, STOP_IS_ON)
        try:
            async with self.guarded():
                await self._move(target, self._permit(watch))
        except NotReadyError as exc:
            # A stop of this program that overlaps the motion is its own doing and calls for no operator.
            if exc.number == STOP_IS_ON and watch.seen:
                raise RefusedError(str(exc), exc.number) from None
            raise

    async def _move(self, target: Pose, permit: Callable[[], None]) -> None:
        try:
            await self._motion.go(target, permit)
        except asyncio.CancelledError:
            await self.stop()
            raise

    @classmethod
    def stop_request(cls, settings: MelfaSettings) -> bytes:
        """Return what stops the arm on a connection on which a request may be half written; see `stop_bytes`."""
        return stop_bytes(settings)

    def jogging(self, directions: Mapping[str, JogDirection]) -> AbstractAsyncContextManager[Jog]:
        """Turn joints while what is yielded is fed; the robot stands when it is left. See MelfaController.jog."""
        return self.controller.jog(directions)

    async def stop(self) -> None:
        """Stop now, past any command under way; return when the robot stands.

        A cancellation does not interrupt it. May be called at any time and any number of times.

        Raises:
            LinkError: STOP could not be sent or the standstill is not confirmed: use the emergency stop.
        """
        with self._stops.one():
            halt = Halt(self._connections, self._clock, self._settings)
            # Before anything is waited for.
            halt.send()
            await uninterrupted(halt.confirm())

    def watch_stops(self) -> Callable[[], None]:
        """Return a check that raises RefusedError once a stop has begun: what it overtakes must not begin.

        It raises GuardError where the arm's guard does not permit a motion.
        """
        return self._permit(StopWatch(self._stops, self._main.where, STOP_IS_ON))

    def guarded(self) -> AbstractAsyncContextManager[None]:
        """Have the arm stopped when this program falls silent meanwhile.

        Raises:
            GuardError: nobody guards the arm.
        """
        return self._guard.motion()

    def _permit(self, watch: StopWatch) -> Callable[[], None]:
        """Return what is asked right before a motion is written."""

        def permit() -> None:
            watch.require_none()
            self._guard.permit()

        return permit

    async def take_right(self) -> None:
        """Take the operation right unless it is held; permission to move has been given by now.

        Raises:
            NotReadyError: the right is refused.
            LinkError: lost or silent.
        """
        if self._has_right:
            return
        # Who does not own the arm takes nobody's right.
        self._guard.permit()
        ask = partial(self._main.ask, repeat=Repeat.HARMLESS)
        await self._claim_right(ask)
        try:
            await self._lower_override(ask)
        except DeviceError:
            # Healing tries it again, so that nothing moves faster than was set.
            self._main.link.distrust("the override could not be restored")
            raise

    async def start_program(self, name: str, permit: Callable[[], None]) -> None:
        """Start a program from its first line unless it runs; see `start_once`."""
        await self.take_right()
        await start_once(self._main, self._clock, self._settings, name, permit)

    async def account_for(self, target: Pose, lost: DeviceError) -> None:
        """Ask where the robot is after the answer to a motion was lost; go on only if it stands at the target.

        Args:
            target: joints of the motion, deg or mm.

        Raises:
            AlarmError: an alarm is the reason.
            NotArrivedError: the robot stands somewhere else; a STOP was sent.
            LinkError: the controller does not say; a STOP was sent.
        """
        await account_for(
            self._connections.side,
            self._clock,
            self._settings,
            target,
            lost,
            self.stop,
            still_polls=self._still_polls,
        )

    def _further(self, transport: Transport | None, use: str, guard: LinkGuard | None) -> Session | None:
        if transport is None:
            return None
        held = guarded(transport, guard, use, stop_bytes(self._settings))
        return Session(held, self._settings, name=f"robot ({use} connection)")

    async def _take_over(self) -> None:
        """Restore what a new connection does not know: the variable, and the right if it had been taken."""
        self._motion.forget()
        if not self._has_right:
            return
        self._has_right = False
        try:
            await self._claim_right(self._main.greet_ask)
        except RefusedError:
            # The state can be read without the right, which is what helps an operator now.
            return
        except BaseException:
            # The next opening claims it again.
            self._has_right = True
            raise
        await self._lower_override(self._main.greet_ask)

    async def _claim_right(self, ask: _Ask) -> None:
        try:
            await ask("CNTLON", codec.bare)
        except RefusedError as exc:
            self._right_note = f"the operation right is refused, the robot cannot be moved: {exc}"
            raise
        self._right_note = ""
        self._has_right = True

    async def _lower_override(self, ask: _Ask) -> None:
        """Restore the override that was set here if a higher one is in force; a lower one is an operator's will."""
        if self._override_percent is None:
            return
        answer = await ask("OVRD", codec.free_text)
        if codec.parse_number(answer.payload, "the override") > self._override_percent:
            await ask(f"OVRD={self._override_percent}", codec.free_text)

    @property
    def _asker(self) -> Session | Side:
        """Who is asked: the first session unless a motion blocks it."""
        return self._connections.side if self._motion.waits else self._main


def _override(payload: str) -> float:
    return codec.parse_number(payload, "the override")
