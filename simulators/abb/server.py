"""The web server of the controller: who is let in, in which session, and one client's connection."""

from collections.abc import Callable
from functools import partial
from typing import Final

from catseye.simulators.abb.calls import Call, Masterships
from catseye.simulators.abb.controller import AbbController
from catseye.simulators.abb.digest import Gate
from catseye.simulators.abb.failing import FAILED
from catseye.simulators.abb.http import Answer, BadRequestError, Request, RequestBuffer
from catseye.simulators.abb.logins import Login, Logins, TooManySessionsError
from catseye.simulators.abb.replies import NOTHING
from catseye.simulators.abb.resources import Resources
from catseye.simulators.abb.subscriptions import LOOK_S, Subscription, Subscriptions
from catseye.simulators.abb.websocket import FrameReader, handshake, text_frame
from catseye.simulators.ports.session import Answer as Reply
from catseye.simulators.ports.session import Session
from catseye.simulators.ports.turns import Turns

_POLL: Final = "poll/"
_SHOWN: Final = 200


class Server:
    """What the clients share.

    Args:
        controller: that they ask.
        seed: of nonces, keys and delays.
        password: of the user Default User.
        most_sessions: more are refused.
        most_requests: of one connection, which ends behind them; 0: any number.
        strict_counts: no count of a nonce is taken twice.
        explicit_mastership: nothing is changed without it.
        life_s: of a nonce and of a silent session, real s.
    """

    def __init__(
        self,
        controller: AbbController,
        seed: int,
        *,
        password: str,
        most_sessions: int,
        most_requests: int,
        strict_counts: bool,
        explicit_mastership: bool,
        life_s: float,
    ) -> None:
        self.controller = controller
        self.most_requests = most_requests
        self.turns = Turns(controller.bench, seed, 21)
        self._real_s = _RealTime(controller)
        self._gate = Gate("Default User", password, seed, self._real_s, life_s=life_s, strict=strict_counts)
        self._logins = Logins(seed, self._real_s, self._forget, most=most_sessions, life_s=life_s)
        self._masterships = Masterships(explicit=explicit_mastership)
        self._subscriptions = Subscriptions()
        self._resources = Resources(
            (
                ("GET", "logout", self._logout),
                ("POST", "subscription", self._subscriptions.begin),
                ("DELETE", r"subscription/(\d{1,9})", self._subscriptions.end),
            )
        )

    def answer(self, request: Request, note: Callable[[str], None]) -> Answer:
        """Carry out a request; `note` is called with those that were let in."""
        if (challenge := self._gate.refusal(request)) is not None:
            return Answer(
                401, b"<html><body>Unauthorized</body></html>", headers=(("WWW-Authenticate", challenge),)
            )
        login = self._logins.known(request.headers.get("cookie", ""))
        fresh = login is None
        try:
            login = login or self._logins.new()
        except TooManySessionsError:
            return Answer(503, b"<html><body>Too many sessions</body></html>")
        note(_noted(request))
        call = Call(request, login, self.controller, self._masterships, self._real_s())
        answer = self._carried_out(call)
        cookies = login.cookies if fresh else ()
        return Answer(answer.status, answer.body, answer.kind, (*answer.headers, *cookies))

    def polled(self, request: Request) -> Subscription | None:
        """Return the subscription that a request for a WebSocket leads to; None where it leads to none."""
        login = self._logins.known(request.headers.get("cookie", ""))
        number = request.path.removeprefix(_POLL)
        if login is None or number not in map(str, login.subscriptions):
            return None
        return self._subscriptions.named(number)

    def _carried_out(self, call: Call) -> Answer:
        failing = self.controller.failing
        if failing is None or not failing.fails(call.request):
            return self._resources.answer(call)
        if failing.carried_out:
            self._resources.answer(call)
        return FAILED

    def _logout(self, call: Call) -> Answer:
        self._logins.end(call.login)
        return NOTHING

    def _forget(self, login: Login) -> None:
        self._masterships.forget(login)
        self._subscriptions.forget(login)


class _RealTime:
    """Real time by the bench's, s: sessions and nonces grow old in it whatever the speed of the bench is."""

    def __init__(self, controller: AbbController) -> None:
        self._controller = controller
        self._bench_s = controller.bench.time_s
        self._passed_s = 0.0

    def __call__(self) -> float:
        now_s = self._controller.bench.time_s
        self._passed_s += (now_s - self._bench_s) / self._controller.keeper.speed
        self._bench_s = now_s
        return self._passed_s


class RwsSession(Session):
    """Conversation with one client, by HTTP and perhaps by a WebSocket then.

    Args:
        note: called with each request.
    """

    def __init__(self, server: Server, note: Callable[[str], None]) -> None:
        self._server = server
        self._note = note
        self._buffer = RequestBuffer()
        self._count = 0
        self._over = False
        self._frames: FrameReader | None = None
        self._shown: Subscription | None = None
        self._said = b""

    @property
    def over(self) -> bool:
        """The connection ends behind the last answer."""
        return self._over

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        if self._over:
            return
        if self._frames is not None:
            self._said += self._frames.feed(data)
        else:
            self._buffer.feed(data)

    def answer(self) -> Reply | None:
        """Have the next request carried out in its turn."""
        if self._frames is not None:
            said, self._said = self._said, b""
            self._over |= self._frames.ended
            return said or None
        if self._over:
            return None
        try:
            request = self._buffer.take()
        except BadRequestError as error:
            self._over = True
            return Answer(error.status).encoded(last=True)
        if request is None:
            return None
        if request.path.startswith(_POLL):
            return self._upgraded(request)
        self._count += 1
        last = request.last or self._count == self._server.most_requests
        self._over = last
        return self._server.turns.take(partial(self._carried_out, request, last=last))

    def close(self) -> None:
        """Carry out what the client sent before it went."""
        while self._frames is None and not self._over and self.answer() is not None:
            pass

    def next_output_s(self) -> float | None:
        """Return the bench time of the next look for changes."""
        return None if self._shown is None or self._over else self._server.controller.bench.time_s + LOOK_S

    def output(self) -> bytes:
        """Return what has changed."""
        frames = b""
        if self._shown is not None:
            self._shown.look()
            while (event := self._shown.next_event()) is not None:
                frames += text_frame(event)
        return frames

    def _carried_out(self, request: Request, *, last: bool) -> bytes:
        return self._server.answer(request, self._note).encoded(last=last)

    def _upgraded(self, request: Request) -> bytes:
        shown, answer = self._server.polled(request), handshake(request)
        if shown is None or answer is None:
            self._over = True
            return Answer(404).encoded(last=True)
        self._note(_noted(request))
        self._frames, self._shown = FrameReader(), shown
        self._said = self._frames.feed(self._buffer.rest())
        return answer.encoded(last=False)


def _noted(request: Request) -> str:
    """Return a request for the journal: what is asked, and the form; nothing of who asks."""
    form = (
        request.body.decode("utf-8", "replace") if "form" in request.headers.get("content-type", "") else ""
    )
    return f"{request.method} {request.target} {form}".strip()[:_SHOWN]
