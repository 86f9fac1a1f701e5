"""What clients do by hand between runs: who may, one thing at a time, and what ends it."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

from catseye.app.protocol.answers import Answer
from catseye.app.protocol.requests import JogHold, JogMode, JogStep, Raw, ResetAlarm, RestoreOverride, Send
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.alarm import reset_alarm
from catseye.app.service.manual.device_loan import ManualBench
from catseye.app.service.manual.jogging import Jogging
from catseye.app.service.manual.left_override import LeftOverrides, lowered
from catseye.app.service.manual.raw_link import RawLink
from catseye.app.service.member import Member
from catseye.app.service.walk.walk import WalkedOverride


class ManualControl:
    """Carries out `jog`, `jog-step`, `jog-hold`, `reset-alarm`, `restore-override`, `raw` and `send`.

    Args:
        require_idle: raises RefusedError during a run, and after an abort that nobody has cleared.
        on_abort: takes why nothing may move before an operator has cleared it.

    Attributes:
        begun: how many jogs and links have begun so far.
    """

    def __init__(
        self,
        registry: ClientRegistry,
        bench: ManualBench,
        require_idle: Callable[[], None],
        on_abort: Callable[[str], None],
    ) -> None:
        self.begun = 0
        self._registry = registry
        self._bench = bench
        self._require_idle = require_idle
        self._on_abort = on_abort
        self._jog: Jogging | None = None
        self._overrides = LeftOverrides(bench)
        self._raw: dict[str, RawLink] = {}
        self._holder: Member | None = None
        self._tasks: set[asyncio.Task[Answer]] = set()
        registry.on_control = self._control_changed

    @property
    def occupied(self) -> str | None:
        """What is done by hand and how it is ended; None when nothing is."""
        if self._jog is not None:
            return f"{self._jog.client.text} moves the arm by hand: end that first (jog, on: false)"
        if self._raw:
            return f"the link of {', '.join(self._raw)} is open for raw bytes: give it back first (raw, on: false)"
        return None

    def jog(self, member: Member, request: JogMode) -> "asyncio.Future[Answer]":
        """Begin or end a jog; the result is there when the arm may be moved, or stands."""
        if not request.on:
            return self._later(self._end_jog(f"{member.text} ended it"))
        self._begin(member)
        self._jog = jog = Jogging(self._bench, request, member.client)
        jog.add_done_callback(self._jog_over)
        return jog.begun

    def step(self, member: Member, request: JogStep) -> "asyncio.Future[Answer]":
        """Move one joint by a step."""
        return self._jogging().step(request, lambda: member.heard_s)

    def hold(self, request: JogHold) -> "Answer | asyncio.Future[Answer]":
        """Keep one joint moving, or stop it."""
        if self._jog is None and request.direction == 0:
            # Whoever lets a key go late has nothing to stop any more.
            return Answer()
        return self._jogging().hold(request)

    def reset_alarm(self, request: ResetAlarm, who: str) -> "asyncio.Future[Answer]":
        """Reset the controller's alarm that was read.

        Raises:
            RefusedError: something is done by hand.
        """
        self._require_free()
        return self._later(reset_alarm(self._bench, request, who))

    def restore_override(self, request: RestoreOverride, who: str) -> "asyncio.Future[Answer]":
        """Set the speed override again that stood before a jog.

        Raises:
            RefusedError: a run is under way, something was aborted, or something is done by hand.
        """
        self._require_idle()
        self._require_free()
        return self._later(self._overrides.restore(request, who))

    def raw(self, member: Member, request: Raw) -> "asyncio.Future[Answer]":
        """Take a device's link from its driver, or give it back."""
        if not request.on:
            return self._later(self._give_back(request.device))
        self._begin(member, request.device)
        self._raw[request.device] = link = RawLink(self._bench, request, member.client)
        link.add_done_callback(self._raw_over)
        return link.begun

    def send(self, request: Send) -> "asyncio.Future[Answer]":
        """Send bytes on a link that was taken."""
        if request.device not in self._raw:
            raise RefusedError(f"the link of {request.device} was not taken: take it first (raw)")
        return self._later(self._raw[request.device].send(bytes.fromhex(request.hex)))

    def take_walked(self, override: WalkedOverride, cap_percent: float) -> None:
        """Take what a walk has left of the speed override, which goes back as after a jog.

        Args:
            cap_percent: that the cell allows.
        """
        before, left, asked = override.before_percent, override.left_percent, override.asked_percent
        self._overrides.take(lowered(before, left, cap_percent, asked))

    def stop(self, reason: str) -> bool:
        """Stop an arm that is moved by hand, or by raw bytes; return whether there is such a one."""
        if self._jog is not None:
            self._jog.end(reason)
            return True
        stopped = [link.stop(reason) for link in self._raw.values()]
        return any(stopped)

    def abort(self, reason: str) -> bool:
        """Stop an arm that is moved by hand and let nothing move until it is cleared; return whether there is one."""
        if self._jog is not None:
            self._jog.abort(reason)
            return True
        return self.stop(reason)

    async def end(self, reason: str) -> None:
        """End everything that is done by hand; the arm stands when this returns."""
        links = list(self._raw.values())
        for link in links:
            link.end(reason)
        await self._end_jog(reason)
        for link in links:
            await link.over()

    def _require_free(self) -> None:
        """Raise RefusedError while something is done by hand."""
        if (occupied := self.occupied) is not None:
            raise RefusedError(occupied)

    def _begin(self, member: Member, device: str | None = None) -> None:
        """Check that something may begin, and count it.

        Raises:
            RefusedError: something else is under way.
        """
        self._require_idle()
        # Several links may be open at once, each of them once; an arm is moved while none is.
        alone = self._jog is not None or device is None or device in self._raw
        if alone:
            self._require_free()
        self._holder = member
        self.begun += 1

    def _jogging(self) -> Jogging:
        if self._jog is None:
            raise RefusedError("the arm is not moved by hand: begin that first (jog, on: true)")
        return self._jog

    async def _end_jog(self, reason: str) -> Answer:
        jog = self._jog
        if jog is not None:
            jog.end(reason)
            await jog.over()
        return Answer()

    async def _give_back(self, device: str) -> Answer:
        link = self._raw.get(device)
        if link is not None:
            link.give_back()
            await link.over()
        return Answer()

    def _jog_over(self, jog: Jogging) -> None:
        self._jog = None
        self._overrides.take(jog.left_override)
        if jog.aborted:
            self._on_abort(jog.aborted)

    def _raw_over(self, link: RawLink) -> None:
        del self._raw[link.device]
        if link.aborted:
            self._on_abort(link.aborted)

    def _control_changed(self) -> None:
        """End what a client does by hand when it does not hold control any more."""
        holder = self._holder
        if holder is None or self._registry.lease.held_by(holder):
            return
        self._holder = None
        reason = f"{holder.text} no longer holds control"
        if self._jog is not None:
            self._jog.end(reason)
        for link in self._raw.values():
            link.end(reason)

    def _later(self, work: Coroutine[Any, Any, Answer]) -> "asyncio.Task[Answer]":
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task
