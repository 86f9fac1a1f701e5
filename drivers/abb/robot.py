"""An ABB robot with an IRC5 over Robot Web Services 1.0, moved by the module CATSABB on its controller.

Five connections are held in one session: the first for orders and questions about them, the second for STOP, two for
signs of life, so that a slow answer to one does not delay the next, the last for questions while the arm moves.
"""

import asyncio
import contextlib
import math
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any, ClassVar, Final, Self

from catseye.drivers.abb import names
from catseye.drivers.abb.cookies import Cookies
from catseye.drivers.abb.digest import Login
from catseye.drivers.abb.examining import examination_of, system_of
from catseye.drivers.abb.halt import STILL_DEG, AbbStopper, joints_of
from catseye.drivers.abb.masking import masked
from catseye.drivers.abb.orders import Orders
from catseye.drivers.abb.service import Service
from catseye.drivers.abb.settings import FACTORY, PASSWORD_VARIABLE, USER_VARIABLE, AbbSettings, login_of
from catseye.drivers.abb.state import StateReader
from catseye.drivers.abb.values import JOINTS, number_of
from catseye.drivers.links.arrival import require_arrived
from catseye.drivers.links.cancelling import uninterrupted
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.guarding import UNGUARDED, LinkGuard
from catseye.drivers.links.halting import Halt, stopped_when_cancelled
from catseye.drivers.links.motions import Motion
from catseye.drivers.links.stops import Stops, StopWatch
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Examination, Identity, LoginVariables, Sink
from catseye.drivers.roles.errors import (
    DeviceError,
    LinkError,
    NotReadyError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Robot, RobotAbilities, RobotStatus

USES: Final = ("", "stop", "heartbeat", "second-heartbeat", "questions")
"""What the connections are for, in their order; the first is for orders."""

_STOP: Final = USES[1]


class AbbRws(Robot):
    """Robot driver.

    Args:
        transports: five connections to the controller's web server, in the order of `USES`.
        clock: time of the polls.
        guard: of the arm; None for tests and for whoever guards it otherwise.
        login: user and password; None: as the environment says.
    """

    Settings: ClassVar[type[AbbSettings]] = AbbSettings
    summary: ClassVar[str] = "ABB IRC5 controller by Robot Web Services 1.0 and the module CATSABB"
    abilities: ClassVar[RobotAbilities] = RobotAbilities(takes_guard=True, numbers_alarms=False)
    login_variables: ClassVar[LoginVariables] = LoginVariables(USER_VARIABLE, PASSWORD_VARIABLE, FACTORY.user)

    def __init__(
        self,
        transports: tuple[Transport, Transport, Transport, Transport, Transport],
        clock: Clock,
        settings: AbbSettings | None = None,
        *,
        guard: LinkGuard | None = None,
        login: Login | None = None,
    ) -> None:
        self._settings = settings or AbbSettings()
        self._clock = clock
        self._guard = guard or UNGUARDED
        self._login = login or login_of()
        cookies = Cookies()
        self._main, self._stop_side, *beats, self._side = self._services = tuple(
            Service(
                transport,
                self._settings,
                self._login,
                cookies,
                use=use,
                guard=self._guard if use == _STOP and guard else None,
            )
            for use, transport in zip(USES, transports, strict=True)
        )
        self._orders = Orders(self._main, beats, self._stop_side, clock, self._settings)
        self._state = StateReader(self._side, self._settings.task)
        self._stops = Stops()

    @classmethod
    def at(
        cls,
        endpoint: str,
        clock: Clock,
        sink: Sink | None = None,
        *,
        guard: LinkGuard | None = None,
        **settings: Any,
    ) -> Self:
        """Return a driver for an endpoint as the cell file writes it; nothing is opened yet.

        Args:
            endpoint: where the controller answers, tcp://host:80.
            clock: time of the polls.
            sink: is shown all bytes of all connections, but proofs of the password and keys of the session.
            guard: is given what stops the arm; None for tests and for whoever guards it otherwise.
            settings: fields of `AbbSettings`.

        Raises:
            LinkError: the endpoint is wrong.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        checked = AbbSettings(**settings)
        if not endpoint.startswith("tcp://"):
            raise LinkError(f"{endpoint}: Robot Web Services answer over TCP: write tcp://host:80")
        orders, stop, beat, second_beat, questions = (
            open_transport(
                endpoint,
                connect_timeout_s=checked.connect_timeout_s,
                sink=None if sink is None else masked(sink),
            )
            for _ in USES
        )
        return cls((orders, stop, beat, second_beat, questions), clock, checked, guard=guard)

    @property
    def read_back_limit(self) -> float:
        """How far a joint may be read back from the target of a motion that is over, deg."""
        return self._settings.tolerance_deg

    @property
    def own_program(self) -> str:
        """Name of the module whose program runs on the controller."""
        return names.MODULE

    async def connect(self) -> Identity:
        """Log in on all connections and recognise the controller; nothing but questions is sent.

        Raises:
            WrongDeviceError: something else answers, or another controller.
            RefusedError: user or password is wrong, or all sessions are in use.
            LinkError: unreachable or silent.
        """
        self._orders.forget()
        self._state.forget()
        try:
            for service in self._services:
                await service.link.open()
            return await self._identity()
        except BaseException:
            await uninterrupted(self.close())
            raise

    async def close(self) -> None:
        """Log out and disconnect; may be called any number of times."""
        try:
            await self._log_out()
        finally:
            for service in self._services:
                await service.link.close()

    async def status(self) -> RobotStatus:
        """Return the controller's state.

        Raises:
            RefusedError: the controller does not say what it has to.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return await self._state.status()

    async def servo(self, *, on: bool) -> None:
        """Switch the motors; return when they are so.

        Raises:
            NotReadyError: they are not switched, and why.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        wanted = names.MOTORS_ON if on else names.MOTORS_OFF
        state = await self._main.value(names.CONTROL_STATE, "ctrlstate")
        if state == wanted or (not on and state != names.MOTORS_ON):
            return
        try:
            await self._main.ask(names.doing("rw/panel/ctrlstate", "setctrlstate", ctrl_state=wanted))
            async with asyncio.timeout(self._settings.servo_timeout_s):
                while (state := await self._main.value(names.CONTROL_STATE, "ctrlstate")) != wanted:
                    await self._clock.sleep(self._settings.poll_s)
        except RefusedError as exc:
            raise NotReadyError(f"{exc}; the controller is in {state}", exc.number) from None
        except TimeoutError:
            raise NotReadyError(
                f"{self._main.where}: the controller was asked for {wanted} and is in {state} after "
                f"{self._settings.servo_timeout_s:g} s: look at the pendant",
                0,
            ) from None

    async def set_override(self, percent: float) -> float:
        """Set the speed ratio, rounded down to a whole percent; return what is read back.

        Args:
            percent: 1...100.

        Raises:
            ValueError: outside of 1...100.
            RefusedError: refused.
            LinkError: lost or silent.
        """
        if not 1 <= percent <= 100:
            raise ValueError(f"override_percent must be from 1 to 100, got {percent}")
        permit = StopWatch(self._stops, self._main.where).require_none
        request = names.doing("rw/panel/speedratio", "setspeedratio", speed_ratio=str(int(percent)))
        await self._main.ask(request, permit=permit)
        return number_of(await self._main.value(names.SPEED_RATIO, "speedratio"))

    async def joints(self) -> Pose:
        """Return the joints as the controller says them, deg.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return await joints_of(self._side, self._settings.mechanical_unit)

    async def examine(self) -> Examination:
        """Ask the controller beyond its state: the module, its start, the login."""
        return await examination_of(self._main, self._orders, self._settings, self._login)

    async def move_joints(self, target: Pose) -> None:
        """Move all joints to the target; return when the robot stands there. External axes stay where they are.

        Args:
            target: six joints, deg.

        Raises:
            NotReadyError: the program does not run and does not start, or was stopped at the controller, or another
                motion is under way.
            RefusedError: refused, or ended by `stop`.
            NotArrivedError: the robot stands somewhere else.
            LinkError: lost or silent; the robot has been stopped if it was moving.
            ProtocolError: garbage came.
            ValueError: there are not six finite numbers.
        """
        if len(target) != len(JOINTS) or not all(map(math.isfinite, target)):
            raise ValueError(f"a target has {len(JOINTS)} finite numbers, got {target}")
        with self._orders.one_alone():
            await stopped_when_cancelled(self._carry_out(target), self.stop)
        reached = await joints_of(self._main, self._settings.mechanical_unit)
        require_arrived(self._main.where, JOINTS, reached, target, self.read_back_limit)

    async def stop(self) -> None:
        """Stop now, past any command under way; return when the robot stands.

        RAPID stands afterwards; the next motion starts CATSABB from main. A cancellation does not interrupt it. May
        be called at any time and any number of times.

        Raises:
            LinkError: STOP could not be written or the standstill is not confirmed: use the emergency stop.
        """
        with self._stops.one():
            connections = (self._stop_side, self._side, self._main)
            unit = self._settings.mechanical_unit
            stoppers = [AbbStopper(service, unit) for service in connections]
            halt = Halt(stoppers, self._clock, self._settings, still=STILL_DEG)
            # Before anything is waited for.
            halt.send()
            await uninterrupted(halt.confirm())

    async def _carry_out(self, target: Pose) -> None:
        motion = Motion(StopWatch(self._stops, self._main.where), self._guard, self.stop)
        async with self._guard.motion(), self._mastership(motion.permit):
            number = await self._orders.prepare(target, motion.permit)
            await self._orders.carry_out(number, motion)

    @asynccontextmanager
    async def _mastership(self, permit: Callable[[], None]) -> AsyncIterator[None]:
        """Hold mastership of RAPID meanwhile; it may be held although the answer was lost or an error."""
        try:
            await self._main.ask(names.REQUEST_MASTERSHIP, permit=permit)
            yield
        finally:
            # A session that was lost has lost it, too.
            with contextlib.suppress(DeviceError):
                await self._main.ask(names.RELEASE_MASTERSHIP)

    async def _log_out(self) -> None:
        """End the session, which the controller would keep for long; one that is not reached forgets it by itself."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(self._settings.answer_timeout_s):
                for service in self._services:
                    with contextlib.suppress(DeviceError):
                        await service.log_out()
                        return

    async def _identity(self) -> Identity:
        name, version = await system_of(self._main)
        wanted = self._settings.expected_model
        if not name.upper().startswith(wanted.upper()):
            raise WrongDeviceError(
                f"{self._main.where}: the controller is {name or 'without a name'}, expected {wanted}"
            )
        return Identity(
            model=name or "ABB IRC5",
            firmware=f"RobotWare {version}" if version else "Robot Web Services 1.0",
            serial="",
            simulated="EMULATOR" in name.upper(),
        )
