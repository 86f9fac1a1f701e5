"""What each request does. Everything that concerns safety acts before this returns."""

import asyncio
from typing import Protocol

from catseye.app.errors import LimitError
from catseye.app.protocol.answers import Answer, Climbed, OverrideLowered, Watching
from catseye.app.protocol.requests import (
    AnyRequest,
    Control,
    Emulate,
    HandOver,
    Hello,
    JogHold,
    JogMode,
    JogStep,
    Override,
    Plain,
    Raw,
    Reply,
    ResetAlarm,
    RestoreOverride,
    Resume,
    Send,
    Start,
    WalkFeed,
    Watch,
)
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.manual_control import ManualControl
from catseye.app.service.member import Member
from catseye.app.service.steering import Steering
from catseye.app.service.watching.telemetry import Telemetry


class Engine(Protocol):
    """An engine that outlives its runs."""

    @property
    def manual(self) -> ManualControl:
        """What is done by hand between runs."""
        ...

    def start(self, request: Start) -> "asyncio.Future[Answer]":
        """Begin a run; the result is there when its record is open."""
        ...

    def resume(self, request: Resume) -> "asyncio.Future[Answer]":
        """Go on with a run; the result is there when its record is open."""
        ...

    def stop(self, reason: str) -> bool:
        """Stop the arm that is moved by hand, keep a run from beginning; return whether there was either."""
        ...

    def abort(self, reason: str) -> bool:
        """The same; what was moved by hand has to be cleared before anything begins."""
        ...

    def clear(self, who: str) -> None:
        """Leave ABORTED."""
        ...

    def emulate(self, request: Emulate) -> "asyncio.Future[Answer]":
        """Start the emulated bench; the result is there when it answers."""
        ...

    def reset_alarm(self, request: ResetAlarm, who: str) -> "asyncio.Future[Answer]":
        """Reset the controller's alarm that was read; the result is there when it is gone."""
        ...

    def shut_down(self, who: str) -> None:
        """End the process."""
        ...


class RequestHandler:
    """Carries requests out.

    Args:
        engine: that can start runs; None where a run serves itself.
        telemetry: of the bench; None where nobody can watch it.
    """

    def __init__(
        self, registry: ClientRegistry, engine: Engine | None = None, telemetry: Telemetry | None = None
    ) -> None:
        self._registry = registry
        self._engine = engine
        self._telemetry = telemetry
        self._steering = Steering(registry, engine)

    def take(self, member: Member | None, request: AnyRequest) -> "Answer | asyncio.Future[Answer]":
        """Do what is asked and return what the answer carries, at once or later.

        Args:
            member: who asks; None before it introduced itself.

        Raises:
            RefusedError: it is not done; the text says why.
        """
        if isinstance(request, Plain):
            return self._plain(member, request)
        if member is None or isinstance(request, Hello):
            raise RefusedError("a client says hello first, and once")
        match request:
            case Control(take=True):
                self._registry.lease.take(member, force=request.force)
            case Control():
                self._registry.lease.release(member)
            case HandOver():
                self._registry.lease.require(member)
                self._registry.lease.hand_over(self._registry.member(request.to))
            case Reply():
                self._registry.lease.require(member)
                self._registry.broker.answer(request.prompt, request.text, member.text)
            case Override():
                return self._override(member, request.percent)
            case Start():
                self._registry.lease.require(member)
                return self._engine_or_refuse().start(request)
            case Resume():
                self._registry.lease.require(member)
                return self._engine_or_refuse().resume(request)
            case Emulate():
                self._registry.lease.require(member)
                return self._engine_or_refuse().emulate(request)
            case ResetAlarm():
                self._registry.lease.require(member)
                return self._engine_or_refuse().reset_alarm(request, member.text)
            case JogMode() | JogStep() | JogHold() | RestoreOverride() | Raw() | Send():
                self._registry.lease.require(member)
                return self._manual(member, request)
            case WalkFeed():
                self._registry.lease.require(member)
                self._feed(on=request.on)
            case Watch() if self._telemetry is not None:
                return self._watch(member, request, self._telemetry)
            case _:
                raise RefusedError(f"this engine does not do {request.op!r}")
        return Answer()

    def _manual(
        self, member: Member, request: JogMode | JogStep | JogHold | RestoreOverride | Raw | Send
    ) -> "Answer | asyncio.Future[Answer]":
        manual = self._engine_or_refuse().manual
        match request:
            case JogMode():
                return manual.jog(member, request)
            case JogStep():
                return manual.step(member, request)
            case JogHold():
                return manual.hold(request)
            case RestoreOverride():
                return manual.restore_override(request, member.text)
            case Raw():
                return manual.raw(member, request)
            case Send():
                return manual.send(request)

    def _plain(self, member: Member | None, request: Plain) -> Answer:
        who = member.text if member else "a client without a name"
        match request.op:
            case "stop":
                self._steering.stop(who)
            case "abort":
                self._steering.abort(who)
            case "ladder":
                return Climbed(rung=self._steering.climb(who))
            case "hold":
                self._steering.hold(who)
            case "unhold":
                self._registry.lease.require(member)
                self._steering.unhold(who)
            case "release" if member is not None:
                self._registry.lease.release(member)
            case "clear":
                self._registry.lease.require(member)
                self._engine_or_refuse().clear(who)
            case "shutdown":
                self._shut_down(member, who)
        return Answer()

    def _watch(self, member: Member, request: Watch, telemetry: Telemetry) -> Answer:
        if request.on:
            telemetry.prepare()
        self._registry.listen(member, request.op, on=request.on)
        if request.on:
            telemetry.wake()
        return Watching(bench=telemetry.bench()) if request.op == "watch" else Answer()

    def _feed(self, *, on: bool) -> None:
        feed = self._steering.running().feed
        if feed is None:
            raise RefusedError("the run under way is not a walk: nothing keeps it going but itself")
        feed(on)

    def _override(self, member: Member, percent: float) -> Answer:
        self._registry.lease.require(member)
        try:
            now = self._steering.running().lower_override(percent)
        except LimitError as error:
            raise RefusedError(str(error), error.exit_code) from error
        return OverrideLowered(percent=percent, until_the_next_motion=now)

    def _shut_down(self, member: Member | None, who: str) -> None:
        if member is None:
            raise RefusedError("a client says hello first")
        self._registry.lease.require(member)
        self._engine_or_refuse().shut_down(who)

    def _engine_or_refuse(self) -> Engine:
        if self._engine is None:
            raise RefusedError("this process serves one run and ends with it: use catseye engine for more")
        return self._engine
