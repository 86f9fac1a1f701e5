"""One request of one client to one resource, and who may change what."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from catseye.simulators.abb.controller import AbbController
from catseye.simulators.abb.http import Answer, Request
from catseye.simulators.abb.logins import Login
from catseye.simulators.abb.replies import REFUSED, RefusedError, State, said

DOMAINS: Final = ("cfg", "motion", "rapid")
GRANTED_AFTER_S: Final = 1.0
"""Somebody confirms at the pendant that a client may write in manual mode; an assumption."""


class Masterships:
    """Who may change what.

    Args:
        explicit: nothing is changed without mastership; otherwise one that nobody holds is taken for the moment.
    """

    def __init__(self, *, explicit: bool) -> None:
        self._explicit = explicit
        self._holders: dict[str, int] = {}

    def request(self, domain: str, login: Login) -> None:
        """Give a session a domain.

        Raises:
            RefusedError: another one holds it.
        """
        self._require_free(domain, login)
        self._holders[domain] = login.number

    def release(self, domain: str, login: Login) -> None:
        """Take a domain from a session.

        Raises:
            RefusedError: it does not hold it.
        """
        if self._holders.get(domain) != login.number:
            raise RefusedError(403, REFUSED, f"mastership of {domain} is not held by this client")
        del self._holders[domain]

    def require(self, domain: str, login: Login) -> None:
        """Check that a session may change something.

        Raises:
            RefusedError: it may not.
        """
        self._require_free(domain, login)
        if self._explicit and domain not in self._holders:
            raise RefusedError(403, REFUSED, f"mastership of {domain} is needed")

    def forget(self, login: Login) -> None:
        """Take everything from a session that has ended."""
        self._holders = {domain: held for domain, held in self._holders.items() if held != login.number}

    def _require_free(self, domain: str, login: Login) -> None:
        if self._holders.get(domain, login.number) != login.number:
            raise RefusedError(403, REFUSED, f"mastership of {domain} is held by another client")


@dataclass(frozen=True)
class Call:
    """A request to a resource.

    Attributes:
        request: as it came.
        login: session of the client.
        controller: that is asked.
        masterships: of all clients.
        now_s: time by which sessions live, s.
        parts: what the place of the resource names.
    """

    request: Request
    login: Login
    controller: AbbController
    masterships: Masterships
    now_s: float
    parts: tuple[str, ...] = ()

    @property
    def as_json(self) -> bool:
        """The client wants JSON."""
        return self.request.query.get("json") == "1"

    def said(self, *states: State) -> Answer:
        """Return states as the client wants them."""
        return said(states, self.request.path, as_json=self.as_json)

    def value(self, name: str) -> str:
        """Return a value of the form.

        Raises:
            RefusedError: it is missing.
        """
        if name not in self.request.form:
            raise RefusedError(400, REFUSED, f"{name} is missing")
        return self.request.form[name][-1]

    def require_mastership(self, domain: str) -> None:
        """Check that the client may change something of a domain.

        Raises:
            RefusedError: it may not: mode, or another client.
        """
        self.require_mode()
        self.masterships.require(domain, self.login)

    def require_mode(self) -> None:
        """Check that a client may change something in this mode.

        Raises:
            RefusedError: the pendant has not granted it in manual mode.
        """
        granted_s = self.login.rmmp_s
        if self.controller.control.mode != "AUTO" and (granted_s is None or granted_s > self.now_s):
            raise RefusedError(403, REFUSED, "the controller is in manual mode: request remote control first")


Handler = Callable[[Call], Answer]
"""Carries out a call.

It raises RefusedError for what the controller does not do.
"""
