"""The clients of one engine: what they are told, who of them holds control, and what a lost one means."""

import asyncio
import logging
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final, Literal

from catseye.app.engine.announcer import Publish
from catseye.app.engine.handle import RunHandle
from catseye.app.engine.states import ENDED, State
from catseye.app.service.errors import RefusedError
from catseye.app.service.mailbox import Mailbox, MailboxFullError
from catseye.app.service.messages import VERSION, Message
from catseye.app.service.prompt_desk import PromptDesk
from catseye.app.service.questions import prompt_of
from catseye.app.service.watching.telemetry import Topic
from catseye.app.store.software import SOFTWARE
from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.context import Json

_log = logging.getLogger(__name__)

MOST_CLIENTS: Final = 32
"""That have said hello, at a time."""

Policy = Literal["continue", "hold", "stop"]
"""What becomes of a run whose client with control is lost; `[engine] on_client_lost`."""

_GO_ON = "attach with --control and let it go on, or stop it"
_HELD = frozenset({State.HOLDING, State.HELD})
_BEFORE_MOTION = frozenset({State.IDLE, State.STARTING})


@dataclass(eq=False)
class Member:
    """A client that has introduced itself.

    Attributes:
        name: unique within this engine.
        who: the person.
        mailbox: what waits to be sent to it.
        disconnect: ends the connection; takes the reason.
        heard_s: when its last line came, on the engine's clock.
        topics: what it wants to be told about beside the events of runs.
    """

    name: str
    who: str
    mailbox: Mailbox
    disconnect: Callable[[str], None]
    heard_s: float = 0.0
    topics: set[Topic] = field(default_factory=set)

    @property
    def text(self) -> str:
        """The client as people and records read it."""
        return f"{self.who} ({self.name})"


def send(message: Message, mailbox: Mailbox, disconnect: Callable[[str], None]) -> None:
    """Put a message into a client's mailbox; one that does not read what it has to know is disconnected."""
    try:
        mailbox.put(message)
    except MailboxFullError as error:
        disconnect(f"it does not read what it is sent: {error}")


@dataclass
class Seen:
    """The last announcements of a run, for clients that come later."""

    run: Message = field(default_factory=dict)
    state: Message = field(default_factory=dict)
    step: Message | None = None
    prompt: Message | None = None
    progress: Message | None = None
    live: Message | None = None

    def take(self, event: Message) -> None:
        """Remember an event."""
        match event["event"]:
            case "run-started":
                self.run = event
            case "state" if event.get("kind") == "live":
                self.live = event
            case "state" if "kind" not in event:
                self.state = event
            case "step-started":
                self.step = event
            case "step-done":
                self.step = None
            case "prompt":
                self.prompt = event
            case "answer" | "run-ended":
                self.prompt = self.live = None
            case "progress":
                self.progress = event


