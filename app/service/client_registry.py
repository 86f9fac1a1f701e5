"""The clients of one engine: what they are sent, who of them holds control, and what a lost one means."""

import logging
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

from catseye.app.engine.announcer import Publish
from catseye.app.engine.handle import RunHandle
from catseye.app.protocol.engine_events import (
    Client,
    ClientLost,
    ClientsChanged,
    ControlChanged,
    DrivesFields,
    JogFields,
    LeaseChange,
    LeftOverride,
)
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.loss import LossPolicy, after_loss
from catseye.app.protocol.message import VERSION
from catseye.app.protocol.run_events import (
    LiveShown,
    Progressed,
    PromptAnswered,
    PromptAsked,
    RunEnded,
    RunEvent,
    StateFields,
    StepDone,
    StepStarted,
)
from catseye.app.protocol.snapshot import Snapshot
from catseye.app.protocol.state import ENDED, ControlState
from catseye.app.service.control_lease import ControlLease
from catseye.app.service.errors import RefusedError
from catseye.app.service.mailbox import Mailbox
from catseye.app.service.member import Member, send
from catseye.app.service.prompt_broker import PromptBroker
from catseye.app.service.watching.telemetry import Topic
from catseye.app.store.software import SOFTWARE
from catseye.drivers.roles.clock import Clock

_log = logging.getLogger(__name__)

MOST_CLIENTS: Final = 32
"""That have said hello, at a time."""

_GO_ON = "attach with --control and let it go on, or stop it"


@dataclass
class LatestEvents:
    """What a snapshot says of the run under way."""

    state: StateFields | None = None
    step: StepStarted | None = None
    prompt: PromptAsked | None = None
    progress: Progressed | None = None
    live: LiveShown | None = None

    def take(self, event: RunEvent) -> None:
        """Remember an event."""
        match event:
            case LiveShown():
                self.live = event
            case StateFields():
                self.state = event
            case StepStarted():
                self.step = event
            case StepDone():
                self.step = None
            case PromptAsked():
                self.prompt = event
            case PromptAnswered() | RunEnded():
                self.prompt = self.live = None
            case Progressed():
                self.progress = event


@dataclass(frozen=True)
class EngineFacts:
    """What only an engine that outlives its runs says of itself; see `Snapshot`."""

    cell: str | None = None
    runs: str | None = None
    aborted: str | None = None
    drives: DrivesFields | None = None
    jog: JogFields | None = None
    override_left: LeftOverride | None = None
    emulated_speed: float | None = None


