"""Orders to the program CATSKUKA: prepared, begun once, watched until it says what became of them.

An order has a number. It begins when the number is written to CATS_SEQ, and the program answers with it in CATS_TAKEN
and CATS_DONE. So whatever is lost on the way, the program is asked; no order is given twice. CATSKUKA takes an order
before it looks whether that was taken back (CATS_FOR): one that is not taken by then never moves anything.
"""

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from catseye.drivers.kuka import names
from catseye.drivers.kuka.heartbeat import heartbeat
from catseye.drivers.kuka.names import Command, Result
from catseye.drivers.kuka.proxy import Proxy
from catseye.drivers.kuka.settings import KukaSettings
from catseye.drivers.kuka.values import symbol_of, whole_of
from catseye.drivers.links.healing import Repeat
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import (
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    NotReadyError,
    ProtocolError,
    RefusedError,
)

_START: Final = "start CATSKUKA on the controller in AUT or EX, see docs/kuka.md"
_FEWEST_LOOKS: Final = 10
"""Answers that say that an order is not taken: on a busy machine time passes in which nobody looks."""

_REVOKED: Final = {names.PREPARED: "0"}


@dataclass(frozen=True)
class Order:
    """What the program is to do.

    Attributes:
        command: kind of motion.
        values: texts of the variables that say how far, by name.
    """

    command: Command
    values: Mapping[str, str]


