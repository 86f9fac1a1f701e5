"""Orders to the module CATSABB: its program started where it stands, prepared, carried out as numbered orders are.

cats_seq is the number, cats_taken and cats_done answer with it, and cats_for = 0 takes an order back.
"""

import asyncio
from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

from catseye.drivers.abb import names
from catseye.drivers.abb.names import Result
from catseye.drivers.abb.service import Service
from catseye.drivers.abb.settings import AbbSettings
from catseye.drivers.abb.state import mains_if_answered, mains_of, other_program, own_main
from catseye.drivers.abb.values import goal_text, whole_of
from catseye.drivers.links.beating import Beat, beating
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.motions import Motion
from catseye.drivers.links.orders import NumberedOrders, OrderLook, OrderRefusedError
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import (
    DeviceError,
    NotArrivedError,
    NotReadyError,
    RefusedError,
)
from catseye.drivers.roles.pose import Pose

START: Final = "set the program pointer to main and start CATSABB at the pendant in AUTO, see docs/abb.md"


class Orders(NumberedOrders):
    """Gives one order after the other.

    Args:
        orders: connection for orders and for the questions about them.
        beats: connections for signs of life.
        stop: connection on which STOP is kept ready.
        clock: time of the polls.
    """

    def __init__(
        self, orders: Service, beats: Sequence[Service], stop: Service, clock: Clock, settings: AbbSettings
    ) -> None:
        super().__init__(orders.where, names.MODULE, START, clock, settings)
        self._service = orders
        self._signs = beats
        self._stop = stop
        self._settings = settings
        self._beat_count = 0
        self._known = False

    def forget(self) -> None:
        """Look at the module anew before the next order."""
        self._known = False

    async def prepare(self, target: Pose, permit: Callable[[], None]) -> int:
        """Write all of an order but what begins it, see that STOP is ready; return its number. Nothing moves yet.

        Args:
            permit: asked right before anything is written that lets the arm move.

        Raises:
            NotReadyError: the module is another one, its program does not start, or is busy.
            RefusedError: refused, for instance since another client holds mastership.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        running = await self.is_running()
        if not (running and self._known):
            # Modules are loaded where RAPID stands.
            await self._require_module()
            if running:
                await self._require_no_other_program()
            self._known = True
        if not running:
            await self._started(permit)
        number = await self._free_number()
        await self._take_back()
        await self._write(names.GOAL, goal_text(target))
        # Nothing moves that could not be stopped on this connection.
        await self._stop.renew()
        await self._write(names.PREPARED, str(number), permit=permit)
        return number

    async def carry_out(self, number: int, motion: Motion) -> None:
        """Carry out an order as all are; STOP is kept ready meanwhile."""
        async with beating((self._stop.renew,), self._settings.renewal_s, at_once=False):
            await super().carry_out(number, motion)

    async def is_running(self) -> bool:
        """Return whether RAPID runs."""
        return await self._service.value(names.EXECUTION, "ctrlexecstate") == names.RUNNING

    async def main_is_ours(self) -> bool:
        """Return whether the task's main is that of CATSABB; what the controller does not say is taken for no."""
        return await mains_of(self._service, self._settings.task) == [own_main(self._settings.task)]

    async def look(self) -> OrderLook:
        """Ask whether RAPID runs, and for the numbers that the program answers with."""
        running = await self._service.value(names.EXECUTION, "ctrlexecstate")
        taken, done, result = [await self._number(name) for name in (names.TAKEN, names.DONE, names.RESULT)]
        return OrderLook(running == names.RUNNING, running, taken, done, result)

    async def _require_module(self) -> None:
        try:
            version = await self._number(names.VERSION)
        except RefusedError as exc:
            raise NotReadyError(
                f"{exc}: load CATSABB.mod into the task {self._settings.task}, then {START}", 0
            ) from None
        if version != names.MODULE_VERSION:
            raise NotReadyError(
                f"{self._where}: CATSABB has version {version}, this program needs {names.MODULE_VERSION}: load "
                "CATSABB.mod again",
                0,
            )

    async def _require_no_other_program(self) -> None:
        """Check whose program runs, as far as the controller says it: CATSABB takes no order beside another one."""
        task = self._settings.task
        if other := other_program(task, await mains_if_answered(self._service, task)):
            raise NotReadyError(
                f"{self._where}: the program of {other} runs instead of CATSABB and may move the arm at any time: "
                f"nothing was ordered; stop it at the pendant, unload {other}, then {START}",
                0,
            )

    async def _started(self, permit: Callable[[], None]) -> None:
        """Start the program from main, which moves nothing: an order from before is not carried out.

        Raises:
            NotReadyError: main is another program's, or the program does not start.
        """
        if not await self.main_is_ours():
            raise NotReadyError(
                f"{self._where}: no program runs, and the controller does not say that main of {self._settings.task} "
                f"is that of CATSABB: {START}",
                0,
            )
        try:
            number = await self._marked(permit)
            await self._service.ask(names.RESET, permit=permit)
            await self._begun(permit)
        except NotReadyError:
            raise
        except RefusedError as exc:
            # A stop that overtook the start is no refusal of the controller's.
            permit()
            raise NotReadyError(f"{exc}: {START}", exc.number) from None
        await self._require_started(number)

    async def _marked(self, permit: Callable[[], None]) -> int:
        """Write a number that moves nothing; once the program says that it is done, its beginning is passed.

        The numbers from before say nothing: an order that is written too early would be taken for one from before.
        """
        sequence, taken = [await self._number(name) for name in (names.SEQUENCE, names.TAKEN)]
        await self._take_back()
        number = self._next_number(sequence, taken)
        await self._write(names.SEQUENCE, str(number), permit=permit)
        return number

    async def _begun(self, permit: Callable[[], None]) -> None:
        """Start once; where the answer is lost or an error, whether the program runs is asked afterwards."""
        try:
            await self._service.ask(names.START, repeat=Repeat.NEVER, permit=permit)
        except DeviceError:
            if not await self.is_running():
                raise

    async def _require_started(self, number: int) -> None:
        """Wait until the program has passed its beginning, where it takes an order from before for done."""
        try:
            async with asyncio.timeout(self._settings.start_timeout_s):
                while (seen := await self.look()).taken != number or seen.done != number:
                    await self._clock.sleep(self._settings.poll_s)
        except TimeoutError:
            raise NotReadyError(
                f"{self._where}: CATSABB was started and does not say so after {self._settings.start_timeout_s:g} s: "
                f"look at the event log; {START}",
                0,
            ) from None

    async def _free_number(self) -> int:
        """Return the number of the next order.

        Raises:
            NotReadyError: an order is still under way.
        """
        sequence, taken, done = [
            await self._number(name) for name in (names.SEQUENCE, names.TAKEN, names.DONE)
        ]
        if taken != done:
            raise NotReadyError(f"{self._where}: order {taken} is still under way; if it stands, {START}", 0)
        return self._next_number(sequence, taken)

    def _next_number(self, *known: int) -> int:
        return (self._unused(*known) - 1) % names.LARGEST_NUMBER + 1

    async def _write_number(self, number: int, permit: Callable[[], None]) -> None:
        await self._write(names.SEQUENCE, str(number), repeat=Repeat.NEVER, permit=permit)

    async def _written_number(self) -> int:
        return await self._number(names.SEQUENCE)

    async def _take_back(self) -> None:
        await self._write(names.PREPARED, "0")

    def _beats(self, permit: Callable[[], None]) -> Sequence[Beat]:
        return [partial(self._beat, service, permit) for service in self._signs]

    async def _beat(self, service: Service, permit: Callable[[], None]) -> None:
        self._beat_count = self._beat_count % names.LARGEST_NUMBER + 1
        request = names.data_set(self._settings.task, names.BEAT, str(self._beat_count))
        await service.ask(request, repeat=Repeat.NEVER, permit=permit)

    def _require_done(self, result: int) -> None:
        if result == Result.NO_HEARTBEAT:
            raise NotArrivedError(
                f"{self._where}: CATSABB stopped the arm, since no heartbeat came for 0.4 s: check the network "
                "and the load of this computer"
            )
        if result == Result.UNDER_WAY:
            raise self._begun_anew()
        if result != Result.DONE:
            raise OrderRefusedError(
                f"{self._where}: CATSABB took the order after it was taken back, or another program writes its data "
                f"({names.RESULT} is {result}): nothing moved",
                result,
            )

    async def _number(self, name: str) -> int:
        return whole_of(await self._service.value(names.data(self._settings.task, name), "value"))

    async def _write(
        self,
        name: str,
        text: str,
        *,
        repeat: Repeat = Repeat.HARMLESS,
        permit: Callable[[], None] | None = None,
    ) -> None:
        request = names.data_set(self._settings.task, name, text)
        await self._service.ask(request, repeat=repeat, permit=permit)
