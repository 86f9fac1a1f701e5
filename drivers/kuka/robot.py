"""A KUKA robot over KUKAVARPROXY or C3 Bridge, moved by the program CATSKUKA on its controller.

The proxy only reads and writes variables. Five connections are held: the first for orders and questions about them,
the second for STOP, two for signs of life, so that a lost answer to one does not delay the next, the last for
questions while the arm moves.
"""

import math
from collections.abc import Callable
from typing import Any, ClassVar, Final, Self

from catseye.drivers.kuka import names
from catseye.drivers.kuka.examining import RAISE, examination_of
from catseye.drivers.kuka.halt import HELD, STILL_DEG, STOP_BYTES, KukaStopper
from catseye.drivers.kuka.names import Command
from catseye.drivers.kuka.orders import Order, Orders
from catseye.drivers.kuka.proxy import Proxy
from catseye.drivers.kuka.settings import KukaSettings
from catseye.drivers.kuka.state import StateReader, rest_text
from catseye.drivers.kuka.values import AXES, axes_of, real_of, real_text, string_of, structure_text, whole_of
from catseye.drivers.links.arrival import require_arrived
from catseye.drivers.links.cancelling import uninterrupted
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.guarding import UNGUARDED, LinkGuard, guarded
from catseye.drivers.links.halting import Halt, stopped_when_cancelled
from catseye.drivers.links.motions import Motion
from catseye.drivers.links.stops import Stops, StopWatch
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Examination, Identity, Sink
from catseye.drivers.roles.errors import (
    LinkError,
    NotReadyError,
    WrongDeviceError,
)
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Robot, RobotAbilities, RobotStatus

USES: Final = ("orders", "stop", "heartbeat", "second-heartbeat", "questions")
"""What the connections are for, in their order."""


