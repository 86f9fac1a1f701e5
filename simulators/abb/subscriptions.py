"""Subscriptions: resources whose changes a client is shown over a WebSocket."""

import re
from collections import deque
from collections.abc import Callable, Mapping
from typing import Final

from catseye.simulators.abb.calls import Call
from catseye.simulators.abb.controller import AbbController
from catseye.simulators.abb.http import Answer
from catseye.simulators.abb.logins import Login
from catseye.simulators.abb.rapid import UnknownSymbolError
from catseye.simulators.abb.replies import (
    NOT_FOUND,
    NOTHING,
    REFUSED,
    RefusedError,
    State,
    event_page,
    item_xhtml,
    subscribed,
)

LOOK_S: Final = 0.1
"""How often the controller looks for changes, bench s; an assumption."""

_MOST: Final = 10
"""Subscriptions of a client."""

_MOST_RESOURCES: Final = 100
_MOST_EVENTS: Final = 100

_DATA = re.compile(r"rw/rapid/symbol/data/(RAPID/.+)")
_SIGNAL = re.compile(r"rw/iosystem/signals/([^/]+/[^/]+/[^/]+)")
_QUEUE = re.compile(r"rw/dipc/([^/]+)")


class Subscription:
    """What one client is shown.

    Args:
        looks: by resource, what returns the event that shows its present state.
    """

    def __init__(self, looks: Mapping[str, Callable[[], State]]) -> None:
        self._looks = looks
        self._last = self.states
        self._events: deque[str] = deque(maxlen=_MOST_EVENTS)

    @property
    def states(self) -> dict[str, State]:
        """The present states by resource."""
        return {resource: look() for resource, look in self._looks.items()}

    def look(self) -> None:
        """Note what has changed."""
        now = self.states
        for resource, state in now.items():
            if state != self._last[resource]:
                self._events.append(event_page([item_xhtml(state, resource)]))
        self._last = now

    def next_event(self) -> str | None:
        """Return the oldest event that was not shown yet."""
        return self._events.popleft() if self._events else None


class Subscriptions:
    """All subscriptions by their numbers."""

    def __init__(self) -> None:
        self._known: dict[int, Subscription] = {}
        self._last = 0

    def named(self, number: str) -> Subscription | None:
        """Return a subscription; None where there is none."""
        return self._known.get(int(number)) if number.isdecimal() else None

    def forget(self, login: Login) -> None:
        """End those of a session that has ended."""
        for number in login.subscriptions:
            self._known.pop(number, None)

    def begin(self, call: Call) -> Answer:
        """Subscribe to the resources that a form names."""
        form = call.request.form
        names = form.get("resources", [])
        if not names or len(names) > _MOST_RESOURCES or len(call.login.subscriptions) >= _MOST:
            raise RefusedError(
                400, REFUSED, "a subscription names up to 100 resources; a client has up to 10"
            )
        wanted = [form[name][-1] for name in names if name in form]
        looks = {resource: _look_of(call.controller, resource) for resource in wanted}
        self._last += 1
        made = self._known[self._last] = Subscription(looks)
        call.login.subscriptions.add(self._last)
        host = call.request.headers.get("host", "127.0.0.1")
        return subscribed(f"ws://{host}/poll/{self._last}", list(made.states.values()))

    def end(self, call: Call) -> Answer:
        """End a subscription."""
        number = int(call.parts[0])
        if number not in call.login.subscriptions:
            raise RefusedError(404, NOT_FOUND, f"there is no subscription {number}")
        call.login.subscriptions.discard(number)
        del self._known[number]
        return NOTHING


def _look_of(controller: AbbController, resource: str) -> Callable[[], State]:
    """Return what looks at a resource.

    Raises:
        RefusedError: it is not to be subscribed to.
    """
    path = resource.strip("/").partition(";")[0]
    control, program = controller.control, controller.program
    if path == "rw/panel/ctrlstate":
        return lambda: State("pnl-ctrlstate-ev", "ctrlstate", {"ctrlstate": control.state})
    if path == "rw/panel/opmode":
        return lambda: State("pnl-opmode-ev", "opmode", {"opmode": control.mode})
    if path == "rw/rapid/execution":
        states = {True: "running", False: "stopped"}
        return lambda: State(
            "rap-ctrlexecstate-ev", "ctrlexecstate", {"ctrlexecstate": states[program.running]}
        )
    if path == "rw/elog/0":
        return lambda: _last_event(controller)
    if found := _DATA.fullmatch(path):
        return _data_look(controller, found[1])
    if found := _SIGNAL.fullmatch(path):
        place = found[1]
        return lambda: State("ios-signalstate-ev", place, {"lvalue": controller.signals.get(place, "0")})
    if found := _QUEUE.fullmatch(path):
        return _queue_look(controller, found[1])
    raise RefusedError(400, NOT_FOUND, f"{resource} is not to be subscribed to")


def _data_look(controller: AbbController, url: str) -> Callable[[], State]:
    try:
        controller.symbols.read(url)
    except UnknownSymbolError:
        raise RefusedError(400, NOT_FOUND, f"there is no {url}") from None
    return lambda: State("rap-data", url, {"value": controller.symbols.read(url)})


def _queue_look(controller: AbbController, name: str) -> Callable[[], State]:
    def look() -> State:
        messages = controller.queues.get(name, [])
        last = messages[-1] if messages else {"dipc-data": "", "dipc-userdef": ""}
        return State("dipc-msg-ev", name, {key: last[key] for key in ("dipc-data", "dipc-userdef")})

    return look


def _last_event(controller: AbbController) -> State:
    newest = controller.events.newest_first()
    number = newest[0].number if newest else 0
    return State("elog-message-ev", f"/rw/elog/0/{number}", {"seqnum": str(number)})
