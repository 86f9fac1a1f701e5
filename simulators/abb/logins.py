"""Sessions of clients by their cookies: how many there may be, and how long they last in silence."""

from collections.abc import Callable
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from random import Random
from typing import Final

HTTP_COOKIE: Final = "-http-session-"
ABB_COOKIE: Final = "ABBCX"


class TooManySessionsError(Exception):
    """There are as many sessions as the controller has."""


@dataclass
class Login:
    """One session.

    Attributes:
        number: ABBCX, from 1.
        key: value of the other cookie.
        seen_s: when a request of it came last, s.
        rmmp_s: when the pendant grants it remote control in manual mode; None: it was not asked.
        subscriptions: of this session.
    """

    number: int
    key: str
    seen_s: float
    rmmp_s: float | None = None
    subscriptions: set[int] = field(default_factory=set)

    @property
    def cookies(self) -> tuple[tuple[str, str], ...]:
        """What its client is given."""
        return (
            ("Set-Cookie", f"{HTTP_COOKIE}={self.key}; path=/; httponly"),
            ("Set-Cookie", f"{ABB_COOKIE}={self.number}; path=/; httponly"),
        )


class Logins:
    """All sessions.

    Args:
        seed: of the keys.
        now_s: returns the time by which they grow old, s.
        most: more are refused.
        life_s: how long one lasts in silence, s.
        on_end: called when one has ended.
    """

    def __init__(
        self,
        seed: int,
        now_s: Callable[[], float],
        on_end: Callable[[Login], None],
        *,
        most: int,
        life_s: float,
    ) -> None:
        self._source = Random(f"keys {seed}")
        self._now_s = now_s
        self._most = most
        self._life_s = life_s
        self._on_end = on_end
        self._known: dict[int, Login] = {}
        self._last = 0

    def known(self, cookies: str) -> Login | None:
        """Return the session that a request's cookies belong to; a request keeps it alive."""
        self._forget_old()
        found = _values_of(cookies)
        for login in self._known.values():
            if found.get(HTTP_COOKIE) == login.key or found.get(ABB_COOKIE) == str(login.number):
                login.seen_s = self._now_s()
                return login
        return None

    def new(self) -> Login:
        """Begin a session.

        Raises:
            TooManySessionsError: there are too many.
        """
        self._forget_old()
        if len(self._known) >= self._most:
            raise TooManySessionsError
        self._last += 1
        key = f"{self._last}::http.session::{self._source.getrandbits(128):032x}"
        login = self._known[self._last] = Login(self._last, key, self._now_s())
        return login

    def end(self, login: Login) -> None:
        """End a session."""
        if self._known.pop(login.number, None) is not None:
            self._on_end(login)

    def _forget_old(self) -> None:
        old_s = self._now_s() - self._life_s
        for login in [login for login in self._known.values() if login.seen_s < old_s]:
            self.end(login)


def _values_of(cookies: str) -> dict[str, str]:
    jar: SimpleCookie = SimpleCookie()
    try:
        jar.load(cookies)
    except CookieError:
        return {}
    return {name: morsel.value for name, morsel in jar.items()}
