"""Orders to a program of ours on a controller: begun once, watched until it says what became of them.

An order has a number. It begins when the number is written, and the program answers with it, when it takes the order
and when it is done. So whatever is lost on the way, the program is asked; no order is given twice. The program takes
an order before it looks whether that was taken back: one that is not taken by then never moves anything.
"""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final, Protocol, TypeVar

from catseye.drivers.links.beating import Beat, beating
from catseye.drivers.links.motions import Motion, seen_in_time
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import (
    DeviceError,
    LinkTimeoutError,
    NotArrivedError,
    NotReadyError,
    RefusedError,
)

T = TypeVar("T")

_FEWEST_LOOKS: Final = 10
"""Answers that say that an order is not taken: on a busy machine time passes in which nobody looks."""


class OrderRefusedError(RefusedError):
    """The program on the controller is done with an order that it refused or that a stop ended: the arm stands."""


@dataclass(frozen=True)
class OrderLook:
    """What a controller says of the program and its order.

    Attributes:
        active: the program runs.
        state: of the program, as the controller words it.
        taken: number of the order taken last.
        done: number of the order done last.
        result: what became of that.
    """

    active: bool
    state: str
    taken: int
    done: int
    result: int


class OrderSettings(Protocol):
    """Times of orders; real seconds, except `poll_s`."""

    @property
    def answer_timeout_s(self) -> float:
        """For one answer."""
        ...

    @property
    def taken_timeout_s(self) -> float:
        """For the program to take an order."""
        ...

    @property
    def move_timeout_s(self) -> float:
        """For a whole motion."""
        ...

    @property
    def heartbeat_s(self) -> float:
        """Between two signs of life."""
        ...

    @property
    def poll_s(self) -> float:
        """Pause between two looks, on the driver's clock."""
        ...


class NumberedOrders(ABC):
    """Carries out one order after the other.

    Args:
        where: robot and endpoint, for texts.
        program: name of the program, for texts.
        advice: what to do where the program stands.
        clock: time of the polls.
    """

    def __init__(self, where: str, program: str, advice: str, clock: Clock, times: OrderSettings) -> None:
        self._where = where
        self._program = program
        self._advice = advice
        self._clock = clock
        self._times = times
        self._latest = 0
        self._under_way = False

    @contextmanager
    def one_alone(self) -> Iterator[None]:
        """Give an order meanwhile, and no second one: two that are prepared at once mix their goals.

        Raises:
            NotReadyError: an order of this driver is under way; it goes on.
        """
        if self._under_way:
            raise NotReadyError(
                f"{self._where}: a motion of this driver is under way, which goes on; a second one is refused: wait "
                "for its end, or stop it",
                0,
            )
        self._under_way = True
        try:
            yield
        finally:
            self._under_way = False

    @abstractmethod
    async def look(self) -> OrderLook:
        """Ask the controller."""

    @abstractmethod
    async def _write_number(self, number: int, permit: Callable[[], None]) -> None:
        """Write the number, once: the order begins."""

    @abstractmethod
    async def _written_number(self) -> int:
        """Return the number that was written last."""

    @abstractmethod
    async def _take_back(self) -> None:
        """Take an order back: the program refuses it from then on."""

    @abstractmethod
    def _beats(self, permit: Callable[[], None]) -> Sequence[Beat]:
        """Return what gives a sign of life, once, on each connection for them."""

    @abstractmethod
    def _require_done(self, result: int) -> None:
        """Check what became of an order.

        Raises:
            OrderRefusedError: it was refused, or ended by a stop.
            NotArrivedError: its motion ended early.
            ProtocolError: the result means nothing.
        """

    def _unused(self, *known: int) -> int:
        """Return a number above all that are known; one that was lost may arrive yet, and is not used again."""
        self._latest = max(self._latest, *known) + 1
        return self._latest

    def _begun_anew(self) -> NotArrivedError:
        """Return that the program began again and called an order done whose motion was not over."""
        return NotArrivedError(
            f"{self._where}: {self._program} was restarted before the motion was over; see where the arm stands"
        )

    async def carry_out(self, number: int, motion: Motion) -> None:
        """Begin an order that is prepared; return when its motion is over.

        Where it fails, the arm is stopped before anything else is waited for; a connection that falls silent fails
        before it is healed for long, see `seen_in_time`. Signs of life let the arm move on, so there are none once a
        stop has begun.

        Raises:
            NotReadyError: the program does not run, or was stopped.
            RefusedError: a stop overtook it, the program refuses it, or the controller refuses a question.
            NotArrivedError: the motion ended early.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        async with beating(self._beats(motion.require_no_stop), self._times.heartbeat_s):
            try:
                await self._in_time(self._begin(number, motion.permit))
                await self._require_taken(number)
                self._require_done(await self._result_in_time(number))
            except OrderRefusedError:
                raise
            except Exception as exc:
                await motion.stop_after(exc)
                raise

    async def _in_time(self, look: Awaitable[T]) -> T:
        return await seen_in_time(look, self._times.answer_timeout_s, self._where)

    async def _begin(self, number: int, permit: Callable[[], None]) -> None:
        """Write the number; where the reply is lost or an error, ask whether it was written."""
        try:
            await self._write_number(number, permit)
        except DeviceError:
            # Where a stop or the guard kept it from being written there is nothing to ask.
            permit()
            if await self._written_number() != number and await self._revoked(number):
                raise

    async def _revoked(self, number: int) -> bool:
        """Take an order back; return whether that came before the program took it."""
        await self._take_back()
        return (await self.look()).taken != number

    async def _require_taken(self, number: int) -> None:
        """Wait until the program says that it has taken an order; one that it does not take is taken back.

        Raises:
            NotReadyError: it does not take it; nothing has moved.
        """
        time_s = asyncio.get_running_loop().time
        end_s, looks = time_s() + self._times.taken_timeout_s, 0
        while time_s() < end_s or looks < _FEWEST_LOOKS:
            seen = await self._in_time(self.look())
            if seen.taken == number:
                return
            if not seen.active:
                break
            looks += 1
            await self._clock.sleep(self._times.poll_s)
        if await self._in_time(self._revoked(number)):
            raise NotReadyError(
                f"{self._where}: {self._program} has not taken order {number} ({looks} looks in "
                f"{self._times.taken_timeout_s:g} s; the program is {seen.state}); it is taken back and moves "
                f"nothing: if another program is selected, or a message waits, see to it; {self._advice}",
                0,
            )

    async def _result_in_time(self, number: int) -> int:
        try:
            async with asyncio.timeout(self._times.move_timeout_s):
                return await self._result(number)
        except TimeoutError:
            raise LinkTimeoutError(
                f"{self._where}: the motion is not over after {self._times.move_timeout_s:g} s: is the override 0, "
                "or the distance too long for this speed?"
            ) from None

    async def _result(self, number: int) -> int:
        """Wait for the end of an order; return what became of it.

        Raises:
            NotReadyError: the program stands.
        """
        while True:
            seen = await self._in_time(self.look())
            if seen.done == number:
                return seen.result
            if not seen.active:
                raise NotReadyError(
                    f"{self._where}: the program stands ({seen.state}) before the motion is over: look at the "
                    "messages of the controller. Started without a reset it goes on with this motion, or is refused "
                    f"the same point again, as one beyond a software limit: {self._advice}",
                    0,
                )
            await self._clock.sleep(self._times.poll_s)