class ClientRegistry:
    """Knows the clients and the run under way.

    Args:
        clock: real time.
        waits: questions wait for a client, however long it takes to come.

    Attributes:
        policy: what becomes of a run whose client with control is lost.
        lease: who holds control.
        broker: questions lie open here.
        run: under way; None between runs.
        idle_state: where the engine stands between runs.
        beginning: a run was asked for and is not open yet.
        facts: more for the snapshot.
        on_control: called at once when another client, or none, holds control.
    """

    def __init__(self, clock: Clock, *, waits: bool = False) -> None:
        self.policy: LossPolicy = "hold"
        self.lease = ControlLease(self._control_changed)
        self.broker = PromptBroker(lambda: waits or self.attended)
        self.run: RunHandle | None = None
        self.idle_state = ControlState.IDLE
        self.beginning = False
        self.facts = EngineFacts()
        self.on_control: Callable[[], None] = lambda: None
        self._clock = clock
        self._members: dict[str, Member] = {}
        self._asked_s = 0.0
        self._count = 0
        self._latest = LatestEvents()
        self._early_hold = ""
        self._lost_early: tuple[Member, str] | None = None

    @property
    def members(self) -> list[Member]:
        """The clients, in the order in which they came."""
        return list(self._members.values())

    @property
    def attended(self) -> bool:
        """A client has control, or somebody is at the terminal of this process."""
        return self.lease.present is not None

    @property
    def asking(self) -> bool:
        """A question is open."""
        return self.broker.open is not None

    def listen(self, member: Member, topic: Topic, *, on: bool) -> None:
        """Send a client what belongs to a topic from now on, or no more."""
        if on:
            member.topics.add(topic)
        else:
            member.topics.discard(topic)

    def listens(self, topic: Topic) -> bool:
        """Return whether any client receives a topic."""
        return any(topic in member.topics for member in self._members.values())

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
        member = Member(Client(client=f"{client}-{self._count}", who=who), mailbox, disconnect)
        self._members[member.name] = member
        self._send(self._stamped(ClientsChanged(clients=self._clients())), but=member)
        return member

    def leave(self, member: Member, reason: str | None) -> None:
        """Remove a client; one that held control of a run has been lost.

        Args:
            reason: how it went; None when the engine ended the conversation.
        """
        self._members.pop(member.name, None)
        if self.lease.held_by(member):
            self._holder_left(member, reason)
        self.announce(ClientsChanged(clients=self._clients()))

    def member(self, name: str) -> Member:
        """Return a client by its name.

        Raises:
            RefusedError: there is none.
        """
        if name not in self._members:
            raise RefusedError(f"there is no client {name!r}; there are {', '.join(self._members)}")
        return self._members[name]

    def publisher(self, also: Publish | None = None) -> Publish:
        """Return what takes the events of a run: clients first, then somebody who may be gone."""

        def publish(event: RunEvent) -> None:
            self.publish(event)
            if also is not None:
                also(event)

        return publish

    def publish(self, event: RunEvent) -> None:
        """Take an event of the run, remember it and send it to every client."""
        self._latest.take(event)
        match event:
            case PromptAsked():
                self._asked_s = self._clock.monotonic_s()
                self.broker.announce(event.prompt)
            case PromptAnswered() | RunEnded():
                self.broker.withdraw()
        self._send(event)

    def publish_topic(self, topic: Topic, event: AnyEvent) -> None:
        """Send an event to every client that receives a topic."""
        stamped = self._stamped(event)
        for member in self.members:
            if topic in member.topics:
                send(stamped, member.mailbox, member.disconnect)

    def announce(self, event: AnyEvent) -> None:
        """Send every client what is no event of the run's procedure."""
        self._send(self._stamped(event))

    @contextmanager
    def running(self, handle: RunHandle) -> Iterator[None]:
        """Serve a run while its record is open."""
        self.run, self._latest = handle, LatestEvents()
        self.beginning = False
        lost, self._lost_early = self._lost_early, None
        if self.lease.holder is not None:
            handle.note("control", {"what": "held from the start", "by": self.lease.holder.text})
        elif lost is not None:
            self._lost(handle, *lost)
        try:
            yield
        finally:
            self.broker.withdraw()
            self.run = None

    def snapshot(self, member: Member | None = None) -> Snapshot:
        """Return everything that a client has to know when it comes."""
        run = self.run
        latest = self._latest if run else LatestEvents()
        asked_s = None if latest.prompt is None else self._clock.monotonic_s() - self._asked_s
        return Snapshot(
            engine=SOFTWARE,
            protocol=VERSION,
            pid=os.getpid(),
            you=member and member.name,
            clients=self._clients(),
            control=self.lease.present,
            on_client_lost=self.policy,
            run=run and run.path.name,
            path=run and str(run.path.resolve()),
            procedure=run and run.procedure,
            title=run and run.title,
            simulated=run and run.simulated,
            state=run.control.state if run else self.idle_state,
            reason=latest.state and latest.state.reason,
            step=latest.step,
            prompt=latest.prompt,
            prompt_open_s=asked_s,
            progress=latest.progress,
            live=latest.live,
            cell=self.facts.cell,
            runs=self.facts.runs,
            aborted=self.facts.aborted,
            drives=self.facts.drives,
            jog=self.facts.jog,
            override_left=self.facts.override_left,
            emulated_speed=self.facts.emulated_speed,
        )

    def _stamped(self, event: AnyEvent) -> AnyEvent:
        return event.stamped(self._clock.now_utc().isoformat(), self.run.path.name if self.run else None)

    def _clients(self) -> tuple[Client, ...]:
        return tuple(member.client for member in self._members.values())

    def _send(self, event: AnyEvent, but: Member | None = None) -> None:
        for member in self.members:
            if member is not but:
                send(event, member.mailbox, member.disconnect)

    def _control_changed(self, what: LeaseChange, holder: Client | None, before: str | None) -> None:
        if holder is not None:
            self._lost_early = None
            if self.run is not None:
                self.run.control.withdraw_hold(self._early_hold)
        try:
            self.on_control()
        except Exception:  # noqa: BLE001  # a run has to hear of it too, and everybody who watches
            _log.exception("what is done by hand could not be ended")
        by = None if holder is None else holder.text
        if self.run is not None:
            self.run.note("control", {"what": what, "by": by, "before": before})
        self.announce(ControlChanged(what=what, by=by, before=before, holder=holder))

    def _holder_left(self, member: Member, reason: str | None) -> None:
        self.lease.holder = None
        if reason is not None and self.run is not None and self.run.control.state not in ENDED:
            self._lost(self.run, member, reason)
            return
        if reason is not None and self.run is None and self.beginning:
            # What it asked for is still being planned: nobody may be there when it begins to move.
            self._lost_early = (member, reason)
        self.lease.drop("left", member)

    def _lost(self, run: RunHandle, member: Member, reason: str) -> None:
        who, policy = member.who, self.policy
        try:
            self.announce(ClientLost(client=member.name, who=who, reason=reason, policy=policy))
            self.lease.drop("lost", member)
            run.note("client-lost", {"client": member.name, "who": who, "reason": reason, "policy": policy})
        finally:
            # What fails on the way to front ends and store must not let the run go on alone.
            self._follow_policy(run, member, reason)

    def _follow_policy(self, run: RunHandle, member: Member, reason: str) -> None:
        text = f"{member.text}, who held control, is lost ({reason})"
        match after_loss(self.policy, run.control.state):
            case "warn":
                run.warn(f"{text}; the run goes on, as [engine] on_client_lost says")
            case "hold":
                self._early_hold = f"{text}; {_GO_ON}"
                run.control.hold_before_motion(self._early_hold)
            case "stop":
                run.control.stop(text)
