"""A MELFA SCARA that passes via points: R-protocol for the controller, a data link to its program for motion.

Session, servo, override, alarms and STOP go over the R-protocol; the ways of the arm go to the program CATSDL, which
drives them with `Cnt 1` and answers at the standstill with the joints' feedback (`J_Fbc`). After a STOP that program
stands: it is started again before the next way, or an operator has to.
"""

import asyncio
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, ClassVar, Self

from pydantic import Field

from catseye.drivers.links.cancelling import uninterrupted
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.healing import Repeat, reopened
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.melfa.datalink import codec
from catseye.drivers.melfa.datalink.codec import Record, RecordDecoder
from catseye.drivers.melfa.led import LedArm, parted, require_way
from catseye.drivers.melfa.motion import (
    COMMANDED,
    LOOK_WHY,
    STILL_LOOKS,
    asking_under_way,
    off_target,
    require_unlocked,
    sent_once,
)
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity, Sink
from catseye.drivers.roles.errors import (
    AlarmError,
    LinkError,
    NotArrivedError,
    NotSentError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotAbilities

_VERSION = 1
_LOOK_S = 0.2
_LOOKS = 2
_OPENS_S = 0.1
"""For the statements of the program before its Open, real s; what comes earlier puts it in alarm."""

_START_IT = "start the program CATSDL on the controller (key at AUTO, slot 1), see docs/controller.md"


class DatalinkSettings(MelfaSettings):
    """Settings of the data link driver, on top of those of the R-protocol."""

    program: str = Field(
        default="CATSDL",
        pattern=r"^[A-Z0-9]{0,12}$",
        description="name of the program to start again after a stop; empty leaves that to the operator.",
    )
    in_position_pulses: int = Field(
        default=20,
        ge=1,
        le=10000,
        description="how near the last point of a way has to be before it counts as reached (`Fine`).",
    )


class MelfaDatalink(LedArm):
    """Robot driver."""

    Settings: ClassVar[type[DatalinkSettings]] = DatalinkSettings
    summary: ClassVar[str] = "MELFA with program CATSDL: passes targets in one motion"
    protocols: ClassVar[Mapping[str, str] | None] = {
        "endpoint": "melfa-r3",
        "datalink_endpoint": "melfa-datalink",
    }
    abilities: ClassVar[RobotAbilities] = RobotAbilities(
        following="blended",
        jogs=True,
        takes_guard=True,
        resets_alarms=True,
        further_endpoint="datalink_endpoint",
        command_resolution=COMMANDED,
    )

    def __init__(self, controller: MelfaR3, transport: Transport, settings: DatalinkSettings) -> None:
        super().__init__(controller)
        self._settings = settings
        self._link = RequestLink(
            transport, name="robot (data link)", greet=self._greet, quiet_s=settings.quiet_s
        )
        self._number = 0
        self._driving = False
        self._halted = False

    @classmethod
    def at(
        cls,
        endpoint: str,
        clock: Clock,
        sink: Sink | None = None,
        *,
        datalink_endpoint: str | None = None,
        **settings: Any,
    ) -> Self:
        """Return a driver for endpoints as the cell file writes them; nothing is opened yet.

        Args:
            endpoint: of the controller's R-protocol port.
            datalink_endpoint: of the port that the program opens.
            settings: fields of `DatalinkSettings`; `stop_endpoint` as for `MelfaR3`.

        Raises:
            LinkError: an endpoint is missing or wrong.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        if datalink_endpoint is None:
            raise LinkError(
                "the data link needs datalink_endpoint in [robot], the port whose CPRCE is 2: "
                'datalink_endpoint = "tcp://192.168.0.20:10003"'
            )
        for_controller, for_model = parted(settings, DatalinkSettings)
        controller = MelfaR3.at(endpoint, clock, sink, **for_controller)
        checked = DatalinkSettings(**for_model)
        transport = open_transport(datalink_endpoint, connect_timeout_s=checked.connect_timeout_s, sink=sink)
        return cls(controller, transport, checked)

    @property
    def own_program(self) -> str:
        """Name of the program that this driver has running on the controller; empty when the operator starts it."""
        return self._settings.program

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about these connections; empty when all is as it should be."""
        return self._controller.notes

    async def connect(self) -> Identity:
        """Open all connections and recognise controller and program.

        Raises:
            WrongDeviceError: something else answers.
            LinkError: unreachable or silent.
        """
        identity = await self._controller.connect()
        try:
            # A STOP of an earlier run has left the program standing: it is started before the first way.
            self._halted = bool(self._settings.program) and not (await self._controller.status()).running
            if not self._halted:
                await self._link.open()
        except BaseException:
            await uninterrupted(self.close())
            raise
        return identity

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        # A start under way opens nothing behind it.
        self._halted = True
        await self._link.close()
        await self._controller.close()

    async def joints(self) -> Pose:
        """Return the joints by encoder feedback; while a way is driven those that the R-protocol reports.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        if self._driving or self._halted:
            return await self._controller.joints()
        return codec.joints_of(await self._link.repeated(partial(self._ask, codec.FEEDBACK)))

    async def follow(self, way: Sequence[Pose]) -> None:
        """Pass all targets and return when the robot stands at the last one; it stands at every 60th, too.

        The way is driven once. When its answer is lost, the controller is asked where the robot is. A cancellation
        stops the robot before it goes on.

        Args:
            way: J1 deg, J2 deg, J3 mm, J4 deg of each target.

        Raises:
            AlarmError: an alarm came up.
            RefusedError: the program refuses, nothing moves.
            NotArrivedError: the robot stands somewhere else.
            LinkError: lost or silent; the robot has been stopped if it was moving.
            ProtocolError: garbage came.
            ValueError: no target, or a joint is not a finite number.
        """
        require_way(way)
        permit = self._controller.watch_stops()
        async with self._controller.guarded():
            await self._follow(way, permit)

    async def _follow(self, way: Sequence[Pose], permit: Callable[[], None]) -> None:
        try:
            for first in range(0, len(way), codec.MAX_POINTS):
                part = way[first : first + codec.MAX_POINTS]
                await self._lead(part, permit)
        except asyncio.CancelledError:
            await self.stop()
            raise

    async def stop(self) -> None:
        """Stop now over the R-protocol; see MelfaR3.stop. The program stands afterwards."""
        self._halted = True
        self._link.distrust("the program was stopped")
        await self._controller.stop()

    async def _lead(self, part: Sequence[Pose], permit: Callable[[], None]) -> None:
        # An answer to a point that came twice keeps the way back, and nothing moves.
        await sent_once(partial(self._prepare, part, permit), partial(self._drive, part[-1], permit))

    async def _prepare(self, part: Sequence[Pose], permit: Callable[[], None]) -> None:
        await self._ready(permit)
        await self._link.repeated(partial(self._send, part))

    async def _ready(self, permit: Callable[[], None]) -> None:
        """Have the program run, in a state in which it may move the arm."""
        if self._halted:
            await self._restart(permit)
        await self._link.repeated(self._link.ensure)

    async def _restart(self, permit: Callable[[], None]) -> None:
        if not self._settings.program:
            raise RefusedError(f"{self._link.where}: the program stands after a stop: {_START_IT}", 0)

        def hopeful() -> bool:
            # A stop is the reason that counts.
            permit()
            return not self._halted

        # A stop meanwhile sets it again.
        self._halted = False
        try:
            await self._controller.start_program(self._settings.program, permit)
            await reopened(self._open, hopeful)
        except BaseException:
            self._halted = True
            raise

    async def _open(self) -> None:
        """Open the link to a program that was just started.

        Raises:
            LinkError: the program does not run or answer yet, was stopped, or the link was closed.
        """
        if not (await self._controller.status()).running:
            raise LinkError(f"{self._link.where}: the program was started and does not run: {_START_IT}")
        await asyncio.sleep(_OPENS_S)
        if self._halted:
            raise LinkError(f"{self._link.where}: the program was stopped or the link closed: connect again")
        await self._link.open()

    async def _send(self, way: Sequence[Pose]) -> None:
        await self._ask(codec.FORGET)
        for count, target in enumerate(way, start=1):
            answer = await self._ask(codec.ADD, target)
            if round(answer.values[0]) != count:
                self._link.distrust("via points were miscounted")
                raise ProtocolError(
                    f"{self._link.where}: {count} via points were sent, the program counts {answer.values[0]:g}: "
                    "nothing was moved; check that no other program talks to this port"
                )

    async def _drive(self, target: Pose, permit: Callable[[], None]) -> None:
        # Asked here too: a stop may have left the link out of step, and is the reason that counts.
        permit()
        self._driving = True
        try:
            answer = await self._driven(permit)
        except NotSentError:
            raise
        except (LinkError, ProtocolError) as lost:
            self._halted = True
            await self._controller.account_for(target, lost)
            return
        finally:
            self._driving = False
        reached = codec.joints_of(answer)
        require_unlocked(self._link.where, await self._controller.status())
        if off := off_target(reached, target, self._settings):
            raise NotArrivedError(f"{self._link.where}: the motion is over, but {off}: {LOOK_WHY}")

    async def _driven(self, permit: Callable[[], None]) -> Record:
        """Drive; return the answer. Arm and program are watched meanwhile: one that is lost never comes.

        Raises:
            AlarmError: an alarm is active.
            RefusedError: the program refuses, nothing moves.
            LinkError: program or arm stands, or the controller does not say.
            ProtocolError: garbage came, or the controller refused a question.
        """
        drive = asyncio.ensure_future(
            self._ask(codec.DRIVE, timeout_s=self._settings.move_timeout_s, permit=permit)
        )
        standing = still = 0
        last: Pose | None = None
        try:
            while not drive.done():
                await asyncio.wait({drive}, timeout=_LOOK_S)
                if drive.done():
                    break
                with asking_under_way():
                    status, joints = await self._controller.status(), await self._controller.joints()
                # Once may be the moment in which the program goes from one statement to the next.
                standing = 0 if status.running else standing + 1
                still, last = still + 1 if joints == last else 0, joints
                if drive.done():
                    break
                if self._halted or status.alarm_number or standing >= _LOOKS:
                    raise LinkError(f"{self._link.where}: the program stands: see the controller's status")
                if still >= STILL_LOOKS:
                    # The program runs on, since it waits for the next request.
                    raise LinkError(f"{self._link.where}: the arm stands and the way is not answered")
            return drive.result()
        finally:
            drive.cancel()
            await asyncio.wait({drive})

    async def _ask(
        self,
        command: int,
        values: tuple[float, ...] = (),
        *,
        timeout_s: float | None = None,
        permit: Callable[[], None] | None = None,
    ) -> Record:
        number = self._next_number()
        answer = await self._link.request(
            codec.encode(number, command, values),
            RecordDecoder,
            timeout_s or self._settings.answer_timeout_s,
            # Points belong to the list that was begun on this very connection.
            repeat=Repeat.BOUND if command in {codec.ADD, codec.DRIVE} else Repeat.NEVER,
            permit=permit,
        )
        return await self._checked(answer, number, command)

    async def _checked(self, answer: Record, number: int, command: int) -> Record:
        if answer.number == number and answer.command == command:
            return answer
        if answer.number != number or answer.command not in {codec.UNKNOWN, codec.REFUSED}:
            self._link.distrust("an answer belongs to another request")
            raise ProtocolError(
                f"{self._link.where}: request {number},{command} was answered by {answer}: check that no other "
                "program talks to this port"
            )
        status = await self._controller.status()
        if status.alarm_number:
            raise AlarmError(f"{self._link.where}: {status.alarm_text}", status.alarm_number)
        refused = round(answer.values[0])
        raise RefusedError(
            f"{self._link.where} refused command {command} with {refused}: nothing was moved; compare the version of "
            "the program on the controller with the one shipped",
            refused,
        )

    async def _greet(self) -> None:
        # The program gives no serial number: behind a network that was changed, the R-protocol shows another robot.
        await self._controller.status()
        answer = await self._exchange(codec.WHO)
        version = round(answer.values[0])
        if version != _VERSION:
            raise WrongDeviceError(
                f"{self._link.where}: the program reports version {version}, this driver needs {_VERSION}: load the "
                "program CATSDL that is shipped with this version, see docs/controller.md"
            )
        await self._exchange(codec.SPEED, (100.0, float(self._settings.in_position_pulses)))

    def _next_number(self) -> int:
        self._number = self._number % 30_000 + 1
        return self._number

    async def _exchange(self, command: int, values: tuple[float, ...] = ()) -> Record:
        number = self._next_number()
        data = codec.encode(number, command, values)
        try:
            answer = await self._link.exchange(data, RecordDecoder(), self._settings.answer_timeout_s)
        except (LinkError, ProtocolError) as exc:
            # Silence stays silence: the program may just be slow.
            kind = type(exc) if isinstance(exc, LinkError) else WrongDeviceError
            raise kind(
                f"{self._link.where}: no data link program answers here: {_START_IT}; check that the port's "
                f"parameter CPRCE is 2 ({exc})"
            ) from exc
        if (answer.number, answer.command) != (number, command):
            raise WrongDeviceError(
                f"{self._link.where}: request {number},{command} was answered by {answer}: another program "
                f"answers here; {_START_IT}"
            )
        return answer
