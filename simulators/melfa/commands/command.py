"""What a command is, and who gives it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import Run
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.values import number

_EPOCH = datetime(2026, 1, 1, tzinfo=UTC)
"""The controller's clock starts here at bench time 0, so that a transcript can be repeated."""


@dataclass
class OpenFile:
    """A file that a client has opened.

    Attributes:
        mode: r or w.
        content: what is still to be read, or what has been written.
    """

    name: str
    mode: str
    content: bytearray


@dataclass(eq=False)
class Client:
    """What the controller knows about one connection.

    Attributes:
        places: where it stands in each list that it reads entry by entry.
        file: the file that it has open.
    """

    places: dict[str, int] = field(default_factory=dict)
    file: OpenFile | None = None


Handler = Callable[[Controller, Client, str], str | Run]
"""Carries out a command with its arguments; returns the answer's text, or the motion to wait for."""


@dataclass(frozen=True)
class Command:
    """One command word.

    Attributes:
        handler: what it does.
        arguments: something may follow the word.
        right: it needs the operation right.
        alone: it means something without its arguments, too.
    """

    handler: Handler
    arguments: bool = False
    right: bool = False
    alone: bool = False


def do(action: Callable[[Controller], None]) -> Handler:
    """Return a handler of an action that needs no argument and answers nothing."""

    def handler(controller: Controller, client: Client, arguments: str) -> str:
        del client, arguments
        action(controller)
        return ""

    return handler


def say(text: Callable[[Controller, str], str]) -> Handler:
    """Return a handler of an answer that is the same for every client."""

    def handler(controller: Controller, client: Client, arguments: str) -> str:
        del client
        return text(controller, arguments)

    return handler


def show(text: Callable[[Controller], str]) -> Handler:
    """Return a handler of an answer to a command that has no argument."""
    return say(lambda controller, _: text(controller))


def unknown(controller: Controller, client: Client, arguments: str) -> str:
    """Refuse a word that would otherwise be another one with arguments."""
    del controller, client, arguments
    raise Refusal(alarms.ILLEGAL_COMMAND)


def nothing(controller: Controller, client: Client, arguments: str) -> str:
    """Accept a command that changes nothing that is modelled."""
    del controller, client, arguments
    return ""


def place_in(client: Client, list_name: str, which: str, length: int) -> int | None:
    """Return the index that TOP (or <), END, +1 or -1 leads to in a list, None beyond its ends.

    Raises:
        Refusal: there is no such word.
    """
    at = client.places.get(list_name, 0)
    places = {"TOP": 0, "<": 0, "END": length - 1, "+1": at + 1, "-1": at - 1}
    if which not in places:
        raise Refusal(alarms.ILLEGAL_COMMAND)
    place = places[which]
    if not 0 <= place < length:
        return None
    client.places[list_name] = place
    return place


def required_number(text: str) -> float:
    """Return a number that has to be there."""
    if not text.strip():
        raise Refusal(alarms.SYNTAX)
    return number(text)


def whole(text: str, low: int, high: int) -> int:
    """Return a whole number of a range."""
    stripped = text.strip()
    if not (stripped.isascii() and stripped.isdecimal()):
        raise Refusal(alarms.SYNTAX)
    if not low <= int(stripped[:9]) <= high:
        raise Refusal(alarms.OUT_OF_RANGE)
    return int(stripped)


def clock(time_s: float, form: str) -> str:
    """Return a bench time on the controller's clock."""
    return (_EPOCH + timedelta(seconds=time_s)).strftime(form)
