"""Who may ask: digest authentication as a server checks it (RFC 7616, MD5, qop=auth)."""

import hashlib
import hmac
import re
from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Final

from catseye.simulators.abb.http import Request

REALM: Final = "validusers@robapi.abb"
_FIELD = re.compile(r'(\w+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^\s,"]+))')
_OPAQUE: Final = "799d5"
_MOST_NONCES: Final = 1000


@dataclass
class _Nonce:
    """A number that a client has to put into what it proves.

    Attributes:
        issued_s: when it was made, s.
        count: largest count that came with it.
    """

    issued_s: float
    count: int = 0


class Gate:
    """Lets requests of one user in.

    Args:
        user: who may.
        password: of that user.
        seed: of the nonces.
        now_s: returns the time by which nonces grow old, s.
        life_s: how old a nonce may be, s.
        strict: no count of a nonce is taken twice, nor one below.
    """

    def __init__(
        self, user: str, password: str, seed: int, now_s: Callable[[], float], *, life_s: float, strict: bool
    ) -> None:
        self._user = user
        self._password = password
        self._now_s = now_s
        self._life_s = life_s
        self._strict = strict
        self._source = Random(f"nonces {seed}")
        self._nonces: dict[str, _Nonce] = {}

    def challenge(self, *, stale: bool) -> str:
        """Return a challenge with a new nonce."""
        nonce = f"{self._source.getrandbits(128):032x}"
        while len(self._nonces) >= _MOST_NONCES:
            del self._nonces[next(iter(self._nonces))]
        self._nonces[nonce] = _Nonce(self._now_s())
        return (
            f'Digest realm="{REALM}", domain="/", qop="auth", nonce="{nonce}", opaque="{_OPAQUE}", '
            f'algorithm="MD5", stale="{"TRUE" if stale else "FALSE"}"'
        )

    def refusal(self, request: Request) -> str | None:
        """Return a challenge for a request that is not let in; None for one that is."""
        scheme, _, rest = request.headers.get("authorization", "").partition(" ")
        given = {name.lower(): quoted or bare for name, quoted, bare in _FIELD.findall(rest)}
        if scheme.lower() != "digest" or not self._proves(request, given):
            return self.challenge(stale=False)
        return None if self._takes(given) else self.challenge(stale=True)

    def _proves(self, request: Request, given: dict[str, str]) -> bool:
        """Return whether the client knows the password and speaks of this request."""
        target = given.get("uri", "")
        if _resource_of(target) != _resource_of(request.target) or given.get("qop") != "auth":
            return False
        secret = _md5(f"{self._user}:{REALM}:{self._password}")
        asked = _md5(f"{request.method}:{target}")
        proof = ":".join([secret, *(given.get(name, "") for name in ("nonce", "nc", "cnonce", "qop")), asked])
        known = given.get("username") == self._user and given.get("realm") == REALM
        return known and hmac.compare_digest(_md5(proof).encode(), given.get("response", "").encode())

    def _takes(self, given: dict[str, str]) -> bool:
        """Return whether nonce and count are fresh."""
        nonce = self._nonces.get(given["nonce"])
        if nonce is None or self._now_s() - nonce.issued_s > self._life_s:
            return False
        try:
            count = int(given.get("nc", ""), 16)
        except ValueError:
            return False
        if self._strict and count <= nonce.count:
            return False
        nonce.count = max(nonce.count, count)
        return True


def _resource_of(target: str) -> tuple[str, str]:
    """Return path and query; Python's `requests` leaves what follows a semicolon out of what it proves."""
    path, _, query = target.partition("?")
    return path.partition(";")[0], query


def _md5(text: str) -> str:
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()
