"""One connection to the controller's web server: logged in, and ready to say STOP at any moment."""

import asyncio
import secrets
from collections.abc import Callable, Mapping
from typing import Final
from urllib.parse import urlsplit

from catseye.drivers.abb import names
from catseye.drivers.abb.cookies import Cookies
from catseye.drivers.abb.digest import Digest, Login, challenge_of
from catseye.drivers.abb.http import Answer, AnswerDecoder, Request
from catseye.drivers.abb.masking import shown
from catseye.drivers.abb.settings import PASSWORD_VARIABLE, USER_VARIABLE, AbbSettings
from catseye.drivers.abb.values import error_of, value_of
from catseye.drivers.links.guarding import GuardedTransport, LinkGuard
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.errors import ProtocolError, RefusedError

_UNAUTHORISED: Final = 401
_FULL: Final = 503
_NAME: Final = "robot"


class Service:
    """A connection to Robot Web Services.

    Args:
        login: user and password.
        cookies: of the session.
        use: what the connection is for; the first one is the robot's own.
        guard: is given what stops the arm on this connection; None: it has another one.

    Attributes:
        link: that carries requests and answers.
    """

    def __init__(
        self,
        transport: Transport,
        settings: AbbSettings,
        login: Login,
        cookies: Cookies,
        *,
        use: str,
        guard: LinkGuard | None = None,
    ) -> None:
        self._settings = settings
        self._login = login
        self._cookies = cookies
        self._host = urlsplit(transport.endpoint).netloc
        self._guarded = None if guard is None else GuardedTransport(transport, guard, use, b"")
        self._digest: Digest | None = None
        self._turn = asyncio.Lock()
        self.link = RequestLink(
            self._guarded or transport,
            name=f"{_NAME} ({use} connection)" if use else _NAME,
            greet=self._greet,
            harmless=b"",
            stays_writable=True,
            shown=shown,
        )

    @property
    def where(self) -> str:
        """Device and endpoint, for texts."""
        return self.link.where

    async def value(self, request: Request, name: str) -> str:
        """Return a field of what a resource says.

        Raises:
            RefusedError: the controller refuses.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        answer = await self.ask(request)
        try:
            return value_of(answer, name)
        except ProtocolError as exc:
            raise ProtocolError(f"{self.where}: {request.path}: {exc}") from None

    async def ask(
        self,
        request: Request,
        *,
        repeat: Repeat = Repeat.HARMLESS,
        permit: Callable[[], None] | None = None,
    ) -> Answer:
        """Have a request carried out; return what the controller says to it.

        Args:
            repeat: what may be done when an answer is lost.
            permit: asked right before the request is written; what it raises keeps it from being written.

        Raises:
            RefusedError: the controller refuses.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """

        async def once() -> Answer:
            # The counts of a nonce go out in their order.
            async with self._turn:
                return await self._answer(request, permit)

        answer = await (self.link.repeated(once) if repeat is Repeat.HARMLESS else once())
        self._require_success(request, answer)
        return answer

    def stop_bytes(self) -> bytes:
        """Return STOP with a proof that was not used yet, and count it as used."""
        data = self._encoded(names.STOP, self._cookies.headers, ahead=1)
        if self._digest is not None:
            self._digest.count += 1
        return data

    async def renew(self) -> None:
        """Have a new challenge, before the old one may be stale, and see that the login holds.

        The guard has a STOP with a fresh proof then.

        Raises:
            RefusedError: the login is refused.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        await self.link.repeated(self._challenged)
        await self.ask(names.CONTROL_STATE)
        # A server ends a connection behind so many requests: then another one is opened at once.
        await self.link.repeated(self.link.ensure)

    async def log_out(self) -> None:
        """End the session of all connections, and those that were left over.

        Raises:
            RefusedError: the controller refuses.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        for session in self._cookies.all_headers:
            async with self._turn:
                answer = await self._answer(names.LOGOUT, None, session)
            self._require_success(names.LOGOUT, answer)
        self._cookies.forget()

    async def _answer(
        self, request: Request, permit: Callable[[], None] | None, session: Mapping[str, str] | None = None
    ) -> Answer:
        """Ask; where the proof has grown old, which means that nothing was done, ask once more.

        Args:
            session: what is said of it; None: it is the shared one.
        """
        for _ in range(2):
            if permit is not None:
                # A stop may have left the link out of step, and is the reason that counts.
                permit()
            await self.link.ensure()
            sent = self._cookies.headers if session is None else session
            data, timeout_s = self._next(request, sent), self._settings.answer_timeout_s
            answer = await self.link.request(data, AnswerDecoder, timeout_s, permit=permit)
            self._learn(answer, sent)
            if answer.status != _UNAUTHORISED:
                break
        if answer.last:
            self.link.expect_end("the server has ended the connection")
        return answer

    async def _challenged(self) -> None:
        """Ask without a proof, which is answered by a new challenge."""
        async with self._turn:
            await self.link.ensure()
            sent = self._cookies.headers
            data = names.CONTROL_STATE.encoded(self._host, sent)
            self._learn(await self.link.request(data, AnswerDecoder, self._settings.answer_timeout_s), sent)
            self._arm(ahead=1)

    def _next(self, request: Request, session: Mapping[str, str]) -> bytes:
        """Return a request with the next proof; before it is sent the guard has the STOP that fits behind it."""
        self._arm(ahead=2)
        data = self._encoded(request, session, ahead=1)
        if self._digest is not None:
            self._digest.count += 1
        return data

    def _arm(self, *, ahead: int) -> None:
        if self._guarded is not None:
            # A session outlives the program that dies, and nobody else gets an order through before it ends.
            session = self._cookies.headers
            release = self._encoded(names.RELEASE_MASTERSHIP, session, ahead=ahead + 1)
            self._guarded.protect(self._encoded(names.STOP, session, ahead=ahead) + release)

    def _encoded(self, request: Request, session: Mapping[str, str], *, ahead: int) -> bytes:
        headers = dict(session)
        if self._digest is not None:
            proof = self._digest.proof(request.method, request.target, ahead=ahead)
            headers = {"Authorization": proof, **headers}
        return request.encoded(self._host, headers)

    def _learn(self, answer: Answer, sent: Mapping[str, str]) -> None:
        """Take session and challenge from the answer to a request that said this of the session."""
        self._cookies.keep(answer, sent)
        if answer.status == _UNAUTHORISED:
            challenge = challenge_of(answer.values("www-authenticate"))
            self._digest = Digest(challenge, self._login, secrets.token_hex(8))

    async def _greet(self) -> None:
        """Log in, and see that this is a controller."""
        try:
            answer = await self._greeted()
            self._require_success(names.CONTROL_STATE, answer)
            value_of(answer, "ctrlstate")
        except ProtocolError as exc:
            raise ProtocolError(
                f"{self.where}: {exc}: check that the endpoint is that of a controller with Robot Web Services 1.0"
            ) from None
        self._arm(ahead=1)

    async def _greeted(self) -> Answer:
        """Ask the controller's state; once more where it wants a proof, or a newer one."""
        for _ in range(2):
            sent = self._cookies.headers
            data = self._next(names.CONTROL_STATE, sent)
            answer = await self.link.exchange(data, AnswerDecoder(), self._settings.answer_timeout_s)
            self._learn(answer, sent)
            if answer.status != _UNAUTHORISED:
                break
        return answer

    def _require_success(self, request: Request, answer: Answer) -> None:
        if answer.status < 300:
            return
        number, text = error_of(answer)
        if answer.status == _UNAUTHORISED:
            raise RefusedError(
                f"{self.where}: user or password is wrong: set {USER_VARIABLE} and {PASSWORD_VARIABLE} in the "
                "environment of this program, or call catseye --login before the command",
                number,
            )
        if answer.status == _FULL and not self._cookies.headers:
            raise RefusedError(
                f"{self.where}: all sessions of the controller are in use (it has about 70): end other programs that "
                "ask it, or wait until it forgets those that were not ended",
                number,
            )
        refused = f"{self.where}: {request.method} {request.path}: refused ({answer.status}): {text}"
        if answer.status == _FULL:
            refused += (
                "; the controller is overloaded or, if it has restarted meanwhile, all its sessions are in use: wait "
                "a moment, end other programs that ask it, and connect again"
            )
        raise RefusedError(refused, number)
