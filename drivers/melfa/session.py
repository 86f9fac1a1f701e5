"""One connection to a MELFA controller: opened, recognised, asked; rejections become errors."""

import contextlib
from collections.abc import Awaitable, Callable
from functools import partial
from typing import TypeVar

from catseye.drivers.links.endpoint import SerialEndpoint, parse_endpoint
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.melfa import codec
from catseye.drivers.melfa.alarms import NOT_READY, NOT_UNDERSTOOD, describe
from catseye.drivers.melfa.codec import Answer, Layout, Opened, State
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.errors import (
    AlarmError,
    DeviceError,
    LinkError,
    NotReadyError,
    NotSentError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotStatus

T = TypeVar("T")

_JOINTS_OF_A_SCARA = 0x0F
_QUIET_BYTES = 8
_LONGEST_USUAL_ANSWER_BYTES = 512
_CAUTION = 3


def byte_time_s(endpoint: str) -> float:
    """Return the time of one byte on a serial line, 0.0 on a network.

    Raises:
        ValueError: the text is no endpoint.
    """
    line = parse_endpoint(endpoint)
    if not isinstance(line, SerialEndpoint):
        return 0.0
    return line.settings.character_s


async def _understood(request: Callable[[], Awaitable[Answer]]) -> Answer:
    """Make a harmless request, and once more if it was not understood: bytes of it may have been lost on its way."""
    answer = await request()
    return await request() if answer.number in NOT_UNDERSTOOD else answer


async def _nothing() -> None:
    """Ask for nothing more than the identity."""


def _scara_joints(payload: str) -> Pose:
    axes = codec.parse_positions(payload)
    try:
        return axes["J1"], axes["J2"], axes["J3"], axes["J4"]
    except KeyError as exc:
        raise ProtocolError(f"axis {exc} is missing in {payload[:64]!r}") from None


class Session:
    """An R-protocol session.

    Args:
        set_up: runs after each opening, the first one and those that heal; may use `greet_ask` only.
        byte_s: time of one byte on a serial line, real s; 0 on a network.
    """

    def __init__(
        self,
        transport: Transport,
        settings: MelfaSettings,
        *,
        name: str,
        set_up: Callable[[], Awaitable[None]] = _nothing,
        byte_s: float = 0.0,
    ) -> None:
        self._settings = settings
        self._set_up = set_up
        self._byte_s = byte_s
        # On RS-232 every answer ends with CR (sheet 1.2): there silence ends none.
        self._terminated = byte_s > 0.0
        self._opened: Opened | None = None
        self._cut = (settings.terminator or "\r").encode("ascii")
        quiet_s = settings.quiet_s + _QUIET_BYTES * byte_s
        self.link = RequestLink(transport, name=name, greet=self._greet, quiet_s=quiet_s, stays_writable=True)

    @property
    def where(self) -> str:
        """Device and endpoint, for texts."""
        return self.link.where

    async def open(self) -> Opened:
        """Connect and recognise the controller.

        Raises:
            WrongDeviceError: something else answers, or another robot.
            LinkError: unreachable or silent.
        """
        await self.link.open()
        if not self._opened:
            raise ProtocolError(f"{self.where}: OPEN was not answered")
        return self._opened

    async def close(self, *commands: str) -> None:
        """Say goodbye as far as the link allows, then disconnect. Bounded in time."""
        for command in (*commands, "CLOSE"):
            # The connection is given up: what the controller has to say about it helps nobody any more.
            with contextlib.suppress(DeviceError):
                await self.ask(command, codec.bare, repeat=Repeat.BOUND)
        await self.link.close()

    async def ask(
        self,
        command: str,
        layout: Layout,
        *,
        timeout_s: float | None = None,
        repeat: Repeat = Repeat.NEVER,
        permit: Callable[[], None] | None = None,
    ) -> Answer:
        """Send a request; return the accepted answer.

        Args:
            command: the command word with its argument.
            timeout_s: real s; the setting `answer_timeout_s` by default.
            repeat: what may be done when the answer is lost.
            permit: is asked when the request's turn has come; what it raises keeps it from being sent.

        Raises:
            AlarmError: rejected, and an alarm is active.
            NotReadyError: rejected for a reason that an operator has to look at.
            RefusedError: rejected for another reason.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        request = partial(self._requested, command, layout, timeout_s=timeout_s, repeat=repeat, permit=permit)
        answer = await (_understood(request) if repeat is Repeat.HARMLESS else request())
        if not answer.accepted:
            raise await self._rejection(command, answer)
        return answer

    async def _requested(
        self,
        command: str,
        layout: Layout,
        *,
        timeout_s: float | None,
        repeat: Repeat,
        permit: Callable[[], None] | None,
    ) -> Answer:
        """Return the answer to a request, accepted or not."""
        data = self._encode(command)
        answer = await self.link.request(
            data,
            partial(codec.AnswerDecoder, layout, terminated=self._terminated),
            self._timeout_s(data, timeout_s),
            repeat=repeat,
            permit=permit,
        )
        self._terminated |= answer.terminated
        return answer

    async def command(
        self,
        command: str,
        *,
        timeout_s: float | None = None,
        repeat: Repeat = Repeat.NEVER,
        permit: Callable[[], None] | None = None,
    ) -> None:
        """Give a command that has no payload in its answer and must not be taken in an alarm; see `ask`.

        Raises:
            AlarmError: an alarm is active.
            RefusedError: rejected.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        answer = await self.ask(command, codec.bare, timeout_s=timeout_s, repeat=repeat, permit=permit)
        if answer.payload:
            raise self._wrong(command, f"{answer.payload[:64]!r} came behind QoK")
        if answer.alarm:
            await self.raise_alarm(command)

    async def question(self, command: str, layout: Layout, parse: Callable[[str], T]) -> T:
        """Ask something harmless; return what the answer says. It is asked again when the answer is lost or garbage.

        So is what the controller has not understood: it may have lost bytes on its way.

        Raises:
            RefusedError: rejected.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return (await self._ask_parsed(command, layout, parse))[0]

    async def _ask_parsed(self, command: str, layout: Layout, parse: Callable[[str], T]) -> tuple[T, Answer]:
        async def once() -> tuple[T, Answer]:
            answer = await self.ask(command, layout)
            return self.parsed(command, parse, answer), answer

        try:
            try:
                return await self.link.repeated(once)
            except RefusedError as exc:
                if exc.number not in NOT_UNDERSTOOD:
                    raise
            return await self.link.repeated(once)
        except NotSentError as exc:
            # Only of a command does this mean anything to its sender; a question may follow one that was sent.
            raise LinkError(str(exc)) from exc

    async def greet_ask(self, command: str, layout: Layout) -> Answer:
        """Ask while the link is being opened.

        Raises:
            RefusedError: rejected.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        answer = await _understood(partial(self._greeted, command, layout))
        if not answer.accepted:
            raise self._refused(command, answer.number)
        return answer

    async def _greeted(self, command: str, layout: Layout) -> Answer:
        decoder = codec.AnswerDecoder(layout, terminated=self._terminated)
        data = self._encode(command)
        answer = await self.link.exchange(data, decoder, self._timeout_s(data))
        self._terminated |= answer.terminated
        return answer

    async def state(self) -> State:
        """Ask for run state, stop sources and program line (STATE)."""
        return await self.question("STATE", codec.state_text, codec.parse_state)

    async def status(self) -> RobotStatus:
        """Ask STATE, and ERROR too when an alarm is flagged."""
        state, answer = await self._ask_parsed("STATE", codec.state_text, codec.parse_state)
        number, level = await self.alarm() if answer.alarm or state.error else (0, 0)
        number = number or state.error
        return RobotStatus(
            servo_on=state.servo_on,
            running=state.running,
            operation_enabled=state.operation_enabled,
            teach_mode=state.teach_mode,
            emergency_stop=state.emergency_stop,
            override_percent=state.override_percent,
            alarm_number=number,
            alarm_text=describe(number, level) if number else "",
            program=state.program,
            machine_locked=state.machine_locked,
        )

    async def joints(self) -> Pose:
        """Ask JPOSF: J1 deg, J2 deg, J3 mm, J4 deg."""
        return await self.question("JPOSF", codec.positions_text, _scara_joints)

    async def alarm(self) -> tuple[int, int]:
        """Ask ERROR: alarm number and level, both 0 when there is none; a caution stops nothing and is none."""
        number, level = await self.question("ERROR", codec.error_text, codec.parse_error)
        return (number, level) if level != _CAUTION else (0, 0)

    async def raise_alarm(self, command: str) -> None:
        """Raise the active alarm, if there is one.

        Raises:
            AlarmError: with number, meaning and remedy.
        """
        number, level = await self.alarm()
        if number:
            raise AlarmError(f"{self.where}: {describe(number, level)} (found at {command})", number)

    def _timeout_s(self, data: bytes, timeout_s: float | None = None) -> float:
        """Return the time for an answer: that of the controller, and that of all bytes on a serial line."""
        line_s = self._byte_s * (len(data) + _LONGEST_USUAL_ANSWER_BYTES)
        return (timeout_s or self._settings.answer_timeout_s) + line_s

    def _encode(self, command: str) -> bytes:
        settings = self._settings
        return codec.encode(
            command, robot=settings.robot_number, slot=settings.slot, terminator=settings.terminator
        )

    def send_urgent(self, command: str) -> None:
        """Hand a command to the operating system at once, past whatever is in flight; its answer is not waited for.

        Raises:
            LinkError: the link is closed or takes no bytes.
        """
        data = self._encode(command)
        if not self._settings.terminator:
            # Where its segment ends a request, two that meet in the controller's buffer would be one.
            data = self._cut + data + self._cut
        self.link.send_urgent(data, cut=self._cut)

    async def _rejection(self, command: str, answer: Answer) -> RefusedError:
        """Return the error of a rejection: the active alarm if there is one, else the rejection itself."""
        refused = self._refused(command, answer.number)
        if command == "ERROR":
            return refused
        number, level = await self.alarm()
        if not number or number == answer.number:
            return AlarmError(str(refused), answer.number) if number else refused
        return AlarmError(f"{refused}; active is {describe(number, level)}", number)

    def _refused(self, command: str, number: int) -> RefusedError:
        kind = NotReadyError if number in NOT_READY else RefusedError
        return kind(f"{self.where} refused {command}: {describe(number)}", number)

    def parsed(self, command: str, parse: Callable[[str], T], answer: Answer) -> T:
        """Return what an answer says, or distrust the link.

        Raises:
            ProtocolError: it says something else.
        """
        try:
            return parse(answer.payload)
        except ProtocolError as exc:
            raise self._wrong(command, str(exc)) from None

    def _wrong(self, command: str, what: str) -> ProtocolError:
        """Return the error of an answer that cannot belong to the request, and distrust the link."""
        self.link.distrust(f"{command} had an answer of another layout")
        return ProtocolError(
            f"{self.where}: {command}: {what}; last bytes {self.link.last_bytes!r}: "
            "check that nothing else talks to this port and that the firmware speaks the R-protocol"
        )

    async def _greet(self) -> None:
        try:
            opened = await self._who()
            if not self._is_expected(opened):
                # A name that lost a character on its way is another one.
                opened = await self._who()
        except (LinkError, ProtocolError) as exc:
            raise self._stranger(exc) from None
        self._check_model(opened)
        await self._set_up()
        self._opened = opened

    async def _who(self) -> Opened:
        answer = await self.greet_ask(f"OPEN={self._settings.client_name}", codec.open_text)
        return codec.parse_open(answer.payload)

    def _stranger(self, cause: DeviceError) -> DeviceError:
        """Return the error of an OPEN that failed: a stranger if bytes came, else the cause."""
        came = self.link.greeting or self.link.last_bytes
        if not came or self._opened:
            return cause
        return WrongDeviceError(
            f"{self.where}: no MELFA controller answers here, its first bytes are {came!r}: check host and "
            "port in the cell file (10001 is the factory setting) and that the port's parameter CPRCE is 0 "
            f"(R-protocol); {cause}"
        )

    def _is_expected(self, opened: Opened) -> bool:
        arm = opened.joints & _JOINTS_OF_A_SCARA == _JOINTS_OF_A_SCARA
        return arm and opened.model.startswith(self._settings.expected_model)

    def _check_model(self, opened: Opened) -> None:
        expected = self._settings.expected_model
        if not self._is_expected(opened):
            raise WrongDeviceError(
                f"{self.where}: the controller drives a {opened.model!r} with joints {opened.joints:02X}, "
                f"expected is a {expected!r} with joints 0F at least: check the endpoint, or set "
                "expected_model in the cell file if this is the robot to be measured"
            )
        if self._opened and (opened.model, opened.serial) != (self._opened.model, self._opened.serial):
            raise WrongDeviceError(
                f"{self.where}: after the link was opened again a {opened.model!r}, serial "
                f"{opened.serial!r}, answers instead of the {self._opened.model!r}, serial "
                f"{self._opened.serial!r}: check the network"
            )
