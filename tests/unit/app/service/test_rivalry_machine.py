"""Whatever rival clients ask in whatever order: one holder at most, nobody steers without control, anybody stops."""

import asyncio
from collections.abc import Callable, Coroutine
from contextlib import AsyncExitStack
from functools import partial
from typing import Any

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from catseye.app.protocol.requests import HandOver, Plain
from catseye.app.service.client import EngineClient
from catseye.app.service.errors import RefusedError
from tests.unit.app.service.benches import ServiceBench, settled

SEATS = ("Ada", "Ben", "Cem")
SEAT = st.sampled_from(range(len(SEATS)))
HELD = ("HOLDING", "HELD")


class RivalryMachine(RuleBasedStateMachine):
    """Three seats before one run; whoever has left a seat comes again."""

    def __init__(self) -> None:
        super().__init__()
        self.runner = asyncio.Runner()
        self.bench = ServiceBench()
        self.run = AsyncExitStack()
        self.here: dict[int, tuple[AsyncExitStack, EngineClient]] = {}
        self.holder: int | None = None
        self.held = self.stopped = False
        self.changes = 0
        self.runner.run(self._begin())

    async def _begin(self) -> None:
        await self.run.enter_async_context(self.bench.running())

    def teardown(self) -> None:
        """Send everybody home and end the run."""
        for seat in list(self.here):
            self.runner.run(self.here.pop(seat)[0].aclose())
        self.runner.run(self.run.aclose())
        self.runner.close()

    def asked(self, work: Callable[[], Coroutine[Any, Any, object]]) -> bool:
        """Return whether a request is granted."""

        async def both() -> bool:
            try:
                await work()
            except RefusedError:
                return False
            finally:
                await settled()
            return True

        return self.runner.run(both())

    def client(self, seat: int) -> EngineClient:
        """Return who sits there; a seat that somebody has left is taken again."""
        if seat not in self.here:
            self.runner.run(self._sit_down(seat))
        return self.here[seat][1]

    async def _sit_down(self, seat: int) -> None:
        stack = AsyncExitStack()
        self.here[seat] = stack, await stack.enter_async_context(self.bench.client(SEATS[seat]))

    @rule(seat=SEAT)
    def vanish(self, seat: int) -> None:
        """Somebody's connection ends; a run whose holder is gone is held."""
        self.client(seat)
        assert self.asked(self.here.pop(seat)[0].aclose)
        if seat == self.holder:
            self.holder, self.changes = None, self.changes + 1
            self.held |= not self.stopped

    @rule(seat=SEAT, force=st.booleans())
    def take(self, seat: int, force: bool) -> None:
        """Somebody takes control, which only force takes from another."""
        granted = self.asked(partial(self.client(seat).take_control, force=force))
        assert granted == (force or self.holder in (None, seat))
        self._now_holds(seat if granted else self.holder)

    @rule(seat=SEAT)
    def release(self, seat: int) -> None:
        """Somebody gives control up; the run goes on as it is."""
        granted = self.asked(self.client(seat).release)
        assert granted == (seat == self.holder)
        self._now_holds(None if granted else self.holder)

    @rule(seat=SEAT, to=SEAT)
    def hand_over(self, seat: int, to: int) -> None:
        """Somebody hands control to another, whom nobody asks."""
        granted = self.asked(partial(self.client(seat).request, HandOver(to=self.client(to).name)))
        assert granted == (seat == self.holder)
        self._now_holds(to if granted else self.holder)

    @rule(seat=SEAT)
    def hold(self, seat: int) -> None:
        """Anybody may hold a run that has not ended."""
        assert self.asked(partial(self.client(seat).request, Plain(op="hold"))) != self.stopped
        self.held |= not self.stopped

    @rule(seat=SEAT)
    def go_on(self, seat: int) -> None:
        """Only the holder of control can resume a held run."""
        granted = self.asked(partial(self.client(seat).request, Plain(op="unhold")))
        assert granted == (seat == self.holder and self.held and not self.stopped)
        self.held &= not granted

    @rule(seat=SEAT)
    def stop(self, seat: int) -> None:
        """Anybody may stop it, once and for all."""
        assert self.asked(partial(self.client(seat).request, Plain(op="stop"))) != self.stopped
        self.stopped = True

    @invariant()
    def who_holds_is_who_took(self) -> None:
        """The engine says of control what the clients were told."""
        control = self.bench.registry.snapshot().control
        assert (control and control.who) == (None if self.holder is None else SEATS[self.holder])

    @invariant()
    def each_change_is_noted_once(self) -> None:
        """Nobody takes control without a word in the record."""
        assert len(self.bench.noted("control")) == self.changes

    @invariant()
    def nothing_runs_that_was_held_or_stopped(self) -> None:
        """The run stands as the last one who was entitled left it."""
        state = self.bench.state()
        if self.stopped:
            assert state == "STOPPED"
            assert self.bench.robot.calls == ["stop"]
        else:
            assert (state in HELD) == self.held

    def _now_holds(self, seat: int | None) -> None:
        self.changes += seat != self.holder
        self.holder = seat


RivalryMachine.TestCase.settings = settings(max_examples=25, stateful_step_count=20)
TestRivalry = RivalryMachine.TestCase