class Hub:
    """Knows the clients and the run under way.

    Args:
        clock: real time.
        waits: questions wait for a client, however long it takes to come.

    Attributes:
        policy: what becomes of a run whose client with control is lost.
        console: the person at the terminal of this process; None without one.
        desk: questions lie open here.
        run: under way; None between runs.
        idle_state: where the engine stands between runs.
        beginning: a run was asked for and is not open yet.
        facts: more for the snapshot.
        on_control: is called at once when another client, or none, holds control.
    """

    def __init__(self, clock: Clock, *, waits: bool = False) -> None:
        self.policy: Policy = "hold"
        self.console: str | None = None
        self.desk = PromptDesk(lambda: waits or self.console is not None or self._holder is not None)
        self.run: RunHandle | None = None
        self.idle_state = State.IDLE
        self.beginning = False
        self.facts: dict[str, Json] = {}
        self.on_control: Callable[[], None] = lambda: None
        self._clock = clock
        self._members: dict[str, Member] = {}
        self._holder: Member | None = None
        self._asked_s = 0.0
        self._count = 0
        self._seen = Seen()
        self._hold_when_running: str | None = None
        self._lost_early: tuple[Member, str] | None = None

    @property
    def members(self) -> list[Member]:
        """The clients, in the order in which they came."""
        return list(self._members.values())

    @property
    def controlled(self) -> bool:
        """A client holds control."""
        return self._holder is not None

    @property
    def asking(self) -> bool:
        """A question is open."""
        return self.desk.open is not None

    def listen(self, member: Member, topic: Topic, *, on: bool) -> None:
        """Tell a client about a topic from now on, or no more."""
        if on:
            member.topics.add(topic)
        else:
            member.topics.discard(topic)

    def listens(self, topic: Topic) -> bool:
        """Return whether any client wants to be told about a topic."""
        return any(topic in member.topics for member in self._members.values())

    def holds(self, member: Member | None) -> bool:
        """Return whether a client holds control."""
        return member is not None and member is self._holder

    def join(self, client: str, who: str, mailbox: Mailbox, disconnect: Callable[[str], None]) -> Member:
        """Add a client; it gets every event from now on.

        Raises:
            RefusedError: there are as many as are served.
        """
        if len(self._members) >= MOST_CLIENTS:
            raise RefusedError(
                f"{MOST_CLIENTS} clients are connected, and no more are served: end one of them and repeat"
            )
        self._count += 1
        member = Member(f"{client}-{self._count}", who, mailbox, disconnect)
        self._members[member.name] = member
        self._tell(self._about("clients", {"clients": self._clients()}), but=member)
        return member

    def leave(self, member: Member, reason: str | None) -> None:
        """Remove a client; one that held control of a run has been lost.

        Args:
            member: that is gone.
            reason: how it went; None when the engine ended the conversation.
        """
        self._members.pop(member.name, None)
        if self._holder is member:
            self._holder_left(member, reason)
        self.say("clients", clients=self._clients())

    def _holder_left(self, member: Member, reason: str | None) -> None:
        self._holder = None
        if reason is not None and self.run is not None and self.run.control.state not in ENDED:
            self._lost(self.run, member, reason)
            return
        if reason is not None and self.run is None and self.beginning:
            # What it asked for is still being planned: nobody may be there when it begins to move.
            self._lost_early = (member, reason)
        self._control_changed("left", None, member.text)

    def take_control(self, member: Member, *, force: bool) -> None:
        """Give a client control.

        Raises:
            RefusedError: somebody else has it and force was not used.
        """
        if self._holder is member:
            return
        present = self._holder.text if self._holder else self.console and f"{self.console} (console)"
        if present and not force:
            raise RefusedError(
                f"{present} holds control: ask for it to be handed over, or take it with force"
            )
        self._holder = member
        self._hold_when_running = self._lost_early = None
        self._control_changed("taken by force" if present else "taken", member.text, present)

    def release(self, member: Member) -> None:
        """Take control back from a client that gives it up.

        Raises:
            RefusedError: it does not hold control.
        """
        self.require_control(member)
        self._holder = None
        self._control_changed("released", None, member.text)

    def hand_over(self, member: Member, to: str) -> None:
        """Give control from one client to another.

        Raises:
            RefusedError: the one does not hold it, or the other is not there.
        """
        self.require_control(member)
        if to not in self._members:
            raise RefusedError(f"there is no client {to!r}; there are {', '.join(self._members)}")
        self._holder = self._members[to]
        self._control_changed("handed over", self._holder.text, member.text)

    def require_control(self, member: Member | None) -> None:
        """Check that a client may steer the run.

        Raises:
            RefusedError: it does not hold control.
        """
        if not self.holds(member):
            now = (
                self._holder.text
                if self._holder
                else (self.console and f"{self.console} (console)") or "nobody"
            )
            raise RefusedError(f"this needs control, which {now} holds: take control first")

    def publisher(self, also: Publish | None = None) -> Publish:
        """Return what takes the events of a run: clients first, then somebody who may be gone."""

        def publish(event: Message) -> None:
            self.publish(event)
            if also is not None:
                also(event)

        return publish

    def publish(self, event: Message) -> None:
        """Take an event of the run, remember it and tell every client."""
        self._seen.take(event)
        if event["event"] == "prompt":
            self._asked_s = self._clock.monotonic_s()
            self.desk.announce(prompt_of(event))
        elif event["event"] in {"answer", "run-ended"}:
            self.desk.withdraw()
        elif event["event"] == "state" and event.get("state") == State.EXECUTE:
            self._hold_if_lost()
        self._tell(event)

    def tell(self, topic: Topic, event: str, fields: dict[str, Json]) -> None:
        """Tell every client that wants to be told about a topic."""
        message = self._about(event, fields)
        for member in self.members:
            if topic in member.topics:
                send(message, member.mailbox, member.disconnect)

    def say(self, event: str, **fields: Json) -> None:
        """Tell every client something that is no event of the run's procedure."""
        self._tell(self._about(event, fields))

    @contextmanager
    def running(self, handle: RunHandle) -> Iterator[None]:
        """Serve a run while its record is open."""
        self.run, self._seen = handle, Seen()
        self._hold_when_running = None
        self.beginning = False
        lost, self._lost_early = self._lost_early, None
        if self._holder is not None:
            handle.note("control", {"what": "held from the start", "by": self._holder.text})
        elif lost is not None:
            self._lost(handle, *lost)
        try:
            yield
        finally:
            self.desk.withdraw()
            self.run = None

    def snapshot(self, member: Member | None = None) -> dict[str, Json]:
        """Return everything that a client has to know when it comes."""
        run, seen = self.run, self._seen
        state = run.control.state if run else self.idle_state
        holder: Json = None
        if self._holder is not None:
            holder = {"client": self._holder.name, "who": self._holder.who}
        elif self.console is not None:
            holder = {"client": "console", "who": self.console}
        return {
            "engine": SOFTWARE,
            "protocol": VERSION,
            "pid": os.getpid(),
            "you": member.name if member else None,
            "clients": self._clients(),
            "control": holder,
            "on_client_lost": self.policy,
            "run": run.path.name if run else None,
            "path": str(run.path.resolve()) if run else None,
            "procedure": run.procedure if run else None,
            "title": run.title if run else None,
            "simulated": run.simulated if run else None,
            "state": state,
            "reason": seen.state.get("reason") if run else None,
            "step": seen.step if run else None,
            "prompt": seen.prompt if run else None,
            "prompt_open_s": self._clock.monotonic_s() - self._asked_s if run and seen.prompt else None,
            "progress": seen.progress if run else None,
            "live": seen.live if run else None,
            **self.facts,
        }

    def _about(self, event: str, fields: dict[str, Json]) -> Message:
        run = self.run.path.name if self.run else None
        return {"v": VERSION, "t": self._clock.now_utc().isoformat(), "event": event, "run": run, **fields}

    def _clients(self) -> list[Json]:
        return [{"client": each.name, "who": each.who} for each in self._members.values()]

    def _tell(self, event: Message, but: Member | None = None) -> None:
        message: Message = {"v": VERSION, **event}
        for member in self.members:
            if member is not but:
                send(message, member.mailbox, member.disconnect)

    def _control_changed(self, what: str, by: str | None, before: str | None) -> None:
        try:
            self.on_control()
        except Exception:  # noqa: BLE001  # a run has to hear of it too, and everybody who watches
            _log.exception("what is done by hand could not be ended")
        data: dict[str, Json] = {"what": what, "by": by, "before": before}
        if self.run is not None:
            self.run.note("control", data)
        self.say("control", **data)

    def _lost(self, run: RunHandle, member: Member, reason: str) -> None:
        data: dict[str, Json] = {
            "client": member.name,
            "who": member.who,
            "reason": reason,
            "policy": self.policy,
        }
        try:
            self.say("client-lost", **data)
            self._control_changed("lost", None, member.text)
            run.note("client-lost", data)
        finally:
            # What fails on the way to those who are told must not let the run go on alone.
            self._follow_policy(run, member, reason)

    def _follow_policy(self, run: RunHandle, member: Member, reason: str) -> None:
        control = run.control
        if control.ending is not None:
            return
        text = f"{member.text}, who held control, is lost ({reason})"
        match self.policy:
            case "continue":
                run.warn(f"{text}; the run goes on, as [engine] on_client_lost says")
            case "hold" if control.state in _BEFORE_MOTION:
                self._hold_when_running = text
            case "hold" if control.state not in _HELD:
                control.hold(f"{text}; {_GO_ON}")
            case "stop":
                control.stop(text)

    def _hold_if_lost(self) -> None:
        """Hold a run that begins to move after its client was lost."""
        text, run = self._hold_when_running, self.run
        if text is None or run is None:
            return
        self._hold_when_running = None
        # This is called from within the change of state; the hold comes before any task that this change allows.
        asyncio.get_running_loop().call_soon(run.control.hold, f"{text}; {_GO_ON}")
