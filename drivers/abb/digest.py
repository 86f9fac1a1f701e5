"""Digest authentication as a client proves itself (RFC 7616 and, without qop, RFC 2069; MD5)."""

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from catseye.drivers.roles.errors import ProtocolError

_FIELD = re.compile(r'([\w-]+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^\s,"]*))')
_KEPT: Final = ("realm", "nonce", "opaque")


@dataclass(frozen=True, repr=False)
class Login:
    """A user of the controller; nothing shows the password.

    Attributes:
        user: name.
        password: of the user.
    """

    user: str
    password: str


class Digest:
    """Proofs of one user to one challenge.

    Args:
        challenge: value of a WWW-Authenticate header.
        login: who asks.
        client_nonce: chosen at random by the client.

    Attributes:
        count: so many proofs have been used.

    Raises:
        ProtocolError: the server wants something else than a digest by MD5.
    """

    def __init__(self, challenge: str, login: Login, client_nonce: str) -> None:
        fields = _fields_of(challenge)
        offered = [part.strip() for part in fields.get("qop", "").split(",")]
        if fields.get("algorithm", "MD5").upper() != "MD5" or "nonce" not in fields:
            raise ProtocolError("the server asks for another proof than a digest by MD5")
        self.count = 0
        self._fields = fields
        self._counted = "auth" in offered
        if not self._counted and offered != [""]:
            raise ProtocolError(f"the server offers no qop=auth, but {fields['qop'][:40]}")
        self._user = login.user
        self._client_nonce = client_nonce
        self._secret = _md5(f"{login.user}:{fields.get('realm', '')}:{login.password}")

    def proof(self, method: str, target: str, *, ahead: int) -> str:
        """Return the value of the Authorization header of a request; uses nothing up.

        Args:
            target: of the request.
            ahead: the proof is the so-manieth from now; each of a nonce has a count of its own.
        """
        asked = _md5(f"{method}:{target}")
        nonce, count = self._fields["nonce"], f"{self.count + ahead:08x}"
        parts = [self._secret, nonce, count, self._client_nonce, "auth", asked]
        response = _md5(":".join(parts if self._counted else [self._secret, nonce, asked]))
        named = {
            "username": self._user,
            **{name: self._fields[name] for name in _KEPT if name in self._fields},
        }
        quoted = ", ".join(f'{name}="{_escaped(value)}"' for name, value in (named | {"uri": target}).items())
        # Neither these nor the count may stand in quotes (RFC 7616, section 3.4).
        algorithm = f", algorithm={self._fields['algorithm']}" if "algorithm" in self._fields else ""
        counted = f', qop=auth, nc={count}, cnonce="{self._client_nonce}"' if self._counted else ""
        return f'Digest {quoted}{algorithm}{counted}, response="{response}"'


def challenge_of(values: list[str]) -> str:
    """Return the digest challenge among the values of WWW-Authenticate headers.

    Raises:
        ProtocolError: there is none.
    """
    for value in values:
        if value[:7].lower() == "digest ":
            return value
    raise ProtocolError("the server wants a login, but no digest: Robot Web Services 2.0 are not spoken here")


def _fields_of(challenge: str) -> Mapping[str, str]:
    """Return the fields of a challenge; what stands in quotes keeps its characters, without the backslashes."""
    found = _FIELD.findall(challenge.partition(" ")[2])
    return {name.lower(): re.sub(r"\\(.)", r"\1", quoted) or bare for name, quoted, bare in found}


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')


def _md5(text: str) -> str:
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()
