"""A client that has introduced itself, and how it is sent something."""

from collections.abc import Callable
from dataclasses import dataclass, field

from catseye.app.protocol.engine_events import Client
from catseye.app.protocol.events import AnyEvent
from catseye.app.service.mailbox import Mailbox, MailboxFullError
from catseye.app.service.watching.telemetry import Topic


@dataclass(eq=False)
class Member:
    """A client of this engine.

    Attributes:
        client: as others know it.
        mailbox: what waits to be sent to it.
        disconnect: ends the connection; takes the reason.
        heard_s: when its last line came, on the engine's clock.
        topics: what it receives beside the events of runs.
    """

    client: Client
    mailbox: Mailbox
    disconnect: Callable[[str], None]
    heard_s: float = 0.0
    topics: set[Topic] = field(default_factory=set)

    @property
    def name(self) -> str:
        """Unique within this engine."""
        return self.client.client

    @property
    def who(self) -> str:
        """The person."""
        return self.client.who

    @property
    def text(self) -> str:
        """The client as people and records read it."""
        return self.client.text


def send(message: AnyEvent | bytes, mailbox: Mailbox, disconnect: Callable[[str], None]) -> None:
    """Put an event or an encoded answer into a client's mailbox.

    A client that does not read what it has to know is disconnected.
    """
    try:
        mailbox.put(message)
    except MailboxFullError as error:
        disconnect(f"it does not read what it is sent: {error}")