class Orders:
    """Gives one order after the other.

    Args:
        proxy: connection for orders and for the questions about them.
        beat: connection for signs of life.
        clock: time of the polls.
    """

    def __init__(self, proxy: Proxy, beat: Proxy, clock: Clock, settings: KukaSettings) -> None:
        self._proxy = proxy
        self._beat = beat
        self._clock = clock
        self._settings = settings
        self._number = 0

    async def prepare(self, order: Order, permit: Callable[[], None]) -> int:
        """Write all of an order but what begins it; return its number. Nothing moves yet.

        Args:
            permit: asked right before anything is written that lets the arm move.

        Raises:
            NotReadyError: the program is another one, does not run, or is busy.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        number = await self._free_number()
        await self._proxy.write(_REVOKED)
        await self._proxy.write({names.STOP: "FALSE"}, permit=permit)
        await self._proxy.write({names.COMMAND: str(int(order.command)), **order.values})
        await self._proxy.write({names.PREPARED: str(number)}, permit=permit)
        return number

    async def carry_out(self, number: int, permit: Callable[[], None]) -> None:
        """Begin an order that is prepared; return when its motion is over.

        Raises:
            NotReadyError: the program does not run, or was stopped.
            RefusedError: the program refuses the order; nothing moves.
            NotArrivedError: the motion ended early.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        async with heartbeat(self._beat, self._settings.heartbeat_s):
            await self._begin(number, permit)
            await self._require_taken(number)
            await self._require_done(number)

    async def _free_number(self) -> int:
        """Return the number of the next order; one that was lost may arrive yet, and is never used again.

        Raises:
            NotReadyError: other programs are loaded, none runs, or an order is still under way.
        """
        asked = (names.PROGRAM_STATE, names.VERSION, names.SEQUENCE, names.TAKEN, names.DONE)
        try:
            state, *texts = await self._proxy.read_all(asked)
        except RefusedError as exc:
            raise NotReadyError(
                f"{exc}: copy CATSVARS.dat and CATSKUKA.src to the controller, {_START}", 0
            ) from None
        version, sequence, taken, done = map(whole_of, texts)
        if version != names.PROGRAM_VERSION:
            raise NotReadyError(
                f"{self._proxy.where}: CATSKUKA has version {version}, this program needs {names.PROGRAM_VERSION}: "
                "copy CATSVARS.dat and CATSKUKA.src to the controller again",
                0,
            )
        if symbol_of(state) != names.ACTIVE:
            raise NotReadyError(
                f"{self._proxy.where}: no program runs ({names.PROGRAM_STATE} is {state}): {_START}",
                0,
            )
        if taken != done:
            raise NotReadyError(
                f"{self._proxy.where}: order {taken} is still under way; if it stands, reset it and {_START}",
                0,
            )
        self._number = max(sequence, taken, self._number) + 1
        return self._number

    async def _begin(self, number: int, permit: Callable[[], None]) -> None:
        """Write the number; where the reply is lost, ask whether it was written."""
        try:
            await self._proxy.write({names.SEQUENCE: str(number)}, repeat=Repeat.NEVER, permit=permit)
        except (LinkError, ProtocolError):
            written = whole_of(await self._proxy.read(names.SEQUENCE)) == number
            if not written and await self._revoked(number):
                raise

    async def _revoked(self, number: int) -> bool:
        """Take an order back; return whether that came before the program took it."""
        await self._proxy.write(_REVOKED)
        return whole_of(await self._proxy.read(names.TAKEN)) != number

    async def _require_taken(self, number: int) -> None:
        """Wait until the program says that it has taken an order; one that it does not take is taken back.

        Raises:
            NotReadyError: it does not take it; nothing has moved.
        """
        time_s = asyncio.get_running_loop().time
        end_s, looks = time_s() + self._settings.taken_timeout_s, 0
        while time_s() < end_s or looks < _FEWEST_LOOKS:
            state, taken = await self._proxy.read_all((names.PROGRAM_STATE, names.TAKEN))
            if whole_of(taken) == number:
                return
            if symbol_of(state) != names.ACTIVE:
                break
            looks += 1
            await self._clock.sleep(self._settings.poll_s)
        if await self._revoked(number):
            raise NotReadyError(
                f"{self._proxy.where}: CATSKUKA has not taken order {number} ({looks} looks in "
                f"{self._settings.taken_timeout_s:g} s; {names.PROGRAM_STATE} is {state}); it is taken back and "
                f"moves nothing: if another program is selected, or a message waits, see to it; {_START}",
                0,
            )

    async def _require_done(self, number: int) -> None:
        try:
            async with asyncio.timeout(self._settings.move_timeout_s):
                result = await self._result(number)
        except TimeoutError:
            raise LinkTimeoutError(
                f"{self._proxy.where}: the motion is not over after {self._settings.move_timeout_s:g} s: is the "
                "override 0, or the distance too long for this speed?"
            ) from None
        if result is not Result.DONE:
            raise self._failure(result)

    async def _result(self, number: int) -> Result:
        """Wait for the end of an order; return what became of it.

        Raises:
            NotReadyError: the program stands.
        """
        while True:
            texts = await self._proxy.read_all((names.PROGRAM_STATE, names.DONE, names.RESULT))
            if whole_of(texts[1]) == number:
                return self._known(whole_of(texts[2]))
            if symbol_of(texts[0]) != names.ACTIVE:
                raise NotReadyError(
                    f"{self._proxy.where}: the program stands ({texts[0]}) before the motion is over: look at the "
                    f"messages of the controller; then reset the program and {_START}",
                    0,
                )
            await self._clock.sleep(self._settings.poll_s)

    def _known(self, number: int) -> Result:
        try:
            return Result(number)
        except ValueError:
            raise ProtocolError(f"{self._proxy.where}: {names.RESULT} = {number} means nothing") from None

    def _failure(self, result: Result) -> NotArrivedError | RefusedError:
        where = self._proxy.where
        match result:
            case Result.STOPPED | Result.STOP_STANDS:
                return RefusedError(f"{where}: a stop ended the motion", int(result))
            case Result.NO_HEARTBEAT:
                return NotArrivedError(
                    f"{where}: the program stopped the arm, since no sign of life came for 0.5 s: check the network "
                    "and the load of this computer"
                )
            case Result.TOO_LARGE:
                return RefusedError(
                    f"{where}: the increment is larger than {names.MOST_DEG} or {names.MOST_MM} allow: nothing moved",
                    int(result),
                )
            case Result.NOT_PREPARED:
                return RefusedError(
                    f"{where}: CATSKUKA took the order after it was taken back, or another program writes its "
                    "variables: nothing moved",
                    int(result),
                )
            case _:
                return RefusedError(
                    f"{where}: CATSKUKA refused the order ({result.name.lower().replace('_', ' ')}): does another "
                    "program write its variables?",
                    int(result),
                )