class KukaVarproxy(Robot):
    """Robot driver.

    Args:
        transports: five connections to the proxy, in the order of `USES`.
        clock: time of the polls.
        guard: of the arm; None for tests and for whoever guards it otherwise.
    """

    Settings: ClassVar[type[KukaSettings]] = KukaSettings
    summary: ClassVar[str] = "KUKA controller with KUKAVARPROXY or C3 Bridge and the program CATSKUKA"
    abilities: ClassVar[RobotAbilities] = RobotAbilities(
        takes_guard=True, numbers_alarms=False, steps=True, switches_drives=False, torques=True
    )

    def __init__(
        self,
        transports: tuple[Transport, Transport, Transport, Transport, Transport],
        clock: Clock,
        settings: KukaSettings | None = None,
        *,
        guard: LinkGuard | None = None,
    ) -> None:
        self._settings = settings or KukaSettings()
        self._clock = clock
        self._guard = guard or UNGUARDED
        self._main, self._stop_side, *beats, self._side = self._proxies = tuple(
            Proxy(
                guarded(transport, guard, use, STOP_BYTES),
                self._settings,
                name="robot" if use == USES[0] else f"robot ({use} connection)",
            )
            for use, transport in zip(USES, transports, strict=True)
        )
        self._orders = Orders(self._main, beats, self._stop_side, clock, self._settings)
        self._state = StateReader(self._settings)
        self._stops = Stops()
        self._override_percent: int | None = None
        self._lowered = False

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
            endpoint: where the proxy answers, tcp://host:7000.
            clock: time of the polls.
            sink: is shown all bytes of all connections.
            guard: is given what stops the arm; None for tests and for whoever guards it otherwise.
            settings: fields of `KukaSettings`.

        Raises:
            LinkError: the endpoint is wrong.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        checked = KukaSettings(**settings)
        if not endpoint.startswith("tcp://"):
            raise LinkError(f"{endpoint}: the proxy answers over TCP: write tcp://host:7000")
        orders, stop, beat, second_beat, questions = (
            open_transport(endpoint, connect_timeout_s=checked.connect_timeout_s, sink=sink) for _ in USES
        )
        return cls((orders, stop, beat, second_beat, questions), clock, checked, guard=guard)

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this connection; empty when all is as it should be."""
        return self._state.notes

    @property
    def read_back_limit(self) -> float:
        """How far a joint may be read back from the target of a motion that is over, deg."""
        return self._settings.tolerance_deg

    @property
    def own_program(self) -> str:
        """Name of the program that runs on the controller; an operator starts it."""
        return names.PROGRAM

    async def connect(self) -> Identity:
        """Open all connections and recognise the controller; nothing but questions is sent.

        Raises:
            WrongDeviceError: something else answers, or another robot.
            LinkError: unreachable or silent.
        """
        self._override_percent, self._lowered = None, False
        self._main.serial = self._side.serial = ""
        try:
            for proxy in self._proxies:
                await proxy.link.open()
            identity = await self._identity()
            self._main.serial = self._side.serial = identity.serial
            return identity
        except BaseException:
            await uninterrupted(self.close())
            raise

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        for proxy in self._proxies:
            await proxy.link.close()

    async def status(self) -> RobotStatus:
        """Return the controller's state; `notes` says what of it is unknown.

        Raises:
            RefusedError: the controller does not read what it has to.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return await self._state.status(self._side)

    async def servo(self, *, on: bool) -> None:
        """Check that the drives are as wanted: no variable switches them.

        Raises:
            NotReadyError: they are not; an operator has to switch them.
        """
        if (await self.status()).servo_on != on:
            wanted = "on" if on else "off"
            raise NotReadyError(
                f"{self._main.where}: no variable switches the drives: switch them {wanted} at the smartPAD or by "
                "the cell's own controls",
                0,
            )

    async def rest(self) -> str:
        """Hold the program by its stop variable; return what holds the arm, and what to do.

        Raises:
            RefusedError: refused.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        await self._main.write(HELD)
        return rest_text(await self.status(), drives_are_known=self._state.knows_drives)

    async def set_override(self, percent: float) -> float:
        """Set the program override, rounded down to a whole percent; return what is read back.

        Args:
            percent: 1...100.

        Raises:
            ValueError: outside of 1...100.
            RefusedError: refused.
            LinkError: lost or silent.
        """
        if not 1 <= percent <= 100:
            raise ValueError(f"override_percent must be from 1 to 100, got {percent}")
        await self._main.write(
            {names.OVERRIDE: str(int(percent))}, permit=StopWatch(self._stops, self._main.where).require_none
        )
        self._override_percent, self._lowered = int(percent), False
        return real_of(await self._main.read(names.OVERRIDE))

    async def joints(self) -> Pose:
        """Return the measured axes A1...A6 ($AXIS_ACT_MEAS), deg.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return axes_of(await self._side.read(names.AXIS_MEASURED))

    async def torques(self) -> tuple[float, ...]:
        """Return the motors' torques ($TORQUE_AXIS_ACT), N m.

        Raises:
            RefusedError: the controller does not read them.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return tuple(map(real_of, await self._side.read_all(names.TORQUES)))

    async def examine(self) -> Examination:
        """Ask the controller beyond its state: command and measurement, the program, its caps."""
        return await examination_of(self._main)

    async def move_joints(self, target: Pose) -> None:
        """Move all axes to the target; return when the robot stands there. External axes stay where they are.

        Args:
            target: A1...A6, deg.

        Raises:
            NotReadyError: the program does not run, or was stopped at the controller, or another motion is under way.
            RefusedError: refused, or ended by `stop`.
            NotArrivedError: the robot stands somewhere else.
            LinkError: lost or silent; the robot has been stopped if it was moving.
            ProtocolError: garbage came.
            ValueError: there are not six finite numbers.
        """
        await self._drive(Command.AXES, target)

    async def step_to(self, target: Pose) -> None:
        """Move all axes to a target nearby, as slowly as `step_axis`; see `move_joints` for errors.

        Args:
            target: A1...A6, deg, none of them farther than CATS_MAX_DEG from where it is commanded to be.
        """
        await self._drive(Command.STEP_TO, target)

    async def step_axis(self, axis: str, increment: float) -> None:
        """Move one axis by an increment, deg, that the program adds to $AXIS_ACT_MEAS; see `move_joints` for errors.

        Args:
            axis: A1...A6.
        """
        if axis not in AXES or not math.isfinite(increment):
            raise ValueError(
                f"a step needs one of {', '.join(AXES)} and a finite increment, got {axis} {increment}"
            )
        values = {names.AXIS: str(AXES.index(axis) + 1), names.INCREMENT: real_text(increment)}
        await self._carry_out(Order(Command.STEP_AXIS, values))

    async def step_line(self, increment_mm: tuple[float, float, float]) -> None:
        """Move the tool along a line by an increment that the program adds to $POS_ACT_MEAS; see `move_joints`.

        Place and orientation of the goal are measured ones.
        """
        if not all(map(math.isfinite, increment_mm)):
            raise ValueError(f"a step needs finite increments, got {increment_mm}")
        values = dict(zip(names.LINE, map(real_text, increment_mm), strict=True))
        await self._carry_out(Order(Command.STEP_LINE, values))

    async def stop(self) -> None:
        """Stop now, past any command under way; return when the robot stands.

        The override is 0 afterwards; the next motion restores the one before. A cancellation does not
        interrupt it. May be called at any time and any number of times.

        Raises:
            LinkError: STOP could not be written or the standstill is not confirmed: use the emergency stop.
        """
        with self._stops.one():
            connections = (self._stop_side, self._side, self._main)
            halt = Halt(list(map(KukaStopper, connections)), self._clock, self._settings, still=STILL_DEG)
            # Before anything is waited for.
            halt.send()
            self._lowered = True
            await uninterrupted(halt.confirm())

    @classmethod
    def stop_request(cls, settings: KukaSettings) -> bytes:
        """Return what stops the arm: the stop variable and an override of 0."""
        del settings
        return STOP_BYTES

    async def _drive(self, command: Command, target: Pose) -> None:
        if len(target) != len(AXES) or not all(map(math.isfinite, target)):
            raise ValueError(f"a target has {len(AXES)} finite numbers, got {target}")
        goal = structure_text(zip(AXES, target, strict=True))
        await self._carry_out(Order(command, {names.GOAL: goal}))
        reached = axes_of(await self._main.read(names.AXIS_MEASURED))
        require_arrived(self._main.where, AXES, reached, target, self.read_back_limit)

    async def _carry_out(self, order: Order) -> None:
        with self._orders.one_alone():
            await stopped_when_cancelled(self._guarded(order), self.stop)

    async def _guarded(self, order: Order) -> None:
        motion = Motion(StopWatch(self._stops, self._main.where), self._guard, self.stop)
        async with self._guard.motion():
            number = await self._orders.prepare(order, motion.permit)
            # An order that is still under way, held by an override of 0, would go on: that is known by now.
            await self._restore_override(motion.permit)
            await self._orders.carry_out(number, motion)

    async def _restore_override(self, permit: Callable[[], None]) -> None:
        """Undo the override of 0 that a stop of this program has left; another value is an operator's.

        Raises:
            NotReadyError: the override is 0, and no stop of this program is the reason.
        """
        percent = whole_of(await self._main.read(names.OVERRIDE))
        if percent > 0:
            self._override_percent, self._lowered = percent, False
            return
        if not self._lowered or self._override_percent is None:
            raise NotReadyError(
                f"{self._main.where}: {names.OVERRIDE} is 0: {RAISE}",
                0,
            )
        await self._main.write({names.OVERRIDE: str(self._override_percent)}, permit=permit)
        self._lowered = False

    async def _identity(self) -> Identity:
        found = await self._main.read_known((names.MODEL, names.SERIAL))
        model = string_of(found[names.MODEL] or "").lstrip("#")
        wanted = self._settings.expected_model
        if not model.upper().startswith(wanted.upper()):
            raise WrongDeviceError(
                f"{self._main.where}: the controller is that of {model or 'an unknown robot'}, expected {wanted}"
            )
        return Identity(
            model=model or "KUKA robot",
            firmware=self._main.kind or "KUKAVARPROXY",
            serial=string_of(found[names.SERIAL] or ""),
            simulated="EMULATOR" in model.upper(),
        )
