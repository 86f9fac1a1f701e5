"""Orders to the program CATSKUKA: prepared, and carried out as numbered orders are.

CATS_SEQ is the number, CATS_TAKEN and CATS_DONE answer with it, and CATS_FOR = 0 takes an order back.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from catseye.drivers.kuka import names
from catseye.drivers.kuka.names import Command, Result
from catseye.drivers.kuka.proxy import Proxy
from catseye.drivers.kuka.settings import KukaSettings
from catseye.drivers.kuka.values import symbol_of, whole_of
from catseye.drivers.links.beating import Beat, beating
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.motions import Motion
from catseye.drivers.links.orders import NumberedOrders, OrderLook, OrderRefusedError
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import NotArrivedError, NotReadyError, ProtocolError, RefusedError

_START: Final = (
    "confirm what the smartPAD shows, then reset and start CATSKUKA in AUT or EX, see docs/kuka.md"
)
_ALIVE_S: Final = 10.0
"""Between two questions on the connection for STOP: an old proxy closes one that is silent for 30 s. Real s."""

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


class Orders(NumberedOrders):
    """Gives one order after the other.

    Args:
        proxy: connection for orders and for the questions about them.
        beats: connections for signs of life.
        stop: connection on which STOP is kept ready.
        clock: time of the polls.
    """

    def __init__(
        self, proxy: Proxy, beats: Sequence[Proxy], stop: Proxy, clock: Clock, settings: KukaSettings
    ) -> None:
        super().__init__(proxy.where, names.PROGRAM, _START, clock, settings)
        self._proxy = proxy
        self._signs = beats
        self._stop = stop

    async def prepare(self, order: Order, permit: Callable[[], None]) -> int:
        """Write all of an order but what begins it, see that STOP is ready; return its number. Nothing moves yet.

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
        # Nothing moves that could not be stopped on this connection.
        await self._ask_stop()
        await self._proxy.write({names.PREPARED: str(number)}, permit=permit)
        return number

    async def carry_out(self, number: int, motion: Motion) -> None:
        """Carry out an order as all are; the connection for STOP is kept alive meanwhile."""
        async with beating((self._ask_stop,), _ALIVE_S, at_once=False):
            await super().carry_out(number, motion)

    async def look(self) -> OrderLook:
        """Ask for the program's state and the numbers that it answers with."""
        asked = (names.PROGRAM_STATE, names.TAKEN, names.DONE, names.RESULT)
        state, *numbers = await self._proxy.read_all(asked)
        taken, done, result = map(whole_of, numbers)
        return OrderLook(symbol_of(state) == names.ACTIVE, state, taken, done, result)

    async def _ask_stop(self) -> None:
        await self._stop.read(names.STOP)

    async def _write_number(self, number: int, permit: Callable[[], None]) -> None:
        await self._proxy.write({names.SEQUENCE: str(number)}, repeat=Repeat.NEVER, permit=permit)

    async def _written_number(self) -> int:
        return whole_of(await self._proxy.read(names.SEQUENCE))

    async def _take_back(self) -> None:
        await self._proxy.write(_REVOKED)

    def _beats(self, permit: Callable[[], None]) -> Sequence[Beat]:
        sign = {names.BEAT: "TRUE"}
        return [partial(proxy.write, sign, repeat=Repeat.NEVER, permit=permit) for proxy in self._signs]

    def _require_done(self, result: int) -> None:
        if (known := self._known(result)) is not Result.DONE:
            raise self._failure(known)

    async def _free_number(self) -> int:
        """Return the number of the next order.

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
                f"{self._proxy.where}: order {taken} is still under way; if it stands, {_START}",
                0,
            )
        return self._unused(sequence, taken)

    def _known(self, number: int) -> Result:
        try:
            return Result(number)
        except ValueError:
            raise ProtocolError(f"{self._proxy.where}: {names.RESULT} = {number} means nothing") from None

    def _failure(self, result: Result) -> NotArrivedError | OrderRefusedError:
        where = self._proxy.where
        match result:
            case Result.STOPPED | Result.STOP_STANDS:
                return OrderRefusedError(f"{where}: a stop ended the motion", int(result))
            case Result.UNDER_WAY:
                return self._begun_anew()
            case Result.NO_HEARTBEAT:
                return NotArrivedError(
                    f"{where}: the program stopped the arm, since no heartbeat came for 0.5 s: check the network "
                    "and the load of this computer"
                )
            case Result.TOO_LARGE:
                return OrderRefusedError(
                    f"{where}: the step is larger than {names.MOST_DEG} or {names.MOST_MM} allow: nothing moved",
                    int(result),
                )
            case Result.NOT_PREPARED:
                return OrderRefusedError(
                    f"{where}: CATSKUKA took the order after it was taken back, or another program writes its "
                    "variables: nothing moved",
                    int(result),
                )
            case _:
                return OrderRefusedError(
                    f"{where}: CATSKUKA refused the order ({result.name.lower().replace('_', ' ')}): does another "
                    "program write its variables?",
                    int(result),
                )
