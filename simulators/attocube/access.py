"""The IDS's lock: a password that clients have to know before anything else is answered.

Names, parameters and results come from the maker's API (access.py): the methods have no name space, and the computer
that locks the device needs no password. Assumed: a connection stands for a computer; what clients cannot be without,
the lock itself and the texts of errors, is answered all the same.
"""

from weakref import WeakSet

from catseye.simulators.attocube.errors import LOCKED, WRONG_PASSWORD, IdsError
from catseye.simulators.attocube.results import Method

_ALWAYS = frozenset({"com.attocube.system.errorNumberToString"})


class Client:
    """A connection, as the lock tells it from others."""


class Access:
    """Who may use the device."""

    def __init__(self) -> None:
        self._password: str | None = None
        self._granted: WeakSet[Client] = WeakSet()

    def methods(self, client: Client) -> dict[str, Method]:
        """Return what a client can do with the lock, by name."""
        return {
            "lock": lambda password: self._lock(client, password),
            "unlock": self._unlock,
            "grantAccess": lambda password: self._grant(client, password),
            "getLockStatus": lambda: [0, self._password is not None, self._authorized(client)],
        }

    def require(self, client: Client, method: str) -> None:
        """Raise an error unless a client may call a method now."""
        if method not in _ALWAYS and not self._authorized(client):
            raise IdsError(LOCKED)

    def _authorized(self, client: Client) -> bool:
        return self._password is None or client in self._granted

    def _lock(self, client: Client, password: str) -> list[object]:
        if not self._authorized(client):
            raise IdsError(LOCKED)
        self._password = _text(password)
        self._granted = WeakSet({client})
        return [0]

    def _unlock(self, password: str) -> list[object]:
        self._check(password)
        self._password = None
        return [0]

    def _grant(self, client: Client, password: str) -> list[object]:
        self._check(password)
        self._granted.add(client)
        return [0]

    def _check(self, password: str) -> None:
        if self._password is not None and _text(password) != self._password:
            raise IdsError(WRONG_PASSWORD)


def _text(password: object) -> str:
    if not isinstance(password, str):
        raise TypeError(password)
    return password
