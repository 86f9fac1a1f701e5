"""Control of a run: one client has it at a time, or the person at the terminal of this process."""

from collections.abc import Callable

from catseye.app.protocol.engine_events import Client, LeaseChange
from catseye.app.service.errors import RefusedError
from catseye.app.service.member import Member

CONSOLE = "console"
"""Name of the terminal of this process among the clients."""

OnChange = Callable[[LeaseChange, Client | None, str | None], None]
"""Called with how control changed, who holds it now, and the text of who held it."""


class ControlLease:
    """Who may steer.

    Args:
        on_change: called at once when another client, or none, holds control.

    Attributes:
        holder: the client that holds control; None for nobody.
        console: the person at the terminal of this process; None without one.
    """

    def __init__(self, on_change: OnChange) -> None:
        self.holder: Member | None = None
        self.console: str | None = None
        self._on_change = on_change

    @property
    def present(self) -> Client | None:
        """Who steers: the holder, else the person at the terminal, else nobody."""
        if self.holder is not None:
            return self.holder.client
        return None if self.console is None else Client(client=CONSOLE, who=self.console)

    def held_by(self, member: Member | None) -> bool:
        """Return whether a client holds control."""
        return member is not None and member is self.holder

    def take(self, member: Member, *, force: bool) -> None:
        """Give a client control.

        Raises:
            RefusedError: somebody else has it and force was not used.
        """
        if self.holder is member:
            return
        present = self.present
        if present is not None and not force:
            raise RefusedError(
                f"{present.text} holds control: ask for it to be handed over, or take it with force"
            )
        self._give(
            "taken" if present is None else "taken by force",
            member,
            None if present is None else present.text,
        )

    def release(self, member: Member) -> None:
        """Take control back from a client that gives it up.

        Raises:
            RefusedError: it does not hold control.
        """
        self.require(member)
        self.drop("released", member)

    def hand_over(self, to: Member) -> None:
        """Give control from the client that holds it to another; to itself nothing changes."""
        if to is self.holder:
            return
        self._give("handed over", to, None if self.holder is None else self.holder.text)

    def drop(self, change: LeaseChange, before: Member) -> None:
        """Let nobody hold control.

        Args:
            before: the client that gave it up, or is gone.
        """
        self._give(change, None, before.text)

    def require(self, member: Member | None) -> None:
        """Check that a client may steer.

        Raises:
            RefusedError: it does not hold control.
        """
        if not self.held_by(member):
            present = self.present
            raise RefusedError(
                f"this needs control, which {present.text if present else 'nobody'} holds: take control first"
            )

    def _give(self, change: LeaseChange, holder: Member | None, before: str | None) -> None:
        self.holder = holder
        self._on_change(change, None if holder is None else holder.client, before)
