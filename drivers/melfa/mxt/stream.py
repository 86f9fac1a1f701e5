"""One set point a cycle: datagrams out, datagrams in, losses counted."""

import asyncio
from collections.abc import Iterable

from catseye.drivers.links.transport import Transport
from catseye.drivers.melfa.mxt import codec
from catseye.drivers.melfa.mxt.codec import Command, Kind, Reply
from catseye.drivers.melfa.mxt.lag import WayTrace
from catseye.drivers.melfa.mxt.settings import MxtSettings
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import LinkError, LinkTimeoutError, ProtocolError, WrongDeviceError
from catseye.drivers.roles.pose import Pose

_TIMED_CYCLES = 8
_SHORTEST = 0.75
"""Of the time that these cycles should take; where the first one begins is not known."""

_END_SENDS = 2
"""A datagram may be lost; the controller takes END twice without harm."""


class SetPointStream:
    """The conversation of one way: where are you, set points, end.

    The controller answers each datagram once, at its next cycle: the answers set the pace. A lost answer is not asked
    for again; the next set point is sent instead, since the arm stands at the last one meanwhile.

    Args:
        clock: measures the controller's cycle.
    """

    def __init__(self, transport: Transport, clock: Clock, settings: MxtSettings, *, name: str) -> None:
        self._transport = transport
        self._clock = clock
        self._in_time = False
        self._settings = settings
        self._name = name
        self._count = 0
        self._missing = 0
        self._garbage: ProtocolError | None = None
        self.lost = 0

    @property
    def where(self) -> str:
        """Device and endpoint, for texts."""
        return f"{self._name} at {self._transport.endpoint}"

    async def begin(self) -> Pose:
        """Open the link and ask where the arm stands (command side): J1 deg, J2 deg, J3 mm, J4 deg.

        Raises:
            WrongDeviceError: the controller's cycle is shorter than the setting.
            LinkTimeoutError: nobody answers.
            LinkError: the link cannot be opened.
            ProtocolError: garbage came.
        """
        await self._open_anew()
        self._missing = 0
        attempts = self._settings.most_lost + 1
        for _ in range(attempts):
            reply = await self._asked()
            if reply is not None:
                await self._require_cycle()
                return self._joints(reply, Kind.JOINT_COMMAND)
        if self._garbage:
            raise self._garbage
        waited_s = attempts * self._settings.reply_timeout_s
        raise LinkTimeoutError(
            f"{self.where}: real-time control does not answer within {waited_s:g} s: start the program CATSMXT on "
            "the controller (key at AUTO), check the PC's address in it and the first element of NETPORT (10000)"
        )

    async def send(self, points: Iterable[Pose], trace: WayTrace) -> Pose | None:
        """Send set points, one a cycle; return the feedback that came last, None when every answer was lost.

        Args:
            trace: takes what was sent and what the encoders showed.

        Raises:
            LinkTimeoutError: too many answers in a row are missing.
            LinkError: the link is lost.
            ProtocolError: garbage came.
        """
        feedback: Pose | None = None
        for point in points:
            reply = await self._exchange(Command.MOVE, point)
            if reply is None:
                self._missing += 1
                self.lost += 1
                trace.lose()
                if self._missing > self._settings.most_lost:
                    if self._garbage:
                        raise self._garbage
                    raise LinkTimeoutError(
                        f"{self.where}: {self._missing} answers to set points in a row are missing: check network "
                        "and alarm"
                    )
                continue
            self._missing = 0
            feedback = self._joints(reply, Kind.JOINT_FEEDBACK)
            trace.add(point, feedback, reply.t_count)
        return feedback

    def end(self) -> None:
        """End the control at once; what the controller has to say about it helps nobody any more.

        Raises:
            LinkError: the link is closed.
        """
        for _ in range(_END_SENDS):
            self._count += 1
            self._transport.send_urgent(codec.encode(Command.END, self._count))

    async def close(self) -> None:
        """Close the link; may be called any number of times."""
        await self._transport.close()

    async def _open_anew(self) -> None:
        await self._transport.close()
        await self._transport.open()

    async def _asked(self) -> Reply | None:
        """Ask where the arm stands. A port that refuses now may be open soon: the program opens it anew after END."""
        try:
            return await self._exchange(Command.NONE, None)
        except LinkError:
            await asyncio.sleep(self._settings.reply_timeout_s)
            await self._open_anew()
            return None

    async def _require_cycle(self) -> None:
        """Measure the controller's cycle, once: a shorter one would make every motion faster than planned."""
        if self._in_time:
            return
        start_s = self._clock.monotonic_s()
        for _ in range(_TIMED_CYCLES):
            await self._exchange(Command.NONE, None)
        cycle_ms = (self._clock.monotonic_s() - start_s) * 1e3 / _TIMED_CYCLES
        if cycle_ms < _SHORTEST * self._settings.mxt_cycle_ms:
            self.end()
            raise WrongDeviceError(
                f"{self.where}: the controller answers every {cycle_ms:.1f} ms and mxt_cycle_ms is "
                f"{self._settings.mxt_cycle_ms:g}: the arm would move faster than it may; set mxt_cycle_ms in "
                "[robot.settings] to the controller's cycle (3.5 for CR800-R and CR800-D)"
            )
        self._in_time = True

    async def _exchange(self, command: Command, target: Pose | None) -> Reply | None:
        """Send one datagram; return the answer, None when no valid one comes in time."""
        self._count += 1
        self._garbage = None
        # A late answer would let the next set point follow within the same cycle.
        while self._transport.waiting():
            pass
        await self._transport.write(codec.encode(command, self._count, target))
        try:
            async with asyncio.timeout(self._settings.reply_timeout_s):
                while True:
                    # Garbage is waited out: another set point within the same cycle would be a jump.
                    if reply := self._decoded(await self._transport.read()):
                        return reply
        except TimeoutError:
            # Where this program itself was held up, the answer has come all the same.
            data = self._transport.waiting()
        return self._decoded(data) if data else None

    def _decoded(self, data: bytes) -> Reply | None:
        try:
            return codec.decode(data)
        except ProtocolError as exc:
            self._garbage = ProtocolError(
                f"{self.where}: {exc}: check that the port is the real-time port of the controller"
            )
            return None

    def _joints(self, reply: Reply, kind: Kind) -> Pose:
        joints = reply.joints(kind)
        if joints is None:
            raise ProtocolError(
                f"{self.where}: an answer without {kind.name} data: the declared type of Mxt has to be 1 (joint)"
            )
        return joints
