"""What each request does. Everything that concerns safety acts before this returns."""

import asyncio
from typing import Protocol

from catseye.app.engine.handle import RunHandle
from catseye.app.engine.states import RUNNING, State
from catseye.app.errors import InterruptedRunError, LimitError
from catseye.app.service.errors import RefusedError
from catseye.app.service.hub import Hub, Member
from catseye.app.service.manual.manual_control import ByHand
from catseye.app.service.messages import (
    AnyRequest,
    Control,
    HandOver,
    Hello,
    JogHold,
    JogMode,
    JogStep,
    Message,
    Override,
    Plain,
    Raw,
    Reply,
    Resume,
    Send,
    Start,
    WalkFeed,
    Watch,
)
from catseye.app.service.watching.telemetry import Telemetry

_HOLDS = frozenset({State.HOLDING, State.HELD})
_BEFORE_MOTION = frozenset({State.IDLE, State.STARTING})
_OPEN = RUNNING | {State.IDLE}
"""An aborted run that goes on is IDLE until its operator has cleared it; it can be stopped then as ever."""


class Engine(Protocol):
    """An engine that outlives its runs."""

    @property
    def by_hand(self) -> ByHand:
        """What is done by hand between runs."""
        ...

    def start(self, request: Start) -> "asyncio.Future[Message]":
        """Begin a run; the result is there when its record is open."""
        ...

    def resume(self, request: Resume) -> "asyncio.Future[Message]":
        """Go on with a run; the result is there when its record is open."""
        ...

    def drop(self, reason: str) -> bool:
        """Keep a run that was asked for from beginning; return whether there was one."""
        ...

    def clear(self, who: str) -> None:
        """Leave ABORTED."""
        ...

    def shut_down(self, who: str) -> None:
        """End the process."""
        ...


class Orders:
    """Carries requests out.

    Args:
        hub: of the engine.
        engine: that can start runs; None where a run serves itself.
        telemetry: of the bench; None where nobody can watch it.
    """

    def __init__(self, hub: Hub, engine: Engine | None = None, telemetry: Telemetry | None = None) -> None:
        self._hub = hub
        self._engine = engine
        self._telemetry = telemetry

    def take(self, member: Member | None, request: AnyRequest) -> "Message | asyncio.Future[Message]":
        """Do what is asked and return what the answer carries, at once or later.

        Args:
            member: who asks; None before it introduced itself.
            request: what is asked.

        Raises:
            RefusedError: it is not done; the text says why.
        """
        if isinstance(request, Plain):
            return self._plain(member, request)
        if member is None or isinstance(request, Hello):
            raise RefusedError("a client says hello first, and once")
        match request:
            case Control(take=True):
                self._hub.take_control(member, force=request.force)
            case Control():
                self._hub.release(member)
            case HandOver():
                self._hub.hand_over(member, request.to)
            case Reply():
                self._hub.require_control(member)
                self._hub.desk.answer(request.prompt, request.text, member.text)
            case Override():
                return self._override(member, request.percent)
            case Start():
                self._hub.require_control(member)
                return self._engine_or_refuse().start(request)
            case Resume():
                self._hub.require_control(member)
                return self._engine_or_refuse().resume(request)
            case JogMode() | JogStep() | JogHold() | Raw() | Send():
                self._hub.require_control(member)
                return self._by_hand(member, request)
            case WalkFeed():
                self._hub.require_control(member)
                self._feed(on=request.on)
            case Watch() if self._telemetry is not None:
                return self._watch(member, request, self._telemetry)
            case _:
                raise RefusedError(f"this engine does not do {request.op!r}")
        return {}

    def _by_hand(
        self, member: Member, request: JogMode | JogStep | JogHold | Raw | Send
    ) -> "Message | asyncio.Future[Message]":
        by_hand = self._engine_or_refuse().by_hand
        match request:
            case JogMode():
                return by_hand.jog(member, request)
            case JogStep():
                return by_hand.step(member, request)
            case JogHold():
                return by_hand.hold(request)
            case Raw():
                return by_hand.raw(member, request)
            case Send():
                return by_hand.send(request)

    def _plain(self, member: Member | None, request: Plain) -> Message:
        who = member.text if member else "a client without a name"
        match request.op:
            case "hold":
                self._hold(who)
            case "stop":
                self._stop(who)
            case "abort":
                self._abort(who)
            case "unhold":
                self._unhold(member, who)
            case "release" if member is not None:
                self._hub.release(member)
            case "clear":
                self._hub.require_control(member)
                self._engine_or_refuse().clear(who)
            case "shutdown":
                self._shut_down(member, who)
        return {}

    def _watch(self, member: Member, request: Watch, telemetry: Telemetry) -> Message:
        if request.on:
            telemetry.prepare()
        self._hub.listen(member, request.op, on=request.on)
        if request.on:
            telemetry.wake()
        return {"bench": telemetry.bench()} if request.op == "watch" else {}

    def _feed(self, *, on: bool) -> None:
        feed = self._running().feed
        if feed is None:
            raise RefusedError("the run under way is no walk: nothing keeps it going but itself")
        feed(on)

    def _stop(self, who: str) -> None:
        # A run is stopped whatever state the rest is in; nothing is done by hand during one.
        engine, reason = self._engine, f"{who} stopped it"
        if self._hub.run is not None or engine is None:
            self._running().control.stop(f"{who} stopped the run")
        elif not (engine.by_hand.stop(reason) or engine.drop(reason)):
            raise RefusedError("no run is under way")

    def _abort(self, who: str) -> None:
        engine, reason = self._engine, f"{who} aborted it"
        if self._hub.run is not None or engine is None:
            self._running().control.abort(InterruptedRunError(f"{who} aborted the run"))
        elif not (engine.by_hand.abort(reason) or engine.drop(reason)):
            raise RefusedError("no run is under way")

    def _hold(self, who: str) -> None:
        control = self._running().control
        if control.state in _HOLDS:
            return
        if control.state in _BEFORE_MOTION:
            raise RefusedError(
                "the devices are being connected and nothing moves: hold when it runs, or stop"
            )
        control.hold(f"{who} holds the run")

    def _unhold(self, member: Member | None, who: str) -> None:
        self._hub.require_control(member)
        control = self._running().control
        if control.state not in _HOLDS:
            raise RefusedError(f"the run is not held, it is in state {control.state}")
        control.unhold(f"{who} lets the run go on")

    def _override(self, member: Member, percent: float) -> Message:
        self._hub.require_control(member)
        try:
            now = self._running().lower_override(percent)
        except LimitError as error:
            raise RefusedError(str(error), error.exit_code) from error
        return {"percent": percent, "until_the_next_motion": now}

    def _shut_down(self, member: Member | None, who: str) -> None:
        if member is None:
            raise RefusedError("a client says hello first")
        self._hub.require_control(member)
        self._engine_or_refuse().shut_down(who)

    def _running(self) -> RunHandle:
        run = self._hub.run
        if run is None:
            raise RefusedError("no run is under way")
        if run.control.ending is not None or run.control.state not in _OPEN:
            # A stop may become an abort while it is under way.
            if run.control.state in {State.STOPPING, State.ABORTING}:
                return run
            raise RefusedError(f"the run has ended: it is in state {run.control.state}")
        return run

    def _engine_or_refuse(self) -> Engine:
        if self._engine is None:
            raise RefusedError("this process serves one run and ends with it: use catseye engine for more")
        return self._engine
