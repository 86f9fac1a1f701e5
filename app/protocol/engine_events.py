"""The events of an engine that only its socket has: clients, control, jog, drives, bench."""

from typing import Literal

from pydantic import Field

from catseye.app.protocol.bench import BenchStatus, Samples, WireLine
from catseye.app.protocol.loss import LossPolicy
from catseye.app.protocol.message import Event, Message, absent
from catseye.app.protocol.state import ControlState


class Client(Message):
    """A client of an engine, as people and records know it.

    Attributes:
        client: unique within this engine.
        who: the person.
    """

    client: str
    who: str

    @property
    def text(self) -> str:
        """The client as people and records read it. Nothing parses this."""
        return f"{self.who} ({self.client})"


LeaseChange = Literal["taken", "taken by force", "handed over", "released", "left", "lost"]


class ControlChanged(Event):
    """Another client, or none, holds control.

    Attributes:
        what: how that came.
        by: text of who holds it now; None for nobody.
        before: text of who held it.
        holder: who holds it now.
    """

    event: Literal["control"] = "control"
    what: LeaseChange
    by: str | None
    before: str | None
    holder: Client | None


class ClientsChanged(Event):
    """Somebody has come or gone."""

    event: Literal["clients"] = "clients"
    clients: tuple[Client, ...]


class ClientLost(Event):
    """The client that held control is gone without a word.

    Attributes:
        client: its name.
        who: the person.
        reason: how it went.
        policy: what becomes of the run.
    """

    event: Literal["client-lost"] = "client-lost"
    client: str
    who: str
    reason: str
    policy: LossPolicy


class EngineIdle(Event):
    """A run is put away, and the next one may begin."""

    event: Literal["idle"] = "idle"
    state: ControlState


class Dropped(Event):
    """This client read too slowly. The message is made where it is sent, without time and run.

    Attributes:
        t: not used.
        run: not used.
        count: points and steps that it missed; the run has them all the same.
    """

    t: str = Field(default="", exclude_if=lambda t: not t)
    event: Literal["dropped"] = "dropped"
    run: str | None = Field(default=None, exclude_if=absent)
    count: int


class JogFields(Message):
    """Whether and how the arm is moved by hand.

    Attributes:
        on: it may move.
        by: text of who moves it.
        client: name of that client.
        percent: speed override as read back; None before it is known.
        moving: the joint, or "beam"; None while the arm stands.
        reason: why it stands, or why the jog is over.
    """

    on: bool
    by: str
    client: str = ""
    percent: float | None
    moving: str | None
    reason: str | None = Field(default=None, exclude_if=absent)


class JogChanged(JogFields, Event):
    """A jog has begun or ended, or something of it moves or stands."""

    event: Literal["jog"] = "jog"


class RawChanged(Event):
    """A device's link was taken from its driver, or given back.

    Attributes:
        device: its name in the cell file.
        on: it is taken.
        by: text of who has it, or had it.
        client: name of that client.
        reason: why it was given back.
    """

    event: Literal["raw"] = "raw"
    device: str
    on: bool
    by: str
    client: str = ""
    reason: str | None = Field(default=None, exclude_if=absent)


class DrivesFields(Message):
    """What becomes of drives that a run has left on.

    Attributes:
        on: they are on, or not certain to be off.
        off_at_utc: ISO 8601 UTC time at which they go off; absent while nobody counts.
        reason: why they went off, or are not certain to be.
    """

    on: bool
    off_at_utc: str | None = Field(default=None, exclude_if=absent)
    reason: str | None = Field(default=None, exclude_if=absent)


class DrivesChanged(DrivesFields, Event):
    """The engine counts down to switching the drives off, or does it."""

    event: Literal["drives"] = "drives"


class LeftOverride(Message):
    """What a jog has left of the controller's speed override.

    Attributes:
        before_percent: that stood there before it; what an operator may have set again, at most the cell's.
        left_percent: that it has left.
    """

    before_percent: float
    left_percent: float


class OverrideLeft(Event):
    """A jog has left a lower speed override, or that is over.

    Attributes:
        left: what it has left; None where nothing is to be set again.
        reason: why that is over.
    """

    event: Literal["override-left"] = "override-left"
    left: LeftOverride | None
    reason: str = ""


class EmulatorsChanged(Event):
    """The engine's own emulators answer, or have ended.

    Attributes:
        speed: bench seconds in one real second; None when they have ended.
    """

    event: Literal["emulators"] = "emulators"
    speed: float | None


class BenchSeen(BenchStatus, Event):
    """The bench as it is now, for those who watch."""

    event: Literal["bench"] = "bench"


class SamplesTaken(Samples, Event):
    """The beam's displacement since the last ones, for those who watch."""

    event: Literal["samples"] = "samples"


class WirePassed(Event):
    """What went over the wires, for those who asked for traffic.

    Attributes:
        lines: oldest first.
        missed: older lines that are left out.
    """

    event: Literal["wire"] = "wire"
    lines: tuple[WireLine, ...]
    missed: int


EngineEvent = (
    ControlChanged
    | ClientsChanged
    | ClientLost
    | EngineIdle
    | Dropped
    | JogChanged
    | RawChanged
    | DrivesChanged
    | OverrideLeft
    | EmulatorsChanged
    | BenchSeen
    | SamplesTaken
    | WirePassed
)
