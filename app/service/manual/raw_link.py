"""The link of one device, taken from its driver to send bytes by hand."""

import asyncio
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from functools import partial
from typing import Final

from catseye.app.cell.axes import may_move_an_arm
from catseye.app.engine.halt import HaltLimits, halt
from catseye.app.engine.instruments import stop_request
from catseye.app.errors import InterruptedRunError, SafetyError, UsageError, exit_code_of
from catseye.app.guard.raw import plain_connection, raw_connection, raw_guard
from catseye.app.protocol.answers import Answer, LinkTaken
from catseye.app.protocol.engine_events import Client, RawChanged
from catseye.app.protocol.requests import Raw
from catseye.app.protocol.run_events import WarningIssued
from catseye.app.service.errors import RefusedError, refusal_of
from catseye.app.service.manual.device_loan import ManualBench
from catseye.app.service.manual.raw_door import RawDoor, raw_door
from catseye.app.service.watching.bench_facts import BenchFacts, DeviceFacts
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.errors import DeviceError

_WRITE_S: Final = 2.0


class RawLink:
    """One device's link from the request that takes it to its return. It is under way from the moment it is made.

    Args:
        client: takes it.

    Attributes:
        device: its name in the cell file.
        begun: has a result when bytes may be sent, or says why they may not.
        aborted: why nothing may move before somebody has looked at the bench; empty while all is well.
    """

    def __init__(self, bench: ManualBench, request: Raw, client: Client) -> None:
        self.device = request.device
        self.begun: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()
        self.aborted = ""
        self._bench = bench
        self._arm = request.arm
        self._client = client
        self._transport: Transport | None = None
        self._door: RawDoor | None = None
        self._reason = ""
        self._given_back = False
        # An arm may move by what is sent; supposed as long as the device is not known.
        self._moves = True
        self._simulated = False
        self._task = asyncio.create_task(self._serve())
        self._task.add_done_callback(self._answer_if_unheard)

    def add_done_callback(self, done: Callable[["RawLink"], None]) -> None:
        """Call when the driver has its link again."""
        self._task.add_done_callback(lambda _: done(self))

    async def over(self) -> None:
        """Wait for the end."""
        await asyncio.wait({self._task})

    async def send(self, data: bytes) -> Answer:
        """Send bytes.

        Raises:
            RefusedError: the link is not open, or does not take them.
        """
        if self._transport is None:
            raise RefusedError(
                f"the link of {self.device} is not open: {self._reason or 'it is being opened'}"
            )
        try:
            if self._door is not None:
                self._door.require_closed()
            async with asyncio.timeout(_WRITE_S):
                await self._transport.write(data)
        except (DeviceError, SafetyError, TimeoutError) as error:
            text = str(error) or f"{self.device} does not take the bytes"
            self.end(text)
            raise RefusedError(text, exit_code_of(error)) from error
        return Answer()

    def give_back(self) -> None:
        """End on the word of whoever took it: what was started by hand goes on."""
        self._given_back = True
        self.end(f"{self._client.text} gave it back")

    def stop(self, reason: str) -> bool:
        """End and have the arm stopped, also one that is left to itself just now; return whether there is one."""
        if not self._moves or self._task.done():
            return False
        self._given_back = False
        # Its driver, which can stop it, has to have the link back.
        self.end(reason)
        return True

    def end(self, reason: str) -> None:
        """End; again does no harm."""
        if not self._reason:
            self._reason = reason
            self._task.cancel()

    async def _serve(self) -> None:
        # Nobody else owns the arm before its STOP is done, which its driver sends.
        async with AsyncExitStack() as owned:
            error = await self._passed(owned)
            if error is not None and not self.begun.done():
                self.begun.set_exception(refusal_of(error))
                return
            self._announce(on=False, reason=self._reason)
            if self._moves and not self._given_back:
                await self._stop_what_moves()

    async def _passed(self, owned: AsyncExitStack) -> Exception | None:
        """Let bytes pass until the end; return what ended it."""
        try:
            await self._pass_bytes(owned)
        except asyncio.CancelledError:
            # It was this link's own end; what follows is not to be cut short.
            self._task.uncancel()
            return InterruptedRunError(self._reason or "the engine ends")
        except Exception as failed:  # noqa: BLE001  # whatever ends it is announced; the engine lives on
            self._reason = self._reason or str(failed)
            return failed
        return None

    def _answer_if_unheard(self, _task: "asyncio.Task[None]") -> None:
        """Answer whoever asked: a task that is cancelled before its first step says nothing itself."""
        if not self.begun.done():
            self.begun.set_exception(refusal_of(InterruptedRunError(self._reason or "the engine ends")))

    async def _pass_bytes(self, owned: AsyncExitStack) -> None:
        facts = await self._bench.facts()
        device = _device(facts, self.device)
        self._require_permission(facts, device)
        stop = stop_request(device.driver, device.name, device.settings) if self._moves else None
        opened = await self._opening(device, stop, owned)
        async with self._bench.pool.detached(self.device), opened as transport:
            try:
                async with raw_door(
                    self._bench.door() if self._moves else None,
                    transport,
                    stop,
                    self._bench.clock,
                    self._door_opened,
                ) as self._door:
                    self._door.require_closed()
                    self._transport = transport
                    self.begun.set_result(LinkTaken(endpoint=device.endpoint))
                    self._announce(on=True)
                    try:
                        while True:
                            # What comes is shown as it passes.
                            await transport.read()
                    finally:
                        if self._moves and not self._given_back:
                            # Its driver, which sees it stand, has yet to connect.
                            self._door.stop()
            finally:
                self._transport = None

    async def _opening(
        self, device: DeviceFacts, stop: bytes | None, owned: AsyncExitStack
    ) -> AbstractAsyncContextManager[Transport]:
        record = partial(self._bench.record, self.device)
        if not self._moves:
            return plain_connection(device.endpoint, record)
        guard = await owned.enter_async_context(raw_guard(device.endpoint, self._guard_stopped))
        return raw_connection(
            guard,
            device.endpoint,
            stop,
            record,
            self._bench.folder,
            simulated=self._simulated,
            report=lambda text: self._bench.announce(WarningIssued(text=text)),
        )

    def _announce(self, *, on: bool, reason: str | None = None) -> None:
        self._bench.announce(
            RawChanged(
                device=self.device, on=on, by=self._client.text, client=self._client.client, reason=reason
            )
        )

    def _guard_stopped(self, reason: str) -> None:
        """End, and let nothing move before somebody has cleared it."""
        self.aborted = self.aborted or reason
        self._given_back = False
        self.end(reason)

    def _door_opened(self, trouble: str) -> None:
        """End; STOP has been sent to the arm, and its driver sees it stand."""
        self._given_back = False
        self.end(trouble)

    def _require_permission(self, facts: BenchFacts, device: DeviceFacts) -> None:
        if self._arm not in {None, facts.cell}:
            raise SafetyError(
                f"arm names {self._arm!r} and the cell is {facts.cell!r}: nothing was opened; check which robot it is"
            )
        identity = self._bench.identities().get(device.name)
        self._moves = may_move_an_arm(device.name, device.driver)
        self._simulated = identity is not None and identity.simulated
        if self._moves and self._arm is None and not self._simulated:
            raise UsageError(
                f"what is sent to {device.name} may move the arm: type the cell's name to let it pass, "
                f"--arm {facts.cell}"
            )

    async def _stop_what_moves(self) -> None:
        """Stop what was started by hand: whoever started it is gone."""
        try:
            async with self._bench.pool.acquired_robot(self.device) as robot:
                report = await halt(robot, self._bench.clock, HaltLimits(), lambda: None)
        except Exception as error:  # noqa: BLE001  # whatever fails: nobody but the operator can look now
            self.aborted = f"whether the arm of {self.device} moves is not known: look at it ({error})"
        else:
            if not report.standstill:
                self.aborted = f"standstill of {self.device} is not confirmed: {report.text}"
        if self.aborted:
            self._bench.announce(WarningIssued(text=self.aborted))


def _device(facts: BenchFacts, name: str) -> DeviceFacts:
    for device in facts.devices:
        if device.name == name:
            return device
    raise UsageError(
        f"the cell has no device {name!r}; there are {', '.join(device.name for device in facts.devices)}"
    )
