"""The conversation of one client with its session: when answers and unrequested output leave."""

import asyncio
from typing import Protocol

from catseye.simulators.ports.lossy import Lossy
from catseye.simulators.ports.session import Answer, Pending, Session
from catseye.simulators.world.timekeeper import TimeKeeper

_BACKLOG_BYTES = 65_536


class Faults:
    """What is wrong with a device's endpoint, for all its clients at once."""

    def __init__(self, keeper: TimeKeeper) -> None:
        self.keeper = keeper
        self.muted = False
        self.lossy: Lossy | None = None
        self.stalled_until_s = 0.0
        self.off_until_s = 0.0

    @property
    def is_off(self) -> bool:
        """The device has no power."""
        return self.off_until_s > 0.0 and self.keeper.sync() < self.off_until_s

    def stall(self) -> Pending | None:
        """Return what to wait for while the device hangs, None while it works."""
        if self.keeper.sync() >= self.stalled_until_s:
            return None
        return Pending(self._stall_due, lambda: b"")

    def _stall_due(self) -> float | None:
        return self.stalled_until_s if self.keeper.bench.time_s < self.stalled_until_s else None


class Wire(Protocol):
    """What carries the bytes of one client."""

    @property
    def gap_s(self) -> float:
        """Longest real time, s, between two pieces of what a client sent without a pause."""
        ...

    def send(self, data: bytes) -> None:
        """Send to the client."""
        ...

    def pause(self) -> None:
        """Take nothing more from the client for now."""
        ...

    def resume(self) -> None:
        """Go on taking."""
        ...

    def hang_up(self) -> None:
        """End the connection behind what was sent, where the link has such an end."""
        ...


class Conversation:
    """Hands bytes to a session and answers back, one request after the other."""

    def __init__(self, session: Session, wire: Wire, faults: Faults) -> None:
        self._session = session
        self._wire = wire
        self._faults = faults
        self._loop = asyncio.get_running_loop()
        self._waiting: asyncio.Task[None] | None = None
        self._timers: list[asyncio.TimerHandle] = []
        self._backlog = 0
        self._ended = False
        self.gone: asyncio.Future[None] = self._loop.create_future()
        self._set_timers()

    @property
    def is_off(self) -> bool:
        """The device has no power."""
        return self._faults.is_off

    def feed(self, data: bytes) -> None:
        """Feed the session and let it answer, unless it is still busy with an earlier request; no power, no ears."""
        if self.is_off:
            return
        self._session.feed(data)
        if self._waiting is None:
            self._answer()
            return
        if self._faults.stall() is None:
            self._session.overtake()
        self._backlog += len(data)
        if self._backlog > _BACKLOG_BYTES or self._session.deaf:
            self._wire.pause()

    def end(self) -> None:
        """End the conversation and whatever waits in it: the client is gone."""
        if self._ended:
            return
        self._ended = True
        self._cancel_timers()
        self._session.close()
        if self._waiting is None:
            self.gone.set_result(None)
            return
        self._waiting.add_done_callback(lambda _task: self.gone.set_result(None))
        self._waiting.cancel()

    def _answer(self) -> None:
        self._cancel_timers()
        answer: Answer | None = self._faults.stall() or self._session.answer()
        while answer is not None:
            if isinstance(answer, Pending):
                self._waiting = self._loop.create_task(self._finish(answer))
                return
            self._send(answer)
            answer = self._faults.stall() or self._session.answer()
        self._set_timers()

    async def _finish(self, pending: Pending) -> None:
        await self._faults.keeper.wait(pending.due)
        self._waiting = None
        self._send(pending.reply())
        self._backlog = 0
        self._wire.resume()
        self._answer()

    def _send(self, answer: bytes) -> None:
        if not answer or self._ended or self._faults.muted or self.is_off:
            return
        lossy = self._faults.lossy
        if arrives := lossy.passed(answer) if lossy else answer:
            self._wire.send(arrives)
        if self._session.over:
            self._wire.hang_up()

    def _set_timers(self) -> None:
        if self._ended:
            return
        silence_s = self._session.silence_s()
        if silence_s is not None:
            self._timers.append(self._loop.call_later(silence_s + self._wire.gap_s, self._idle))
        due_s = self._session.next_output_s()
        if due_s is not None:
            keeper = self._faults.keeper
            wait_s = max(due_s, self._faults.stalled_until_s) - keeper.bench.time_s
            self._timers.append(self._loop.call_later(max(0.0, wait_s) / keeper.speed, self._output))

    def _cancel_timers(self) -> None:
        for timer in self._timers:
            timer.cancel()
        self._timers.clear()

    def _idle(self) -> None:
        self._session.idle()
        if self._session.over:
            self._wire.hang_up()
            return
        self._answer()

    def _output(self) -> None:
        self._cancel_timers()
        if self._faults.stall() is None:
            self._send(self._session.output())
        self._set_timers()
