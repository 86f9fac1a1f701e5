"""Sessions of the controller by their cookies."""

from collections.abc import Mapping
from http.cookies import CookieError, SimpleCookie

from catseye.drivers.abb.http import Answer


class Cookies:
    """Keys of the session that all connections share: mastership belongs to a session."""

    def __init__(self) -> None:
        self._values: dict[str, str] = {}
        self._surplus: list[dict[str, str]] = []

    @property
    def headers(self) -> dict[str, str]:
        """What a request says of the session."""
        return _headers_of(self._values)

    @property
    def all_headers(self) -> list[dict[str, str]]:
        """What requests say of each session that was begun and not ended; the shared one is the last."""
        return [_headers_of(values) for values in (*self._surplus, self._values) if values]

    def keep(self, answer: Answer, sent: Mapping[str, str]) -> None:
        """Take what the server sets.

        A controller that has restarted or forgotten the session begins another one on each connection that asks at
        the same moment: the first is shared then, the others are left over.

        Args:
            sent: what the request said of the session.
        """
        found: dict[str, str] = {}
        for text in answer.values("set-cookie"):
            jar: SimpleCookie = SimpleCookie()
            try:
                jar.load(text)
            except CookieError:
                continue
            found |= {name: morsel.value for name, morsel in jar.items()}
        if sent == self.headers:
            self._values |= found
        elif found:
            self._surplus.append(found)

    def forget(self) -> None:
        """Begin another session with the next request."""
        self._values.clear()
        self._surplus.clear()


def _headers_of(values: Mapping[str, str]) -> dict[str, str]:
    text = "; ".join(f"{name}={value}" for name, value in values.items())
    return {"Cookie": text} if text else {}
